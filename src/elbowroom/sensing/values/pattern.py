"""Patterns that no surface makes: depth in coarse steps, and every second row or column without a return."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from elbowroom.finding import Finding
from elbowroom.sensing.values.thinned import Thinned

STEPS, COMB = "steps", "rows"
COARSE_M = 0.012
"""All depths of a picture of 8 bits are multiples of so much or more; of none that a sensor writes, in centimetres or
finer [m]."""
LEAST_DIFFERENT = 4
LEAST_PIXELS = 200
ONE_OF_TWO = 0.95
"""Of two neighbours of which one has a return, so often it is one alone; at edges and holes it is one in some."""


def look_at_patterns(images: Sequence[Thinned]) -> list[Finding]:
    """What is lost on the way of an image: bits, or rows. Both free less, or nearer than the truth by a step.

    Args:
        images: one of each camera.
    """
    return [finding for image in images for finding in (*_steps(image), *_comb(image))]


def _steps(image: Thinned) -> list[Finding]:
    codes, unit = image.codes, image.unit_m
    if codes is None or unit is None or codes.size < LEAST_PIXELS:
        return []
    different = np.unique(codes)
    step_m = float(np.gcd.reduce(different)) * unit
    if different.size < LEAST_DIFFERENT or step_m < COARSE_M:
        return []
    text = (
        f"all depths are multiples of {1e3 * step_m:.4g} mm, {different.size} different ones: most likely a picture of "
        "8 bits that was scaled. Give the sensor's own 16-bit depth; or a margin that holds such a step (bias_m)"
    )
    return [Finding(STEPS, (image.camera.name,), text, stops=False)]


def _comb(image: Thinned) -> list[Finding]:
    for words, beside in (("row", image.below), ("column", image.right)):
        if _is_comb(image.here, beside):
            text = (
                f"every second {words} has no return: what is there disputes nearly all, and nothing can read free. "
                "Check how images are written (interlaced, bytes a pixel, width), or the sensor's decimation"
            )
            return [Finding(COMB, (image.camera.name,), text, stops=False)]
    return []


def _is_comb(here: NDArray[np.float32], beside: NDArray[np.float32]) -> bool:
    one, other = here > 0, beside > 0
    some = np.count_nonzero(one | other)
    alone = np.count_nonzero(one ^ other)
    return bool(some >= LEAST_PIXELS and alone >= ONE_OF_TWO * some)
