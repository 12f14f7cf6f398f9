"""The plane that a depth image of the board shows: three numbers and how sure they are.

A plane is m with m · X = 1 for its points X, camera frame [1/m]. The return in direction d, at depth z, is the point
z d, so 1/z = m · d: the depth points say of the board's pose what m and its covariance say.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from elbowroom.geometry import DepthCamera
from elbowroom.geometry.lens import directions

Array = NDArray[np.float64]
LEAST_POINTS = 12
ASSUMED_SIGMA_M = 0.002
"""Of depth, where a camera has no noise model [m]."""
WORST_CONDITION = 1e12
"""Of the normal equations: beyond it the points lie in a line."""
MOST_INDEPENDENT = 300.0
"""Points that count as independent: what neighbouring pixels have in common does not average out. Where their
noise is independent after all, the variances that are estimated with the poses say so."""
TUKEY = 4.685
"""Residuals beyond so many sigmas count nothing (95 % efficiency; Holland, Welsch 1977)."""


@dataclass(frozen=True, slots=True, eq=False)
class SeenPlane:
    """What depth says of the board in one image.

    Args:
        m: the plane, shape (3,), camera frame [1/m].
        root: shape (3, 3): root @ (error of m) has variance one in each direction.
        by_bias: how m changes by a metre of bias of the depth, shape (3,).
        by_scale: how m changes by a unit of its scale error, shape (3,).
        residuals_m: measured depth less the plane's, shape (n,) [m].
    """

    m: Array
    root: Array
    by_bias: Array
    by_scale: Array
    residuals_m: Array


def rays_of(camera: DepthCamera, pixels: Array) -> Array:
    """Directions whose multiple by the camera's kind of depth is the point, shape (n, 3)."""
    rays = np.column_stack(
        [directions(camera.intrinsics, pixels, f"camera {camera.name}"), np.ones(len(pixels))]
    )
    return rays if camera.depth_kind == "planar" else rays / np.linalg.norm(rays, axis=1, keepdims=True)


def seen_plane(camera: DepthCamera, pixels: Array, depth_m: Array) -> SeenPlane | None:
    """Fits the plane, by Gauss-Newton on depth with Tukey's weights.

    Args:
        camera: with its noise model, if it has one.
        pixels: shape (n, 2) [px].
        depth_m: shape (n,) [m, the camera's kind].

    Returns:
        None: too few points, or all in one line.
    """
    if len(depth_m) < LEAST_POINTS:
        return None
    d = rays_of(camera, pixels)
    sigma = (
        np.full(len(depth_m), ASSUMED_SIGMA_M) if camera.noise is None else camera.noise.sigma(depth_m) + 1e-5
    )
    rows = d * (depth_m / sigma)[:, None]
    if np.linalg.cond(rows.T @ rows) > WORST_CONDITION:
        return None
    m = np.linalg.solve(rows.T @ rows, rows.T @ (1 / sigma))
    weight = np.ones(len(depth_m))
    for _ in range(8):
        inverse = d @ m
        if (inverse <= 0).any():
            return None
        slope = d / inverse[:, None] ** 2  # of z = 1 / (m · d) by -m
        off = (1 / inverse - depth_m) / sigma
        spread = max(1.0, 1.4826 * float(np.median(np.abs(off))))
        weight = np.maximum(1 - (off / (TUKEY * spread)) ** 2, 0.0) ** 2
        rows = slope * (np.sqrt(weight) / sigma)[:, None]
        if np.linalg.cond(rows.T @ rows) > WORST_CONDITION:
            return None
        step = np.linalg.solve(rows.T @ rows, rows.T @ (np.sqrt(weight) * off))
        m = m + step
        if np.abs(step).max() < 1e-10 * np.abs(m).max():
            break
    inverse = d @ m
    slope = d / inverse[:, None] ** 2
    rows = slope * (np.sqrt(weight) / sigma)[:, None]
    information = np.asarray(rows.T @ rows, dtype=np.float64)
    if np.linalg.cond(information) > WORST_CONDITION or (inverse <= 0).any():
        return None
    # a bias b lets m move as the fit follows z + b
    by_bias = np.asarray(-np.linalg.solve(information, rows.T @ (np.sqrt(weight) / sigma)), dtype=np.float64)
    off_m = np.asarray(depth_m - 1 / inverse, dtype=np.float64)
    found: Array = m.astype(np.float64)
    information *= min(1.0, MOST_INDEPENDENT / float(weight.sum()))
    root: Array = np.linalg.cholesky(information).T.astype(np.float64)
    return SeenPlane(found, root, by_bias, -found, off_m)
