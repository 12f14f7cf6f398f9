import struct
import zlib

import numpy as np
import pytest
from PIL import Image

from elbowroom.errors import FrameError, SiteError
from elbowroom.files.mask_file import read_mask
from elbowroom.sources.depth_png import check_depth_png, png_pixels, read_depth_png


def raw_png(width, height, depth=16, colour=0, idat=b""):
    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    header = struct.pack(">IIBBBBB", width, height, depth, colour, 0, 0, 0)
    return (
        b"\x89PNG\r\n\x1a\n"
        + chunk(b"IHDR", header)
        + chunk(b"IDAT", zlib.compress(idat))
        + chunk(b"IEND", b"")
    )


def refusal(path, width=8, height=6, read=read_depth_png):
    with pytest.raises(FrameError) as caught:
        read(path, width, height)
    text = str(caught.value)
    assert "\n" not in text and text.startswith(str(path))
    return text


def test_sixteen_bits_come_back_as_they_were(tmp_path):
    raw = np.random.default_rng(1).integers(0, 65536, (6, 8)).astype(np.uint16)
    Image.fromarray(raw).save(tmp_path / "a.png")
    read = read_depth_png(tmp_path / "a.png", 8, 6)
    assert read.dtype == np.uint16
    np.testing.assert_array_equal(read, raw)


def test_an_image_by_another_writer_is_read(tmp_path):
    """Big-endian rows, each with its filter byte, as the PNG specification lays them out."""
    rows = b"".join(b"\0" + struct.pack(">8H", *range(256 * row, 256 * row + 8)) for row in range(6))
    (tmp_path / "a.png").write_bytes(raw_png(8, 6, idat=rows))
    assert read_depth_png(tmp_path / "a.png", 8, 6)[5].tolist() == list(range(1280, 1288))


@pytest.mark.parametrize("read", [read_depth_png, check_depth_png])
def test_the_header_is_checked_before_anything_is_decoded(tmp_path, read):
    path = tmp_path / "a.png"
    assert "no such file; expected a 16-bit PNG of 8 x 6" in refusal(path, read=read)
    path.write_bytes(b"")
    assert "not a PNG file, or cut off" in refusal(path, read=read)
    Image.new("RGB", (8, 6)).save(path, format="JPEG")
    assert "a JPEG image" in refusal(path, read=read)
    # a bomb: a header of a gigantic image, refused by its size alone
    path.write_bytes(raw_png(2**31 - 1, 2**31 - 1))
    assert "2147483647 x 2147483647 pixels, its camera has 8 x 6" in refusal(path, read=read)
    Image.fromarray(np.zeros((8, 6), np.uint16)).save(path)
    assert "6 x 8 pixels, its camera has 8 x 6" in refusal(path, read=read)


@pytest.mark.parametrize(
    ("image", "found"),
    [
        (Image.new("L", (8, 6)), "8 bits of grey"),
        (Image.new("RGB", (8, 6)), "8 bits of RGB"),
        (Image.new("P", (8, 6)), "bits of palette"),
        (Image.new("LA", (8, 6)), "8 bits of grey with alpha"),
        (Image.new("1", (8, 6)), "1 bits of grey"),
    ],
)
def test_other_kinds_of_image_are_no_depth(tmp_path, image, found):
    image.save(tmp_path / "a.png")
    text = refusal(tmp_path / "a.png")
    assert found in text and "must be 16 bits of grey" in text


def test_sixteen_bits_of_colour_are_no_depth(tmp_path):
    (tmp_path / "a.png").write_bytes(raw_png(8, 6, 16, 2, b"\0" * 49 * 6))
    assert "16 bits of RGB" in refusal(tmp_path / "a.png")


def test_wherever_a_file_is_cut_off_it_is_refused(tmp_path):
    path = tmp_path / "a.png"
    Image.fromarray(np.random.default_rng(1).integers(0, 65536, (6, 8)).astype(np.uint16)).save(path)
    whole = path.read_bytes()
    # without the last 12 bytes, the mark of the end, all pixels are there
    for length in range(len(whole) - 12):
        path.write_bytes(whole[:length])
        refusal(path)


def test_a_damaged_file_is_refused(tmp_path):
    path = tmp_path / "a.png"
    Image.fromarray(np.random.default_rng(1).integers(0, 65536, (6, 8)).astype(np.uint16)).save(path)
    whole = path.read_bytes()
    for place in range(60, len(whole) - 20, 7):
        path.write_bytes(whole[:place] + bytes([whole[place] ^ 1]) + whole[place + 1 :])
        assert "damaged" in refusal(path)


def test_rows_that_a_well_formed_file_does_not_hold_are_no_return(tmp_path):
    rows = (b"\0" + b"\1" * 16) * 3
    (tmp_path / "a.png").write_bytes(raw_png(8, 6, idat=rows))
    read = read_depth_png(tmp_path / "a.png", 8, 6)
    assert (read[:3] == 257).all() and (read[3:] == 0).all()


def test_a_file_far_larger_than_its_image_is_refused(tmp_path):
    path = tmp_path / "a.png"
    Image.fromarray(np.zeros((6, 8), np.uint16)).save(path)
    with path.open("ab") as file:
        file.truncate(2_000_000)
    assert "2,000,000 bytes, at most 1,000,192 for 8 x 6" in refusal(path)


def test_a_png_without_pixels_is_refused(tmp_path):
    """Found by `elbowroom evaluate malformed`: Pillow's own check runs past the end of a list."""
    whole = raw_png(8, 6)
    at = whole.index(b"IDAT") - 4
    data = whole[:at] + whole[whole.index(b"IEND") - 4 :]
    (tmp_path / "a.png").write_bytes(data)
    with pytest.raises(FrameError, match="truncated or damaged PNG"):
        read_depth_png(tmp_path / "a.png", 8, 6)
    with pytest.raises(FrameError, match="truncated or damaged PNG"):
        png_pixels(data, "it", 8, 6)


def test_a_chunk_that_says_it_is_longer_than_the_file_takes_no_memory(tmp_path):
    """Found by `elbowroom evaluate malformed`, in a mask."""
    whole = raw_png(8, 6, idat=b"".join(b"\x00" + bytes(16) for _ in range(6)))
    at = whole.index(b"IEND") - 4
    data = whole[:at] + (1 << 30).to_bytes(4, "big") + b"tRNSab"
    (tmp_path / "a.png").write_bytes(data)
    with pytest.raises(FrameError, match="a chunk ends beyond the file"):
        read_depth_png(tmp_path / "a.png", 8, 6)
    with pytest.raises(FrameError, match="a chunk ends beyond the file"):
        png_pixels(data, "it", 8, 6)
    with pytest.raises(SiteError, match="a chunk ends beyond the file"):
        read_mask(tmp_path / "a.png", 8, 6)
