"""Naive twins of `calibrate.refinement.kernels.overlap`: planes by least squares, points one by one."""

import numpy as np

from elbowroom.geometry.twist import exp

LITTLE = 1e-6


def fit_plane(depth, u, v, camera, half, bend):
    """q with q.p = 1 fitted to the inverse depth about a pixel; None: no plane there."""
    height, width = depth.shape
    if not (half <= u < width - half and half <= v < height - half):
        return None
    window = depth[v - half : v + half + 1, u - half : u + half + 1].astype(float)
    middle = window[half, half]
    if not (window > 0).all() or (np.abs(window - middle) >= 3 * bend * middle).any():
        return None
    dv, du = np.mgrid[-half : half + 1, -half : half + 1]
    columns = np.stack([np.ones(window.size), du.ravel(), dv.ravel()], axis=1)
    (w0, wu, wv), *_ = np.linalg.lstsq(columns, 1 / window.ravel(), rcond=None)
    off = 1 / window.ravel() - columns @ (w0, wu, wv)
    if np.sqrt(np.mean(off**2)) > bend * w0:
        return None
    k = camera.intrinsics
    qx, qy = wu * k.fx, wv * k.fy
    return np.array([qx, qy, w0 - (u - k.cx) / k.fx * qx - (v - k.cy) / k.fy * qy])


def compare_points(camera, depth, planes, points, normals, sigmas, other_from_one, rule):
    """Sums of all tiles together, counts, and what noise in the slopes makes up."""
    by_noise = np.zeros((6, 6))
    normal, gradient, counts = np.zeros((6, 6)), np.zeros(6), np.zeros(4, dtype=int)
    k = camera.intrinsics
    for point, direction, own in zip(points, normals, sigmas, strict=True):
        p = other_from_one[:3, :3] @ point + other_from_one[:3, 3]
        if p[2] <= 0.05:
            continue
        u, v = k.fx * p[0] / p[2] + k.cx, k.fy * p[1] / p[2] + k.cy
        if not (0 <= u <= camera.width - 1 and 0 <= v <= camera.height - 1):
            continue
        column, row = int(np.floor(u + 0.5)), int(np.floor(v + 0.5))
        q = planes[row, column].astype(float)
        if not q.any():
            continue
        counts[0] += 1
        n, ray = q / np.linalg.norm(q), np.array([(column - k.cx) / k.fx, (row - k.cy) / k.fy, 1.0])
        off = n @ p - 1 / np.linalg.norm(q)
        z = float(depth[row, column])
        far = z * (np.linalg.norm(ray) if camera.depth_kind == "radial" else 1.0)
        noise = float(camera.noise.sigma(far)) if camera.noise else 0.0
        sigma = np.sqrt((noise * abs(n @ ray) / np.linalg.norm(ray)) ** 2 + own**2 + rule.floor_m**2)
        limit = max(rule.gate_m, rule.reach * sigma)
        if abs(off) >= limit or n @ (other_from_one[:3, :3] @ direction) < rule.least_cosine:
            counts[2 if p[2] > z else 3] += 1
            continue
        counts[1] += 1
        weight = (1 - (off / limit) ** 2) ** 2 / sigma**2

        def moved(twist, p=p, n=n):
            motion = exp(twist)
            return n @ (motion[:3, :3] @ p + motion[:3, 3])

        slopes = np.array([(moved(LITTLE * one) - moved(-LITTLE * one)) / (2 * LITTLE) for one in np.eye(6)])
        normal += weight * np.outer(slopes, slopes)
        gradient += weight * off * slopes
        tilt = noise * k.fx / (z * rule.arm_px)
        for axis in np.linalg.svd(n[None])[2][1:]:
            along = np.concatenate([np.cross(p, axis), axis])
            by_noise += weight * tilt**2 * np.outer(along, along)
    return normal, gradient, counts, by_noise
