"""How samples are carried about in a box of joint positions: joint by joint along lines, give or take a little.

The ball of a change of all joints grows with the whole way that a point can go, whatever its direction. A machine that
slides along something is never clear of it by that ball until the box is tiny. Along a direction n a point goes no
farther than

    sum over joints j of |n . w_j| + rest           w_j = h_j a_j x (p - o_j), or h_j a_j for a joint that slides

with the most that joint j changes h_j, its axis a_j through o_j; what is left out is of second order (`sway`). So
triangles are asked by separating axes, each with its own reach.
"""

import math
from typing import NamedTuple

import numpy as np

from elbowroom.geometry.kernels.bits import bit_of, uncounted, word_of
from elbowroom.geometry.kernels.rigid import turned
from elbowroom.machine.kernels.body import FIXED, SLIDES
from elbowroom.motion.kernels.mover import ROUNDING_M, carried
from elbowroom.motion.kernels.shared import CELLS, WORDS, row_of
from elbowroom.motion.kernels.volume import cell_of


class Sway(NamedTuple):
    """How one sample's ball is carried about.

    Fields:
        ways: what each joint does to its middle at most, in its first rows, world frame, (rows of a tree, 3) [m].
        many: how many rows there are.
        rest: by so much any point of the ball may be elsewhere besides [m].
    """

    ways: np.ndarray
    many: int
    rest: float


@uncounted()
def sway(tree, placed, half, row, ball, ways):
    """How a ball is carried about in a box of joint positions, and how many rows of `ways` are written; the rest.

    Joints are turned one after another, those farthest from the base first, as in `beside.moves`. A point e from the
    ball's middle, with what it was moved by before, is carried by a turn of h through h |e| at most beside what the
    middle is; and the middle, r from the axis, leaves the line a x r by r h^2 / 2 at most.

    Args:
        tree: of the machine.
        placed: where links are in the box's middle, (links, 4, 4).
        half: of the box, (joints,).
        row: of the ball's link.
        ball: its middle, world frame, and its radius [m].
        ways: written (`Sway`).
    """
    x, y, z, size = ball
    count, rest, moved = 0, 0.0, 0.0
    while row >= 0:
        column = tree.column[row]
        if tree.kind[row] != FIXED and half[column] > 0.0:
            turn = half[column] * abs(tree.multiplier[row])
            m = placed[row]
            a, b, c = turned(m, tree.axis[row, 0], tree.axis[row, 1], tree.axis[row, 2])
            if tree.kind[row] == SLIDES:
                moved += turn
            else:
                dx, dy, dz = x - m[0, 3], y - m[1, 3], z - m[2, 3]
                a, b, c = b * dz - c * dy, c * dx - a * dz, a * dy - b * dx
                away = math.sqrt(a * a + b * b + c * c)
                rest += turn * (size + moved) + turn * turn / 2 * away
                moved += turn * (away + size + moved)
            ways[count, 0], ways[count, 1], ways[count, 2] = turn * a, turn * b, turn * c
            count += 1
        row = tree.parent[row]
    return count, rest


@uncounted()
def first_unclear(placed, mover, half, volume, samples, room):
    """The first of some samples whose patch may meet a block somewhere in a box of joint positions; -1: none may.

    What is known cell by cell is asked by its cells. A patch that may leave the grid is not clear.

    Args:
        placed: where links are in the box's middle, (links, 4, 4).
        mover: what moves.
        half: of the box, (joints,).
        volume: what is blocked.
        samples: which.
        room: (rows of a tree, 3) and (3, 3), to work in.
    """
    skin = mover.skin
    ways, triangle = room
    for sample in samples:
        link = skin.link[skin.cluster_of[sample]]
        x, y, z = carried(placed[link], skin.points[sample])
        count, rest = sway(mover.tree, placed, half, link, (x, y, z, skin.cover + skin.off), ways)
        swayed = Sway(ways, count, rest + (ROUNDING_M + skin.off))
        if _may_meet((placed[link], link, sample), (x, y, z), skin, swayed, volume, triangle):
            return sample
    return -1


@uncounted()
def _may_meet(patch, middle, skin, swayed, volume, triangle):
    """Whether a patch may meet a block, or leave the grid; `patch`: where its link is, the link, the sample."""
    lattice = volume.lattice
    x, y, z = middle
    rx, ry, rz = (
        skin.cover + _reach(swayed, 1.0, 0.0, 0.0),
        skin.cover + _reach(swayed, 0.0, 1.0, 0.0),
        skin.cover + _reach(swayed, 0.0, 0.0, 1.0),
    )
    scale = 1.0 / lattice.edge
    u, v, w = (x - lattice.x0) * scale, (y - lattice.y0) * scale, (z - lattice.z0) * scale
    rx, ry, rz = rx * scale, ry * scale, rz * scale
    inside = u - rx >= 0.0 and v - ry >= 0.0 and w - rz >= 0.0
    inside = inside and u + rx <= lattice.nx and v + ry <= lattice.ny and w + rz <= lattice.nz
    if not inside and volume.shared.others:
        return True
    if not (u == u and v == v and w == w):
        return True
    for i in range(cell_of(u - rx, lattice.nx), cell_of(u + rx, lattice.nx) + 1):
        for j in range(cell_of(v - ry, lattice.ny), cell_of(v + ry, lattice.ny) + 1):
            for k in range(cell_of(w - rz, lattice.nz), cell_of(w + rz, lattice.nz) + 1):
                word = word_of(i, j, k, lattice.cubes_y, lattice.cubes_z)
                if volume.words[word] & bit_of(i, j, k) and _may_meet_voxel(
                    patch, (i, j, k), skin, swayed, volume, triangle
                ):
                    return True
    return False


@uncounted()
def _may_meet_voxel(patch, index, skin, swayed, volume, triangle):
    """Whether a patch may meet what is blocked of a blocked voxel."""
    lattice, shared = volume.lattice, volume.shared
    world_from_link, link, sample = patch
    i, j, k = index
    row = row_of(shared, (i * lattice.ny + j) * lattice.nz + k)
    if (row < 0 and not shared.others) or (row >= 0 and shared.links[row, link] == shared.others):
        return False
    edge = lattice.edge
    x, y, z = lattice.x0 + i * edge, lattice.y0 + j * edge, lattice.z0 + k * edge
    for n in range(skin.patch_start[sample], skin.patch_start[sample + 1]):
        for corner in range(3):
            a, b, c = carried(world_from_link, skin.triangles[skin.patches[n], corner])
            triangle[corner, 0], triangle[corner, 1], triangle[corner, 2] = a, b, c
        if not sways_into(triangle, x + edge / 2, y + edge / 2, z + edge / 2, edge / 2, swayed):
            continue
        if row < 0 or _sways_into_cells(triangle, shared.cells[row], (x, y, z), edge, swayed):
            return True
    return False


@uncounted()
def _sways_into_cells(triangle, cells, least, edge, swayed):
    """Whether a triangle may meet any of a voxel's blocked cells; as of `shared.triangle_meets_cells`.

    Written out again: numba keeps no kernel on disk that hands another one on, measured with both tests as arguments.
    """
    block, cell = edge / 4, edge / CELLS
    x, y, z = least
    for word in range(WORDS):
        left = cells[word]
        if left == 0:
            continue
        a, b, c = word >> 4, (word >> 2) & 3, word & 3
        u, v, w = x + (a + 0.5) * block, y + (b + 0.5) * block, z + (c + 0.5) * block
        if not sways_into(triangle, u, v, w, block / 2, swayed):
            continue
        if ~left == 0:
            return True
        for bit in range(64):
            if not left & (np.uint64(1) << np.uint64(bit)):
                continue
            i, j, k = 4 * a + (bit >> 4), 4 * b + ((bit >> 2) & 3), 4 * c + (bit & 3)
            u, v, w = x + (i + 0.5) * cell, y + (j + 0.5) * cell, z + (k + 0.5) * cell
            if sways_into(triangle, u, v, w, cell / 2, swayed):
                return True
    return False


@uncounted()
def _reach(swayed, a, b, c):
    """How far a ball's points go along a direction, times its length, at most."""
    reach = swayed.rest * (abs(a) + abs(b) + abs(c))
    for n in range(swayed.many):
        reach += abs(a * swayed.ways[n, 0] + b * swayed.ways[n, 1] + c * swayed.ways[n, 2])
    return reach


@uncounted()
def sways_into(triangle, x, y, z, half, swayed):
    """Whether a triangle that is carried about may meet a cube: the axes of `triangle_meets_box` do not part them.

    Args:
        triangle: (3, 3), world frame [m].
        x, y, z: the cube's middle [m].
        half: half its edge [m].
        swayed: how the part of the triangle is carried that matters (`Sway`).
    """
    a = triangle[0, 0] - x, triangle[0, 1] - y, triangle[0, 2] - z
    b = triangle[1, 0] - x, triangle[1, 1] - y, triangle[1, 2] - z
    c = triangle[2, 0] - x, triangle[2, 1] - y, triangle[2, 2] - z
    u = b[0] - a[0], b[1] - a[1], b[2] - a[2]
    v = c[0] - b[0], c[1] - b[1], c[2] - b[2]
    w = a[0] - c[0], a[1] - c[1], a[2] - c[2]
    n = u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]
    if _parts(a, b, c, n[0], n[1], n[2], half, swayed):
        return False
    if (
        _parts(a, b, c, 1.0, 0.0, 0.0, half, swayed)
        or _parts(a, b, c, 0.0, 1.0, 0.0, half, swayed)
        or _parts(a, b, c, 0.0, 0.0, 1.0, half, swayed)
    ):
        return False
    for edge in (u, v, w):
        if (
            _parts(a, b, c, 0.0, edge[2], -edge[1], half, swayed)
            or _parts(a, b, c, -edge[2], 0.0, edge[0], half, swayed)
            or _parts(a, b, c, edge[1], -edge[0], 0.0, half, swayed)
        ):
            return False
    return True


@uncounted()
def _parts(a, b, c, p, q, r, half, swayed):
    """Whether a direction (p, q, r) parts a triangle from a cube about the origin, wherever it is carried."""
    one = a[0] * p + a[1] * q + a[2] * r
    two = b[0] * p + b[1] * q + b[2] * r
    three = c[0] * p + c[1] * q + c[2] * r
    reach = half * (abs(p) + abs(q) + abs(r)) + _reach(swayed, p, q, r)
    return min(one, two, three) > reach or max(one, two, three) < -reach
