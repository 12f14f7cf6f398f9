"""What makes intrinsics no result: a lens of another image size, one that is hardly known, corners that do not fit."""

from collections.abc import Sequence

import numpy as np

from elbowroom.calibrate.intrinsics.solve import FoundIntrinsics

FOCAL_SHARE = 0.3
"""A focal length that changes by a larger share is that of another camera, or of another size of image."""
UNEVEN = 0.1
"""Pixels are square to so much."""
MIDDLE = 0.25
"""Share of the image's size by which the principal point may lie off its middle."""
UNSURE = 0.05
"""Sigma of a focal length as a share of it, beyond which it is not known."""
WORST_PX = 2.0
"""What is left over at the corners [px rms] where the board is not this one, or not flat."""


def doubts_of_lens(found: Sequence[FoundIntrinsics]) -> tuple[str, ...]:
    """Why what was found of cameras is no result, a sentence each; none: it is one."""
    return tuple(f"{one.camera.name}: {words}" for one in found for words in _doubts(one))


def _doubts(one: FoundIntrinsics) -> list[str]:
    k, before, words = one.camera.intrinsics, one.before.intrinsics, []
    ratio = k.fx / before.fx
    if abs(np.log(ratio)) > np.log(1 + FOCAL_SHARE):
        size = f"{one.camera.width / ratio:.0f} x {one.camera.height / ratio:.0f}"
        words.append(
            f"fx {before.fx:.0f} became {k.fx:.0f} px: the site's lens is another camera's, or of an image of {size} "
            "pixels; write roughly what the maker says for this size, and calibrate again"
        )
    if abs(k.fx / k.fy - 1) > UNEVEN:
        words.append(
            f"fx {k.fx:.0f} and fy {k.fy:.0f} px differ: sides of the board exchanged, or too few tilts"
        )
    off = max(
        abs(k.cx - (one.camera.width - 1) / 2) / one.camera.width,
        abs(k.cy - (one.camera.height - 1) / 2) / one.camera.height,
    )
    if off > MIDDLE:
        words.append(
            f"its principal point ({k.cx:.0f}, {k.cy:.0f}) is far from the image's middle; more poses, tilted"
        )
    unsure = float(max(one.sigma[0] / k.fx, one.sigma[1] / k.fy))
    if not unsure <= UNSURE:
        words.append(f"its focal length is known to {100 * unsure:.0f} % only; more poses, nearer and tilted")
    left = float(np.sqrt(np.mean(one.residuals_px**2)))
    if left > WORST_PX:
        words.append(
            f"corners are {left:.1f} px off (rms): another board, one that is not flat, or images of several cameras"
        )
    return words
