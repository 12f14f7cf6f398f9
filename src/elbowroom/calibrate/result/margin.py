"""What a pose's covariance makes of the carve margin: lateral pixels, and metres at range.

A point x that a camera measures lies, because of the pose's error e = (w, t) in the camera's frame, at x + w × x + t.
So each displacement is linear in the error: a^T e. The margin is made of the largest standard deviations, times the
one factor k with which, at the stated confidence, *all* displacements of all pixels at all depths stay within their
bounds at once: the quantile of the greatest of them. Errors are r L d with the direction d even on the sphere, r^2
chi-square with 6 degrees of freedom and L L^T the covariance, so

    P(all within k) = mean over d of F((k / g(d))^2),   g(d) = max over a of |a^T L d| / bound of a

with F the chi-square distribution. g is at most 1, so k is at most that of Scheffé's method, F(k^2) = confidence,
which bounds every a^T e there could be, not only those that a camera has.
"""

from dataclasses import dataclass
from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq
from scipy.stats import chi2, norm, qmc

from elbowroom.errors import CalibrationError
from elbowroom.geometry import DepthCamera
from elbowroom.sensing import Margin

Array = NDArray[np.float64]
CONFIDENCE = 0.95
"""That nothing a camera sees is displaced by more than its margin."""
NEAR_M = 1.0
"""A shift of the camera is more pixels the nearer a thing is: the lateral margin holds from here on [m]."""
GRID = (17, 13)
"""Places of the image, along u and v, borders included, at which displacements are bounded."""
DIRECTIONS_LOG2 = 10
"""Of as many directions of the error, as a power of two, the factor is found: to half a per cent."""


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
    rows = _displacements(camera, near)
    values, vectors = np.linalg.eigh(covariance)
    root = vectors * np.sqrt(np.maximum(values, 0.0))
    lateral, bias, linear = (_greatest(one @ root) for one in rows)
    times = _factor(rows, root, (lateral, bias, linear), confidence)
    return PoseMargin(lateral_px=times * lateral, bias_m=times * bias, range_linear=times * linear)


def is_within(camera: DepthCamera, error: Array, margin: PoseMargin, near_m: float = NEAR_M) -> bool:
    """Whether an error of the pose displaces nothing that the camera sees by more than a margin.

    Args:
        camera: with its intrinsics.
        error: rotation vector [rad] and translation [m] in the camera's frame, shape (6,).
        margin: as of `pose_margin`.
        near_m: depth from which the lateral bound holds [m].
    """
    bounds = (margin.lateral_px, margin.bias_m, margin.range_linear)
    rows = _displacements(camera, near_m)
    return all(bool((np.abs(one @ error) <= bound).all()) for one, bound in zip(rows, bounds, strict=True))


class _Displacements(NamedTuple):
    """Rows a of which a^T e is a displacement, each of shape (n, 6): lateral [px], along the ray [m], and per metre."""

    lateral: Array
    bias: Array
    linear: Array


def _displacements(camera: DepthCamera, near_m: float) -> _Displacements:
    k = camera.intrinsics
    u = np.linspace(-0.5, camera.width - 0.5, GRID[0])
    v = np.linspace(-0.5, camera.height - 0.5, GRID[1])
    x, y = (a.ravel() for a in np.meshgrid((u - k.cx) / k.fx, (v - k.cy) / k.fy))
    ones, zeros, none = np.ones_like(x), np.zeros_like(x), np.zeros((len(x), 3))
    # by depth: w × (x, y, 1); and t over depth
    turned = np.stack(
        [
            np.stack([zeros, ones, -y], axis=1),
            np.stack([-ones, zeros, x], axis=1),
            np.stack([y, -x, zeros], axis=1),
        ]
    )
    moved = np.broadcast_to(np.eye(3)[:, None, :], turned.shape)
    lateral = []
    # what is affine in 1 / depth is greatest at one of the ends: there, or far away
    for inverse_depth in (0.0, 1 / near_m):
        shift = np.concatenate([turned, moved * inverse_depth], axis=2)
        lateral.append(k.fx * (shift[0] - x[:, None] * shift[2]))
        lateral.append(k.fy * (shift[1] - y[:, None] * shift[2]))
    if camera.depth_kind == "radial":
        # the distance from the centre does not change when the camera turns
        rays = np.stack([x, y, ones], axis=1) / np.sqrt(1 + x * x + y * y)[:, None]
        bias, linear = np.concatenate([none, rays], axis=1), np.zeros((1, 6))
    else:
        bias, linear = np.eye(6)[5:], np.concatenate([turned[2], none], axis=1)
    return _Displacements(np.concatenate(lateral), bias, linear)


def _greatest(rows: Array) -> float:
    """The greatest standard deviation over rows a^T L, shape (n, 6)."""
    return float(np.linalg.norm(rows, axis=1).max())


def _factor(
    rows: _Displacements, root: Array, sigmas: tuple[float, float, float], confidence: float
) -> float:
    """By how much the largest standard deviations are to be multiplied."""
    most = np.zeros(2**DIRECTIONS_LOG2)
    for one, sigma in zip(rows, sigmas, strict=True):
        if sigma > 0:
            most = np.maximum(most, np.abs(_directions() @ (one @ root).T).max(axis=1) / sigma)
    if not most.any():
        return 0.0
    scheffe = float(np.sqrt(chi2.ppf(confidence, 6)))
    squares = np.maximum(most, 1e-9) ** 2

    def short(times: float) -> float:
        return float(chi2.cdf(times**2 / squares, 6).mean()) - confidence

    return scheffe if short(scheffe) <= 0 else float(brentq(short, 0.0, scheffe))


@lru_cache(maxsize=1)
def _directions() -> Array:
    """Even over the sphere of six dimensions and always the same, shape (n, 6)."""
    even = qmc.Sobol(6, rng=np.random.default_rng(6)).random_base2(DIRECTIONS_LOG2)
    normal = norm.ppf(np.clip(even, 1e-12, 1 - 1e-12))
    return np.asarray(normal / np.linalg.norm(normal, axis=1, keepdims=True), dtype=np.float64)
