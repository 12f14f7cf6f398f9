"""How many pixels real depth cameras lose on smooth surfaces, by how obliquely they see them.

The simulator's shares of lost pixels are set by it. A pixel counts where inverse depth runs straight through those two
and three pixels to both sides of it, along its row or its column: a plane, since inverse depth is linear over the image
of one. Holes of more than three pixels, as behind edges, are not counted.
"""

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from elbowroom.errors import InputError

RECORDINGS = {"sevenscenes": 585.0, "piv_table_2cam": 570.0}
"""Focal length of each recording's cameras [px]."""
TANGENTS = (0.0, 1.0, 2.0, 3.0, 4.0, 6.0, 8.0, 12.0)
"""Least tangents of the angle of incidence, of each row."""
STRAIGHT_PER_M = 0.004
"""By how much inverse depth may bend over the support [1/m]."""
NEAREST_M, FARTHEST_M = 0.5, 4.0
NO_RETURN_M = 60.0
"""What a recording says beyond this is that there was no return [m]."""
ROWS = len(RECORDINGS) * len(TANGENTS)


def lost_pixel_rows(data: Path, images: int | None = None) -> Iterator[dict[str, Any]]:
    """A row for each recording and range of tangents.

    Args:
        data: the folder of recordings.
        images: so many of each recording, evenly picked; None: all.

    Yields:
        Rows of recording, tangent_from, tangent_to, pixels, lost_pct.

    Raises:
        InputError: no depth images there.
    """
    for recording, focal_px in RECORDINGS.items():
        files = sorted((data / recording).glob("*depth.png"))
        if not files:
            raise InputError(
                f"{data / recording}: no depth images; name the folder that holds the recordings"
            )
        step = 1 if images is None else max(1, len(files) // images)
        yield from _rows(recording, files[::step][:images], focal_px)


def _rows(recording: str, files: list[Path], focal_px: float) -> Iterator[dict[str, Any]]:
    pixels, lost = np.zeros(len(TANGENTS), dtype=int), np.zeros(len(TANGENTS), dtype=int)
    for file in files:
        depth = np.array(Image.open(file)).astype(float) / 1000
        depth[(depth == 0) | (depth > NO_RETURN_M)] = np.nan
        for turned in (depth, depth.T):
            tangents, gone = counts_of(turned, focal_px)
            at = np.searchsorted(TANGENTS, tangents, side="right") - 1
            pixels += np.bincount(at, minlength=len(TANGENTS))
            lost += np.bincount(at[gone], minlength=len(TANGENTS))
    for start, end, count, gone in zip(TANGENTS, (*TANGENTS[1:], None), pixels, lost, strict=True):
        yield {
            "recording": recording,
            "tangent_from": start,
            "tangent_to": end,
            "pixels": int(count),
            "lost_pct": 100 * float(gone) / int(count) if count else None,
        }


def counts_of(depth_m: NDArray[np.float64], focal_px: float) -> tuple[NDArray[np.float64], NDArray[np.bool_]]:
    """Tangent of the angle of incidence, and whether the pixel is lost, of all that count along rows.

    Args:
        depth_m: planar depth, NaN where there is no return, shape (h, w) [m].
        focal_px: of the camera.
    """
    inverse = 1 / depth_m
    columns = depth_m.shape[1] - 6
    before, left, here, right, after = (inverse[:, at : at + columns] for at in (0, 1, 3, 5, 6))
    slope, middle = (right - left) / 4, (left + right) / 2
    straight = np.abs(left - slope - before) < STRAIGHT_PER_M
    straight &= np.abs(right + slope - after) < STRAIGHT_PER_M
    straight &= (middle > 1 / FARTHEST_M) & (middle < 1 / NEAREST_M)
    return (np.abs(slope) * focal_px / middle)[straight], np.isnan(here)[straight]
