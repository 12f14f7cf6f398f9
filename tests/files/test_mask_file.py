"""A mask on disk is black or white, and of its camera's size."""

import numpy as np
import pytest
from PIL import Image

from elbowroom.errors import SiteError
from elbowroom.files.mask_file import read_mask, write_mask


def test_what_is_written_is_read(tmp_path):
    mask = np.random.default_rng(1).random((6, 9)) < 0.5
    np.testing.assert_array_equal(read_mask(write_mask(tmp_path / "m.png", mask), 9, 6), mask)


def test_black_and_white_of_one_bit_is_read(tmp_path):
    mask = np.eye(4, dtype=bool)
    Image.fromarray(~mask).convert("1").save(tmp_path / "m.png")
    np.testing.assert_array_equal(read_mask(tmp_path / "m.png", 4, 4), mask)


@pytest.mark.parametrize(
    ("pixels", "says"),
    [
        (np.full((4, 4), 128, np.uint8), "grey values"),
        (np.zeros((4, 4), np.uint8), "black all over"),
        (np.full((4, 5), 255, np.uint8), "5 x 4 pixels, its camera has 4 x 4"),
        (np.full((4, 4, 3), 255, np.uint8), "mode RGB"),
        (np.full((4, 4), 255, np.uint16), "mode I;16"),
    ],
)
def test_what_is_no_mask_is_refused(tmp_path, pixels, says):
    Image.fromarray(pixels).save(tmp_path / "m.png")
    with pytest.raises(SiteError, match=says):
        read_mask(tmp_path / "m.png", 4, 4)


def test_a_file_that_is_missing_or_damaged_is_one_line(tmp_path):
    with pytest.raises(SiteError, match="no file"):
        read_mask(tmp_path / "none.png", 4, 4)
    (tmp_path / "text.png").write_text("no picture")
    with pytest.raises(SiteError, match="not a PNG file"):
        read_mask(tmp_path / "text.png", 4, 4)
