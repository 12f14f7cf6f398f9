"""Triangles against boxes: exact, by separating axes."""

import numpy as np
from numba import njit


@njit
def triangle_meets_box(triangle, x, y, z, half):
    """Whether a triangle, shape (3, 3), meets the closed cube of half edge `half` about (x, y, z).

    Thirteen axes (Akenine-Möller, Fast 3D Triangle-Box Overlap Testing, 2001): those of the cube, the
    triangle's normal, and their products with its edges.
    """
    ax, ay, az = triangle[0, 0] - x, triangle[0, 1] - y, triangle[0, 2] - z
    bx, by, bz = triangle[1, 0] - x, triangle[1, 1] - y, triangle[1, 2] - z
    cx, cy, cz = triangle[2, 0] - x, triangle[2, 1] - y, triangle[2, 2] - z
    if min(ax, bx, cx) > half or max(ax, bx, cx) < -half:
        return False
    if min(ay, by, cy) > half or max(ay, by, cy) < -half:
        return False
    if min(az, bz, cz) > half or max(az, bz, cz) < -half:
        return False
    ux, uy, uz = bx - ax, by - ay, bz - az
    vx, vy, vz = cx - bx, cy - by, cz - bz
    wx, wy, wz = ax - cx, ay - cy, az - cz
    nx, ny, nz = uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx
    if abs(nx * ax + ny * ay + nz * az) > half * (abs(nx) + abs(ny) + abs(nz)):
        return False
    # of the two corners of an edge one suffices: their products with the axis are the same
    return not (
        _apart((ux, uy, uz), (ax, ay, az), (cx, cy, cz), half)
        or _apart((vx, vy, vz), (bx, by, bz), (ax, ay, az), half)
        or _apart((wx, wy, wz), (cx, cy, cz), (bx, by, bz), half)
    )


@njit(inline="always")
def _apart(edge, on_edge, beside, half):
    """Whether a product of the cube's axes with an edge parts it from a triangle, by a corner on it and one beside."""
    ex, ey, ez = edge
    px, py, pz = on_edge
    qx, qy, qz = beside
    p, q = ey * pz - ez * py, ey * qz - ez * qy
    if min(p, q) > half * (abs(ey) + abs(ez)) or max(p, q) < -half * (abs(ey) + abs(ez)):
        return True
    p, q = ez * px - ex * pz, ez * qx - ex * qz
    if min(p, q) > half * (abs(ez) + abs(ex)) or max(p, q) < -half * (abs(ez) + abs(ex)):
        return True
    p, q = ex * py - ey * px, ex * qy - ey * qx
    return min(p, q) > half * (abs(ex) + abs(ey)) or max(p, q) < -half * (abs(ex) + abs(ey))


@njit(cache=True, nogil=True)
def list_patches(samples, reach, first, last, triangles, stops, near, fill):
    """For the samples of one link, the triangles that come within `reach`: counted, or filled in.

    Args:
        samples: `Clusters`.
        reach: how near [m].
        first, last: the clusters of the link, `last` exclusive.
        triangles: of all links, shape (m, 3, 3); stops: the link's, from `stops[0]` to `stops[1]`.
        near: if `fill`, takes the triangles' numbers, one sample after another; else how many, by sample.
    """
    points, centre, radius = samples.points, samples.centre, samples.radius
    some = np.empty(stops[1] - stops[0], dtype=np.int32)
    written = 0
    for cluster in range(first, last):
        count = 0
        x, y, z = centre[cluster, 0], centre[cluster, 1], centre[cluster, 2]
        for triangle in range(stops[0], stops[1]):
            if triangle_meets_box(triangles[triangle], x, y, z, radius[cluster] + reach):
                some[count] = triangle
                count += 1
        for sample in range(samples.start[cluster], samples.stop[cluster]):
            before = written
            x, y, z = (
                np.float64(points[sample, 0]),
                np.float64(points[sample, 1]),
                np.float64(points[sample, 2]),
            )
            for triangle in some[:count]:
                if triangle_meets_box(triangles[triangle], x, y, z, reach):
                    if fill:
                        near[written] = triangle
                    written += 1
            if not fill:
                near[sample] = written - before
    return written
