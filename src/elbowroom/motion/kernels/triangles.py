"""Triangles against boxes: exact, by separating axes."""

import numpy as np
from numba import njit


@njit
def triangle_meets_box(triangle, x, y, z, half):
    """Whether a triangle, shape (3, 3), meets the closed cube of half edge `half` about (x, y, z).

    Thirteen axes (Akenine-Möller, Fast 3D Triangle-Box Overlap Testing, 2001): those of the cube, the
    triangle's normal, and their products with its edges.
    """
    a = triangle[0, 0] - x, triangle[0, 1] - y, triangle[0, 2] - z
    b = triangle[1, 0] - x, triangle[1, 1] - y, triangle[1, 2] - z
    c = triangle[2, 0] - x, triangle[2, 1] - y, triangle[2, 2] - z
    for axis in range(3):
        if min(a[axis], b[axis], c[axis]) > half or max(a[axis], b[axis], c[axis]) < -half:
            return False
    u, v, w = _less(b, a), _less(c, b), _less(a, c)
    n = u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]
    if abs(n[0] * a[0] + n[1] * a[1] + n[2] * a[2]) > half * (abs(n[0]) + abs(n[1]) + abs(n[2])):
        return False
    # of the two corners of an edge one suffices: their products with the axis are the same
    return not (_apart(u, a, c, half) or _apart(v, b, a, half) or _apart(w, c, b, half))


@njit(inline="always")
def _less(a, b):
    """a - b, of three numbers each."""
    return a[0] - b[0], a[1] - b[1], a[2] - b[2]


@njit(inline="always")
def _apart(edge, on, beside, half):
    """Whether a product of the cube's axes with an edge parts it from a triangle: a corner on the edge, one beside."""
    for axis in range(3):
        one, two = (axis + 1) % 3, (axis + 2) % 3
        p = edge[one] * on[two] - edge[two] * on[one]
        q = edge[one] * beside[two] - edge[two] * beside[one]
        reach = half * (abs(edge[one]) + abs(edge[two]))
        if min(p, q) > reach or max(p, q) < -reach:
            return True
    return False


@njit(cache=True, nogil=True)
def list_patches(clusters, reach, first, last, triangles, stops, near, fill):
    """For the samples of one link, the triangles that come within `reach`: counted, or filled in.

    Args:
        clusters: samples (`machine.kernels.body.Clusters`).
        first, last: the clusters of the link, `last` exclusive.
        triangles: of all links, shape (m, 3, 3); stops: the link's, from `stops[0]` to `stops[1]`.
        near: if `fill`, takes the triangles' numbers, one sample after another; else how many, by sample.
    """
    points, centre = clusters.points, clusters.centre
    some = np.empty(stops[1] - stops[0], dtype=np.int32)
    written = 0
    for cluster in range(first, last):
        count = 0
        x, y, z = centre[cluster, 0], centre[cluster, 1], centre[cluster, 2]
        r = clusters.radius[cluster] + reach
        for triangle in range(stops[0], stops[1]):
            if triangle_meets_box(triangles[triangle], x, y, z, r):
                some[count] = triangle
                count += 1
        for sample in range(clusters.start[cluster], clusters.stop[cluster]):
            before = written
            x, y, z = float(points[sample, 0]), float(points[sample, 1]), float(points[sample, 2])
            for triangle in some[:count]:
                if triangle_meets_box(triangles[triangle], x, y, z, reach):
                    if fill:
                        near[written] = triangle
                    written += 1
            if not fill:
                near[sample] = written - before
    return written
