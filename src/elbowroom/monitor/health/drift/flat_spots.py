"""Places of a depth image where the surface is flat, with their normals."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

ANGLE_RAD = 0.02
"""Half the side of the window in which a surface must be flat: a camera that turns by a degree stays within it."""
LEAST_COSINE = 0.2
"""Surfaces are left out that are seen at a more grazing angle than 78 degrees."""
FLAT_M = 0.004
FLAT_SIGMAS = 2.0
"""The plane of a window may miss its depths by so much, root of the mean square."""


@dataclass(frozen=True, slots=True, eq=False)
class FlatSpots:
    """Where an image is flat, per pixel.

    Args:
        flat: shape (h, w).
        planar_m: depth of the fitted plane along the optical axis [m], meaningless where it is not flat.
        normal: unit vectors towards the camera, camera frame, shape (h, w, 3).
        cosine: of the angle between normal and ray, shape (h, w).
    """

    flat: NDArray[np.bool_]
    planar_m: NDArray[np.float64]
    normal: NDArray[np.float64]
    cosine: NDArray[np.float64]


def flat_spots(
    planar_m: NDArray[np.float64],
    x: NDArray[np.float64],
    y: NDArray[np.float64],
    sigma_m: NDArray[np.float64],
) -> FlatSpots:
    """Fits a plane about each pixel: for a plane, 1 / depth is linear in X/Z and Y/Z.

    Args:
        planar_m: depth along the optical axis, shape (h, w) [m]; 0: none.
        x, y: X/Z and Y/Z of the pixels, shape (h, w).
        sigma_m: standard deviation of these depths, shape (h, w) [m].
    """
    from scipy.ndimage import uniform_filter  # slow to load, and only a commissioned room needs it

    pitch = float(np.median(np.abs(np.diff(x, axis=1)))) if x.shape[1] > 1 else 1.0
    size = 2 * max(1, round(ANGLE_RAD / pitch)) + 1
    valid = planar_m > 0
    w = np.divide(1.0, planar_m, out=np.zeros_like(planar_m), where=valid)

    def mean(image: NDArray[np.float64]) -> NDArray[np.float64]:
        smoothed: NDArray[np.float64] = uniform_filter(image, size, mode="constant")
        return smoothed

    whole = mean(valid.astype(float)) > 1 - 1e-9
    mx, my, mw = mean(x), mean(y), mean(w)
    xx, xy, yy = mean(x * x) - mx * mx, mean(x * y) - mx * my, mean(y * y) - my * my
    xw, yw, ww = mean(x * w) - mx * mw, mean(y * w) - my * mw, mean(w * w) - mw * mw
    determinant = np.where(whole, xx * yy - xy * xy, 1.0)
    along = (yy * xw - xy * yw) / determinant
    down = (xx * yw - xy * xw) / determinant
    at_axis = mw - along * mx - down * my
    fitted = at_axis + along * x + down * y
    missed = ww - along * xw - down * yw
    depth = np.divide(1.0, fitted, out=np.zeros_like(fitted), where=whole & (fitted > 1e-6))
    miss_m = np.sqrt(np.maximum(missed, 0.0)) * depth * depth
    normal = -np.stack([along, down, at_axis], axis=-1)
    normal /= np.maximum(np.linalg.norm(normal, axis=-1, keepdims=True), 1e-12)
    ray = np.stack([x, y, np.ones_like(x)], axis=-1)
    cosine = -np.sum(normal * ray, axis=-1) / np.linalg.norm(ray, axis=-1)
    flat = whole & (depth > 0) & (cosine >= LEAST_COSINE) & (miss_m <= FLAT_M + FLAT_SIGMAS * sigma_m)
    return FlatSpots(flat, depth, normal, cosine)
