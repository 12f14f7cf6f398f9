"""How much depths scatter on surfaces, against the margin that they are trusted to."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from elbowroom.finding import Finding
from elbowroom.geometry import DepthCamera
from elbowroom.geometry.margin import Margin
from elbowroom.sensing.frame import DepthFrame
from elbowroom.sensing.values.thinned import Thinned, thinned
from elbowroom.sensing.values.together import together

KIND = "noise"
SIGMAS = 3.0
"""The margin must hold so many standard deviations."""
OVER = 2.5
"""They are more than the margin if they are so many times as much,"""
LEAST_M = 0.01
"""and more than this [m]."""
LEAST_PLACES = 300
TOGETHER = 0.25
"""Of the cameras: where fewer scatter so, what they look at is rough."""
QUARTER, NORMAL = 0.25, 0.3186
"""So large a share of normal errors is no larger than so many standard deviations. What is no plane is larger."""


def look_at_scatter(
    cameras: Sequence[DepthCamera], frames: Sequence[DepthFrame], margin: Margin
) -> tuple[Finding, ...]:
    """Cameras whose depths scatter by more than the site says: what is measured too far by chance reads free.

    Args:
        cameras: of the room.
        frames: at most one of each, of its camera's size.
        margin: of cameras without one of their own.
    """
    by_name = {camera.name: camera for camera in cameras}
    findings, measured = [], 0
    for image in (thinned(by_name[frame.camera], frame) for frame in frames if frame.camera in by_name):
        scatter = scatter_of(image)
        if scatter is None:
            continue
        measured += 1
        sigma_m, at_m = scatter
        of = image.camera.margin or margin
        sensor = 0.0 if image.camera.noise is None else float(image.camera.noise.sigma(at_m))
        trusted = of.sigmas * sensor + of.bias_m + of.range_linear * at_m + of.range_quadratic * at_m**2
        if SIGMAS * sigma_m > max(OVER * trusted, LEAST_M):
            text = (
                f"depths scatter by {1e3 * sigma_m:.0f} mm (standard deviation at {at_m:.1f} m), and are trusted to "
                f"{1e3 * trusted:.0f} mm: what is measured too far by chance reads free. Say noise: a preset of the "
                "sensor, or constant_m, linear, quadratic; or a wider margin"
            )
            findings.append(Finding(KIND, (image.camera.name,), text, stops=False))
    return together(findings, len(cameras)) if len(findings) >= TOGETHER * measured else ()


def scatter_of(image: Thinned) -> tuple[float, float] | None:
    """Standard deviation of depth on surfaces [m], and the depth at which it is so [m]; None: too little is seen.

    On a plane, inverse planar depth is straight across the image: the steps from a pixel to the one beside it are alike
    at neighbours, but for noise. Four errors enter a difference of two steps. Where errors of neighbours are alike, as
    stereo's are, this is less than the scatter.

    Args:
        image: of one camera.
    """
    differences = [
        _differences(image.here, image.right, image.here[:, :-1], image.here[:, 1:], columns=True),
        _differences(image.here, image.below, image.here[:-1], image.here[1:], columns=False),
    ]
    if min(off.size for off, _ in differences) < LEAST_PLACES:
        return None
    return min(
        (float(np.quantile(off, QUARTER)) / (2 * NORMAL), float(np.median(at))) for off, at in differences
    )


def _differences(
    here: NDArray[np.float32],
    beside: NDArray[np.float32],
    one: NDArray[np.float32],
    next_to_it: NDArray[np.float32],
    columns: bool,
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Sizes of the differences of two steps, as depth [m], and the depth there [m].

    Args:
        here, beside: depth, and that of the pixel beside, shape (rows, columns) [m].
        one, next_to_it: depth of two thinned neighbours.
        columns: whether they are neighbours in a row; else in a column.
    """
    with np.errstate(divide="ignore", invalid="ignore"):
        step = 1.0 / beside.astype(np.float64) - 1.0 / here.astype(np.float64)
        other = step[:, 1:] if columns else step[1:]
        step = step[:, :-1] if columns else step[:-1]
        off = np.abs(other - step) * one.astype(np.float64) ** 2
        # infinity beside infinity is no return beside another
        near = (one > 0) & (next_to_it > 0) & (np.abs(next_to_it - one) < 0.05 * one)
    is_there = near & np.isfinite(off)
    return off[is_there], one[is_there].astype(np.float64)
