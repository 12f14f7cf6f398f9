"""Disparity or inverse depth where depth is meant: surfaces tell, since on a plane 1/z is straight across the image."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from elbowroom.finding import Finding
from elbowroom.sensing.values.thinned import Thinned

KIND = "disparity"
REACHES = (2, 4, 8)
"""Thinned pixels between the three that are compared."""
WITHIN = 0.5
"""The three belong to one surface if they differ by less, as a share."""
BENT = 0.02
"""Less bend than this, as a share of the value, tells nothing."""
MUCH = 4.0
"""One of the two is straighter by so much."""
LEAST_VOTES, LEAST_SHARE = 60, 0.8


def look_at_inverses(images: Sequence[Thinned]) -> list[Finding]:
    """Images whose own values are straight across surfaces, and not their reciprocals.

    Args:
        images: one of each camera.
    """
    findings = []
    for image in images:
        inverse, depth = votes(image)
        if inverse >= LEAST_VOTES and inverse >= LEAST_SHARE * (inverse + depth):
            text = (
                f"surfaces are straight in its values, not in their reciprocals ({inverse} places of "
                f"{inverse + depth}): "
                "this is disparity or inverse depth, where near is large. Give depth: baseline x focal length / "
                "disparity"
            )
            findings.append(Finding(KIND, (image.camera.name,), text, stops=True))
    return findings


def votes(image: Thinned) -> tuple[int, int]:
    """How many places look like disparity, and how many like depth."""
    planar = np.where(image.returns, image.ranges_m / image.over_planar, 0.0)
    inverse = depth = 0
    for reach in REACHES:
        for values in (planar, planar.T):
            one, two = _votes(values, reach)
            inverse, depth = inverse + one, depth + two
    return inverse, depth


def _votes(z: NDArray[np.float64], reach: int) -> tuple[int, int]:
    a, b, c = z[: -2 * reach, :], z[reach:-reach, :], z[2 * reach :, :]
    least, greatest = np.minimum(np.minimum(a, b), c), np.maximum(np.maximum(a, b), c)
    # the middle between the others, as on any surface that does not turn back
    usable = (least > 0) & (greatest - least < WITHIN * greatest) & ((a - b) * (b - c) > 0)
    a, b, c = a[usable], b[usable], c[usable]
    of_values = np.abs(a - 2 * b + c) / b
    of_inverses = np.abs(1 / a - 2 / b + 1 / c) * b
    bent = np.maximum(of_values, of_inverses) > BENT
    return (
        int(np.count_nonzero(bent & (of_inverses > MUCH * of_values))),
        int(np.count_nonzero(bent & (of_values > MUCH * of_inverses))),
    )
