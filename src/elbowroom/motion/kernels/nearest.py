"""How far a body's samples are from the nearest marked voxel: balls of samples against cubes, words, voxels."""

import math
from typing import NamedTuple

import numpy as np
from numba import njit

from elbowroom.geometry.kernels.bits import Lattice, bit_of, uncounted, word_of
from elbowroom.motion.kernels.mover import carried
from elbowroom.motion.kernels.volume import cell_of, gap

NOTHING, VOXEL, OUTSIDE = 0, 1, 2
"""What is nearest: nothing within reach, a marked voxel, what lies outside the grid."""
MIDDLE_ERROR = 1e-6
"""More than the distance of a ball's middle errs by rounding [voxel edges]."""


class Marks(NamedTuple):
    """Voxels that distances are asked to.

    Fields:
        lattice: the voxel grid.
        words: one bit a voxel: whether it is marked.
        cubes: bool, whether any of the voxels of each 16-voxel cube is.
        outside: whether what lies outside the grid is marked as well.
    """

    lattice: Lattice
    words: np.ndarray
    cubes: np.ndarray
    outside: bool


@njit(cache=True, nogil=True)
def nearest(world_from_link, body, first, last, marks, reach, place):
    """The least distance of some clusters' samples to a marked voxel's box, or to the outside of the grid.

    Clusters are looked at from that on whose ball comes nearest, so that most of the others are passed over: no sample
    of a ball is nearer than its middle less its radius.

    Args:
        world_from_link: of the link that the clusters are of, (4, 4).
        body: samples in clusters (`machine.kernels.body.Clusters`).
        first, last: of the clusters, the last one excluded.
        marks: what is asked for.
        reach: greater distances are not worked out [m].
        place: the nearest voxel's middle, or the nearest point of the grid's side, (3,) [m]; written if there is one.

    Returns:
        The distance, at most `reach` [m], and what is there.
    """
    lattice = marks.lattice
    best, kind = reach / lattice.edge, NOTHING
    away = np.empty(last - first)
    found = np.empty(5)
    _away_of_clusters(world_from_link, body, first, marks, best, away, found)
    for n in np.argsort(away):
        if away[n] >= best:
            break
        cluster = first + n
        centre, middle = body.centre[cluster], away[n] + body.radius[cluster] / lattice.edge
        for sample in range(body.start[cluster], body.stop[cluster]):
            point = body.points[sample]
            dx, dy, dz = point[0] - centre[0], point[1] - centre[1], point[2] - centre[2]
            if middle - math.sqrt(dx * dx + dy * dy + dz * dz) / lattice.edge >= best:
                continue
            x, y, z = carried(world_from_link, point)
            distance = _from_point(x, y, z, marks, best, found)
            if distance < best:
                best, kind = distance, int(found[3])
                for axis in range(3):
                    place[axis] = found[axis]
                if best <= 0.0:
                    return 0.0, kind
    return best * lattice.edge, kind


@uncounted()
def _away_of_clusters(world_from_link, body, first, marks, most, away, found):
    """Of clusters, no more than how far each one's ball is from what is marked: exact for those that may be nearest.

    Some sample of a ball is no farther than its middle and its radius. What is known to come no nearer than that of
    another ball is not worked out: by how far its middle is from that of the ball before, or by a limit to the search.

    Args:
        world_from_link, body, first, marks: as of `nearest`.
        most: greater distances are not worked out [voxel edges].
        away: (clusters,) written [voxel edges].
        found: (5,) room to work in.
    """
    edge = marks.lattice.edge
    lower, a, b, c = -math.inf, 0.0, 0.0, 0.0
    for n in range(away.size):
        x, y, z = carried(world_from_link, body.centre[first + n])
        r = body.radius[first + n] / edge
        # rounding must not make a middle farther than it is
        lower -= math.sqrt((x - a) * (x - a) + (y - b) * (y - b) + (z - c) * (z - c)) / edge + MIDDLE_ERROR
        a, b, c = x, y, z
        if not lower - r > most:
            lower = _from_point(x, y, z, marks, most + r + MIDDLE_ERROR, found)
            if found[3] != NOTHING:
                most = min(most, lower + r + MIDDLE_ERROR)
        away[n] = lower - r


@njit(cache=True, nogil=True)
def lies_in_marked(world_from_link, points, marks, place):
    """Whether any of some points of a link lies in a marked voxel; its middle goes to `place` (3,) [m]."""
    lattice = marks.lattice
    for n in range(points.shape[0]):
        x, y, z = carried(world_from_link, points[n])
        u, v, w = _counted(x, y, z, lattice)
        # what is not a number lies nowhere; what lies outside is the surface's matter
        if not (0.0 <= u < lattice.nx and 0.0 <= v < lattice.ny and 0.0 <= w < lattice.nz):
            continue
        i, j, k = int(u), int(v), int(w)
        if marks.words[word_of(i, j, k, lattice.cubes_y, lattice.cubes_z)] & bit_of(i, j, k):
            _put(i, j, k, lattice, place)
            return True
    return False


@njit(inline="always")
def _counted(x, y, z, lattice):
    """A point counted in voxels."""
    return (x - lattice.x0) / lattice.edge, (y - lattice.y0) / lattice.edge, (z - lattice.z0) / lattice.edge


@njit(inline="always")
def _put(i, j, k, lattice, place):
    """Writes the middle of a voxel [m]."""
    place[0] = lattice.x0 + (i + 0.5) * lattice.edge
    place[1] = lattice.y0 + (j + 0.5) * lattice.edge
    place[2] = lattice.z0 + (k + 0.5) * lattice.edge


@uncounted(cache=True)
def _from_point(x, y, z, marks, limit, found):
    """Distance of a point to what is marked, counted in voxels, at most `limit`; 0 where it is not a number.

    `found`, (5,), takes the place [m], what is there, and the distance, if it is below the limit.
    """
    lattice = marks.lattice
    found[3], found[4] = NOTHING, limit
    u, v, w = _counted(x, y, z, lattice)
    if not (math.isfinite(u) and math.isfinite(v) and math.isfinite(w)):
        found[0], found[1], found[2], found[3], found[4] = x, y, z, OUTSIDE, 0.0
        return 0.0
    if marks.outside:
        _to_outside(u, v, w, lattice, found)
    # in growing boxes: what is near is found without looking at what is far
    size = 1.0
    while True:
        _look_within(u, v, w, min(size, found[4]), marks, found)
        if size >= found[4]:
            return found[4]
        size *= 2.0


@uncounted(cache=True)
def _to_outside(u, v, w, lattice, found):
    """Looks at the grid's six sides; a point that lies outside is at no distance."""
    low = min(u, v, w)
    high = min(lattice.nx - u, lattice.ny - v, lattice.nz - w)
    distance = max(0.0, min(low, high))
    if distance >= found[4]:
        return
    found[3], found[4] = OUTSIDE, distance
    a, b, c = u, v, w
    if low <= high:
        if u == low:
            a = 0.0
        elif v == low:
            b = 0.0
        else:
            c = 0.0
    elif lattice.nx - u == high:
        a = lattice.nx * 1.0
    elif lattice.ny - v == high:
        b = lattice.ny * 1.0
    else:
        c = lattice.nz * 1.0
    found[0] = lattice.x0 + a * lattice.edge
    found[1] = lattice.y0 + b * lattice.edge
    found[2] = lattice.z0 + c * lattice.edge


@uncounted(cache=True)
def _look_within(u, v, w, s, marks, found):
    """Looks at the marked voxels of a box that reaches `s` to each side, and keeps the nearest."""
    lattice = marks.lattice
    i0, i1 = cell_of(u - s, lattice.nx), cell_of(u + s, lattice.nx)
    j0, j1 = cell_of(v - s, lattice.ny), cell_of(v + s, lattice.ny)
    k0, k1 = cell_of(w - s, lattice.nz), cell_of(w + s, lattice.nz)
    for a in range(i0 >> 2, (i1 >> 2) + 1):
        du = gap(u, a * 4.0, a * 4.0 + 4.0)
        for b in range(j0 >> 2, (j1 >> 2) + 1):
            dv = gap(v, b * 4.0, b * 4.0 + 4.0)
            if du * du + dv * dv >= found[4] * found[4]:
                continue
            for c in range(k0 >> 2, (k1 >> 2) + 1):
                cube = ((a >> 2) * lattice.cubes_y + (b >> 2)) * lattice.cubes_z + (c >> 2)
                if not marks.cubes[cube]:
                    continue
                word = marks.words[word_of(a * 4, b * 4, c * 4, lattice.cubes_y, lattice.cubes_z)]
                if word == 0:
                    continue
                dw = gap(w, c * 4.0, c * 4.0 + 4.0)
                if du * du + dv * dv + dw * dw < found[4] * found[4]:
                    _look_at_word(u, v, w, (a * 4, b * 4, c * 4), word, lattice, found)


@uncounted(cache=True)
def _look_at_word(u, v, w, corner, word, lattice, found):
    """Looks at the marked voxels of one word, whose least voxel is `corner`."""
    for i in range(corner[0], min(corner[0] + 4, lattice.nx)):
        du = gap(u, i * 1.0, i + 1.0)
        for j in range(corner[1], min(corner[1] + 4, lattice.ny)):
            dv = gap(v, j * 1.0, j + 1.0)
            for k in range(corner[2], min(corner[2] + 4, lattice.nz)):
                if not word & bit_of(i, j, k):
                    continue
                dw = gap(w, k * 1.0, k + 1.0)
                distance = math.sqrt(du * du + dv * dv + dw * dw)
                if distance < found[4]:
                    found[3], found[4] = VOXEL, distance
                    _put(i, j, k, lattice, found)
