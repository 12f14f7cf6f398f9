"""Naive twin of `from_machine.kernels.surface.compare`: pixel by pixel, derivatives by moving the camera a little."""

import numpy as np

from elbowroom.geometry.twist import exp

LITTLE = 1e-6


def plane_about(inverse, u, v, camera):
    """q with q.p = 1 on the drawn surface's plane, from the slope of inverse depth."""
    k = camera.intrinsics
    slope = np.array(
        [
            (float(inverse[v, u + 1]) - float(inverse[v, u - 1])) / 2 * k.fx,
            (float(inverse[v + 1, u]) - float(inverse[v - 1, u])) / 2 * k.fy,
        ]
    )
    ray = np.array([(u - k.cx) / k.fx, (v - k.cy) / k.fy, 1.0])
    return np.array([*slope, float(inverse[v, u]) - slope @ ray[:2]]), ray


def depth_after(q, ray, twist):
    """Depth along a ray once the camera has moved by the twist in its own frame."""
    motion = exp(twist)
    return (1 - q @ motion[:3, 3]) / (q @ (motion[:3, :3] @ ray))


def smooth(inverse, u, v, border, step_m):
    height, width = inverse.shape
    if not (border <= u < width - border and border <= v < height - border):
        return False
    middle = float(inverse[v, u])
    allowed = step_m * middle**2
    for far in range(1, border + 1):
        for du, dv in ((far, 0), (0, far), (far, far), (far, -far)):
            one, two = float(inverse[v + dv, u + du]), float(inverse[v - dv, u - du])
            if one == 0 or two == 0:
                return False
            if abs(one + two - 2 * middle) > allowed or abs(one - two) > 8 * far * allowed:
                return False
    return True


def compare(camera, inverse, measured, bias, scale, trust):
    """Sums J^T J, J^T r and counts over all pixels of the surface, as the kernel does."""
    normal, gradient, counts = np.zeros((8, 8)), np.zeros(8), np.zeros(5, dtype=int)
    for v, u in np.argwhere(inverse > 0):
        if not smooth(inverse, u, v, trust.border, trust.step_m):
            continue
        q, ray = plane_about(inverse, u, v, camera)
        if (q @ ray) / np.linalg.norm(q) / np.linalg.norm(ray) < trust.least_cosine:
            continue
        counts[0] += 1
        z = float(measured[v, u])
        if not z > 0:
            counts[4] += 1
            continue
        drawn = 1 / (q @ ray)
        stretch = np.linalg.norm(ray) if camera.depth_kind == "radial" else 1.0
        slope_px = trust.lateral_px * np.hypot(*(q[:2] / (camera.intrinsics.fx, camera.intrinsics.fy)))
        own = camera.noise.sigma(drawn * stretch) / stretch if camera.noise else 0.0
        parts = (own, trust.floor_m, trust.widening_m, slope_px * drawn**2)
        sigma = np.sqrt(sum(part**2 for part in parts))

        def residual(change, q=q, ray=ray, z=z, stretch=stretch, sigma=sigma):
            depth = depth_after(q, ray, change[:6])
            return (z - depth * (1 + scale + change[7]) - (bias + change[6]) / stretch) / sigma

        r = residual(np.zeros(8))
        if abs(r) >= trust.reach:
            counts[2 if r > 0 else 3] += 1
            continue
        counts[1] += 1
        weight = (1 - (r / trust.reach) ** 2) ** 2
        slopes = [(residual(LITTLE * one) - residual(-LITTLE * one)) / (2 * LITTLE) for one in np.eye(8)]
        normal += weight * np.outer(slopes, slopes)
        gradient += weight * r * np.array(slopes)
    return normal, gradient, counts
