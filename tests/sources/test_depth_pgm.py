"""PGM images as netpbm describes them, read as other programs read them."""

import cv2
import numpy as np
import pytest

from elbowroom.errors import FrameError
from elbowroom.sources.depth_image import check_depth_image, read_depth_image

RAW = np.random.default_rng(1).integers(0, 65536, (6, 8)).astype(np.uint16)
PIXELS = RAW.astype(">u2").tobytes()


def written(tmp_path, header, pixels=PIXELS):
    (tmp_path / "a.pgm").write_bytes(header + pixels)
    return tmp_path / "a.pgm"


def refusal(path, width=8, height=6, read=read_depth_image):
    with pytest.raises(FrameError) as caught:
        read(path, width, height)
    text = str(caught.value)
    assert "\n" not in text and text.startswith(str(path))
    return text


@pytest.mark.parametrize(
    "header",
    [
        b"P5\n8 6\n65535\n",
        b"P5 8 6 65535 ",
        b"P5\n# by a driver\n8 6\n# units of 0.2 mm\n65535\n",
        b"P5\t8\r\n6\n#x\n65535\n",
        b"P5 # comment\n 8 6 65535\n",
    ],
)
def test_headers_with_any_white_space_and_comments_are_read(tmp_path, header):
    path = written(tmp_path, header)
    check_depth_image(path, 8, 6)
    np.testing.assert_array_equal(read_depth_image(path, 8, 6), RAW)


def test_what_another_program_writes_is_read_as_it_reads_it(tmp_path):
    cv2.imwrite(str(tmp_path / "b.pgm"), RAW)
    np.testing.assert_array_equal(read_depth_image(tmp_path / "b.pgm", 8, 6), RAW)
    np.testing.assert_array_equal(
        cv2.imread(str(written(tmp_path, b"P5\n8 6\n65535\n")), cv2.IMREAD_UNCHANGED), RAW
    )


def test_the_format_is_told_by_the_content_not_by_the_name(tmp_path):
    cv2.imwrite(str(tmp_path / "b.png"), RAW)
    (tmp_path / "b.png").rename(tmp_path / "b.pgm")
    np.testing.assert_array_equal(read_depth_image(tmp_path / "b.pgm", 8, 6), RAW)


@pytest.mark.parametrize("read", [read_depth_image, check_depth_image])
@pytest.mark.parametrize(
    ("header", "pixels", "says"),
    [
        (b"P5\n8 6\n255\n", bytes(48), "8 bits of grey, must be 16 bits"),
        (b"P5\n8 6\n0\n", PIXELS, "a greatest value of 0"),
        (b"P5\n8 6\n70000\n", PIXELS, "a greatest value of 70000"),
        (b"P2\n8 6\n65535\n", b"1 " * 48, "P2, a PGM in text; must be a binary PGM"),
        (b"P6\n8 6\n65535\n", PIXELS * 3, "P6, a colour PPM"),
        (b"P5\n6 8\n65535\n", PIXELS, "6 x 8 pixels, its camera has 8 x 6; width and height look exchanged"),
        (b"P5\n8 6\n65535\n", PIXELS[:-1], "truncated PGM, 95 bytes of pixels of 96"),
        (b"P5\n8 6\n65535\n", PIXELS * 2, "one image a file"),
        (b"P5\n8 6\n", b"", "no width, height and greatest value"),
        (b"P5", b"", "not a PGM file, or cut off"),
        (b"P5\n-8 6\n65535\n", PIXELS, "no width, height and greatest value"),
    ],
)
def test_what_is_no_16_bit_pgm_is_refused_by_name(tmp_path, header, pixels, says, read):
    assert says in refusal(written(tmp_path, header, pixels), read=read)
