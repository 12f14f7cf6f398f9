"""What a pose's covariance makes of the carve margin: lateral pixels, and metres at range.

A point x that a camera measures lies, because of the pose's error (w, t) in the camera's frame, at x + w × x + t. That
is linear in the error, so over the ellipsoid e^T S^-1 e <= k^2 each displacement a^T e is at most k sqrt(a^T S a). With
k^2 the quantile of chi-square with 6 degrees of freedom, all displacements of all pixels at all depths stay within
their bounds at once, with the stated confidence (Scheffé's method).
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.stats import chi2

from elbowroom.errors import CalibrationError
from elbowroom.geometry import DepthCamera
from elbowroom.sensing import Margin

CONFIDENCE = 0.95
"""That nothing a camera sees is displaced by more than its margin."""
NEAR_M = 1.0
"""A shift of the camera is more pixels the nearer a thing is: the lateral margin holds from here on [m]."""
GRID = (33, 25)
"""Places of the image, along u and v, borders included, at which displacements are bounded."""


@dataclass(frozen=True, slots=True)
class PoseMargin:
    """By how much a pose that is not quite right displaces what a camera sees.

    Args:
        lateral_px: along u or along v, whichever is more [px].
        bias_m: along the ray, at any range [m].
        range_linear: along the ray, per metre of range.
    """

    lateral_px: float
    bias_m: float
    range_linear: float

    def over(self, sensor: Margin) -> Margin:
        """The margin of the sensor and of the pose together: both may err the same way, so they are summed."""
        return Margin(
            sigmas=sensor.sigmas,
            bias_m=sensor.bias_m + self.bias_m,
            lateral_px=sensor.lateral_px + self.lateral_px,
            range_linear=sensor.range_linear + self.range_linear,
            range_quadratic=sensor.range_quadratic,
        )


def pose_margin(
    camera: DepthCamera,
    covariance: NDArray[np.float64],
    *,
    confidence: float = CONFIDENCE,
    near_m: float | None = None,
) -> PoseMargin:
    """The displacements that an error of the pose makes, at a confidence.

    Args:
        camera: with the intrinsics to which its images are rectified.
        covariance: of its pose, shape (6, 6), as in `CalibratedCamera`.
        confidence: that the true pose is within what is bounded.
        near_m: depth from which the lateral bound holds [m]; None: `NEAR_M`, or the camera's least depth if more.

    Raises:
        CalibrationError: a confidence outside 0.5 to 1, a depth that is not above 0.
    """
    if not 0.5 <= confidence < 1:
        raise CalibrationError(f"confidence is {confidence}, must be 0.5 or more and below 1")
    near = max(NEAR_M, camera.min_depth_m) if near_m is None else near_m
    if not near > 0:
        raise CalibrationError(f"near_m is {near}, must be above 0")
    times = float(np.sqrt(chi2.ppf(confidence, 6)))
    k = camera.intrinsics
    u = np.linspace(-0.5, camera.width - 0.5, GRID[0])
    v = np.linspace(-0.5, camera.height - 0.5, GRID[1])
    x, y = (a.ravel() for a in np.meshgrid((u - k.cx) / k.fx, (v - k.cy) / k.fy))
    ones, zeros = np.ones_like(x), np.zeros_like(x)
    # by depth: w × (x, y, 1); and t over depth
    turned = np.stack(
        [
            np.stack([zeros, ones, -y], axis=1),
            np.stack([-ones, zeros, x], axis=1),
            np.stack([y, -x, zeros], axis=1),
        ]
    )
    moved = np.broadcast_to(np.eye(3)[:, None, :], turned.shape)

    def lateral(inverse_depth: float) -> float:
        shift = np.concatenate([turned, moved * inverse_depth], axis=2)
        along_u = k.fx * (shift[0] - x[:, None] * shift[2])
        along_v = k.fy * (shift[1] - y[:, None] * shift[2])
        return max(_greatest(along_u, covariance), _greatest(along_v, covariance))

    if camera.depth_kind == "radial":
        # the distance from the centre does not change when the camera turns
        rays = np.stack([x, y, ones], axis=1) / np.sqrt(1 + x * x + y * y)[:, None]
        bias, linear = _greatest(rays, covariance[3:, 3:]), 0.0
    else:
        bias = float(np.sqrt(max(covariance[5, 5], 0.0)))
        linear = _greatest(turned[2], covariance[:3, :3])
    # a norm of something affine in 1 / depth is greatest at one of the ends: there, or far away
    return PoseMargin(
        lateral_px=times * max(lateral(0.0), lateral(1 / near)),
        bias_m=times * bias,
        range_linear=times * linear,
    )


def _greatest(rows: NDArray[np.float64], covariance: NDArray[np.float64]) -> float:
    """The greatest standard deviation of a^T e over the rows a, shape (n, k)."""
    return float(np.sqrt(np.maximum(np.einsum("ni,ij,nj->n", rows, covariance, rows), 0.0)).max())
