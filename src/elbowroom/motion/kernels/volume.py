"""What is blocked, and whether a ball meets it."""

from typing import NamedTuple

import numpy as np
from numba import njit

from elbowroom.geometry.kernels.bits import Lattice, bit_of, uncounted, word_of
from elbowroom.motion.kernels.shared import Shared


class Volume(NamedTuple):
    """What is blocked.

    Fields:
        lattice: the voxel grid.
        words: one bit a voxel: whether it is.
        corners: one bit a voxel: whether any of the eight is that meet at its least corner.
        cubes: bool, whether any of the voxels of each 16-voxel cube is.
        surface, blind, disputed: one bit a voxel: what the blocked voxels are.
        shared: those that links reach into where they stand.
    """

    lattice: Lattice
    words: np.ndarray
    corners: np.ndarray
    cubes: np.ndarray
    surface: np.ndarray
    blind: np.ndarray
    disputed: np.ndarray
    shared: Shared


class Axis(NamedTuple):
    """How to come from a voxel to its lower neighbour along one axis.

    Fields:
        step: from a bit of a word to that of the next voxel.
        low: the bits of the word's first voxels.
        near, far: from a word to the next one, within a cube and into the next cube.
        digit: where two bits of a word's number tell the block within the cube.
        stride, cubes: from a cube's number to the next one's, and how many there are.
    """

    step: int
    low: int
    near: int
    far: int
    digit: int
    stride: int
    cubes: int


@njit(cache=True, nogil=True)
def block(free, lattice, words, cubes):
    """Fills a plane and the marks of its cubes: blocked is every voxel of the grid that is not free."""
    for cube in range(cubes.size):
        i = cube // (lattice.cubes_y * lattice.cubes_z) * 16
        j = cube // lattice.cubes_z % lattice.cubes_y * 16
        k = cube % lattice.cubes_z * 16
        whole = i + 16 <= lattice.nx and j + 16 <= lattice.ny and k + 16 <= lattice.nz
        some = np.uint64(0)
        for w in range(64):
            blocked = ~free[cube * 64 + w]
            if not whole:
                blocked &= _inside(i + w // 16 * 4, j + w // 4 % 4 * 4, k + w % 4 * 4, lattice)
            words[cube * 64 + w] = blocked
            some |= blocked
        cubes[cube] = some != 0


@njit(cache=True, nogil=True)
def gather_corners(words, lattice, scratch, corners):
    """Fills a plane: whether any of the eight voxels about each voxel's least corner is set; `scratch` is a third."""
    cubes_x, cubes_y, cubes_z = lattice.cubes_x, lattice.cubes_y, lattice.cubes_z
    along_z = Axis(1, 0x1111111111111111, 1, 61, 0, 1, cubes_z)
    along_y = Axis(4, 0x000F000F000F000F, 4, cubes_z * 64 - 12, 2, cubes_z, cubes_y)
    along_x = Axis(16, 0xFFFF, 16, cubes_y * cubes_z * 64 - 48, 4, cubes_y * cubes_z, cubes_x)
    _with_previous(words, along_z, corners)
    _with_previous(corners, along_y, scratch)
    _with_previous(scratch, along_x, corners)


@njit(inline="always")
def _with_previous(words, axis, out):
    """Each voxel's bit or that of its lower neighbour along one axis."""
    last = np.uint64(axis.low) << np.uint64(3 * axis.step)
    shift, over = np.uint64(axis.step), np.uint64(3 * axis.step)
    for word in range(words.size):
        either = words[word] | ((words[word] & ~last) << shift)
        if (word >> axis.digit) & 3:
            either |= (words[word - axis.near] & last) >> over
        elif (word >> 6) // axis.stride % axis.cubes:
            either |= (words[word - axis.far] & last) >> over
        out[word] = either


@njit
def _inside(i, j, k, lattice):
    """The bits of a word, whose least voxel is (i, j, k), that lie in the grid."""
    if i + 4 <= lattice.nx and j + 4 <= lattice.ny and k + 4 <= lattice.nz:
        return ~np.uint64(0)
    bits = np.uint64(0)
    for x in range(i, min(i + 4, lattice.nx)):
        for y in range(j, min(j + 4, lattice.ny)):
            for z in range(k, min(k + 4, lattice.nz)):
                bits |= bit_of(x, y, z)
    return bits


@njit(inline="always")
def gap(point, low, high):
    """Distance along one axis from a coordinate to an interval."""
    return max(low - point, 0.0, point - high)


@njit(inline="always")
def leaves(x, y, z, r, lattice):
    """Whether a ball reaches out of the grid; so does one whose place is not a number."""
    return not (
        x - r >= lattice.x0
        and y - r >= lattice.y0
        and z - r >= lattice.z0
        and x + r <= lattice.x0 + lattice.nx * lattice.edge
        and y + r <= lattice.y0 + lattice.ny * lattice.edge
        and z + r <= lattice.z0 + lattice.nz * lattice.edge
    )


@njit(inline="always")
def counted(x, y, z, r, lattice):
    """A ball's centre and radius counted in voxels."""
    inverse = 1.0 / lattice.edge
    return (x - lattice.x0) * inverse, (y - lattice.y0) * inverse, (z - lattice.z0) * inverse, r * inverse


@njit(inline="always")
def cell_of(coordinate, count):
    """The cell of a coordinate counted in lattice, held within the grid; it is known to be finite."""
    return int(min(max(coordinate, 0.0), count - 1.0))


@uncounted()
def meets_in_box(words, cubes, lattice, middle, half):
    """Whether a box along the axes, middle and half edges [m], holds a part of a blocked voxel, or leaves the grid."""
    x, y, z = middle
    rx, ry, rz = half
    inside = x - rx >= lattice.x0 and y - ry >= lattice.y0 and z - rz >= lattice.z0
    inside = inside and x + rx <= lattice.x0 + lattice.nx * lattice.edge
    inside = inside and y + ry <= lattice.y0 + lattice.ny * lattice.edge
    if not (inside and z + rz <= lattice.z0 + lattice.nz * lattice.edge):
        return True
    scale = 1.0 / lattice.edge
    u, v, w = (x - lattice.x0) * scale, (y - lattice.y0) * scale, (z - lattice.z0) * scale
    ru, rv, rw = rx * scale, ry * scale, rz * scale
    i0, i1 = cell_of(u - ru, lattice.nx), cell_of(u + ru, lattice.nx)
    j0, j1 = cell_of(v - rv, lattice.ny), cell_of(v + rv, lattice.ny)
    k0, k1 = cell_of(w - rw, lattice.nz), cell_of(w + rw, lattice.nz)
    for a in range(i0 >> 2, (i1 >> 2) + 1):
        # rows of voxels in the box: 16 bits a step in i, 4 in j, 1 in k
        along_i = _run(max(i0 - 4 * a, 0), min(i1 - 4 * a, 3), 16)
        for b in range(j0 >> 2, (j1 >> 2) + 1):
            along_j = _run(max(j0 - 4 * b, 0), min(j1 - 4 * b, 3), 4)
            along_ij = along_i & (along_j * np.uint64(0x0001000100010001))
            for c in range(k0 >> 2, (k1 >> 2) + 1):
                cube = ((a >> 2) * lattice.cubes_y + (b >> 2)) * lattice.cubes_z + (c >> 2)
                if not cubes[cube]:
                    continue
                word = words[cube * 64 + ((a & 3) * 4 + (b & 3)) * 4 + (c & 3)]
                along_k = _run(max(k0 - 4 * c, 0), min(k1 - 4 * c, 3), 1)
                if word & along_ij & (along_k * np.uint64(0x1111111111111111)):
                    return True
    return False


@njit(inline="always")
def _run(first, last, step):
    """The bits from `first` steps up to the end of `last`, each of some bits."""
    return (~np.uint64(0) << np.uint64(first * step)) & (~np.uint64(0) >> np.uint64(64 - (last + 1) * step))


@njit
def meets_block(words, cubes, lattice, x, y, z, r):
    """Whether a ball meets a word with a blocked voxel, or leaves the grid: a test for large balls."""
    if leaves(x, y, z, r, lattice):
        return True
    u, v, w, s = counted(x, y, z, r, lattice)
    i0, i1 = cell_of(u - s, lattice.nx) >> 2, cell_of(u + s, lattice.nx) >> 2
    j0, j1 = cell_of(v - s, lattice.ny) >> 2, cell_of(v + s, lattice.ny) >> 2
    k0, k1 = cell_of(w - s, lattice.nz) >> 2, cell_of(w + s, lattice.nz) >> 2
    for a in range(i0 >> 2, (i1 >> 2) + 1):
        for b in range(j0 >> 2, (j1 >> 2) + 1):
            for c in range(k0 >> 2, (k1 >> 2) + 1):
                cube = (a * lattice.cubes_y + b) * lattice.cubes_z + c
                if not cubes[cube]:
                    continue
                for i in range(max(i0, a * 4), min(i1, a * 4 + 3) + 1):
                    du = gap(u, i * 4.0, i * 4.0 + 4.0)
                    for j in range(max(j0, b * 4), min(j1, b * 4 + 3) + 1):
                        dv = gap(v, j * 4.0, j * 4.0 + 4.0)
                        for k in range(max(k0, c * 4), min(k1, c * 4 + 3) + 1):
                            if words[cube * 64 + ((i & 3) * 4 + (j & 3)) * 4 + (k & 3)] == 0:
                                continue
                            dw = gap(w, k * 4.0, k * 4.0 + 4.0)
                            if du * du + dv * dv + dw * dw <= s * s:
                                return True
    return False


@njit
def meets_voxel(words, lattice, x, y, z, r):
    """Whether a ball meets a blocked voxel, or leaves the grid: exact, a test for balls of about a voxel."""
    if leaves(x, y, z, r, lattice):
        return True
    u, v, w, s = counted(x, y, z, r, lattice)
    i0, i1 = cell_of(u - s, lattice.nx), cell_of(u + s, lattice.nx)
    j0, j1 = cell_of(v - s, lattice.ny), cell_of(v + s, lattice.ny)
    k0, k1 = cell_of(w - s, lattice.nz), cell_of(w + s, lattice.nz)
    for a in range(i0 >> 2, (i1 >> 2) + 1):
        for b in range(j0 >> 2, (j1 >> 2) + 1):
            for c in range(k0 >> 2, (k1 >> 2) + 1):
                word = words[word_of(a * 4, b * 4, c * 4, lattice.cubes_y, lattice.cubes_z)]
                if word == 0:
                    continue
                for i in range(max(i0, a * 4), min(i1, a * 4 + 3) + 1):
                    du = gap(u, i * 1.0, i + 1.0)
                    for j in range(max(j0, b * 4), min(j1, b * 4 + 3) + 1):
                        dv = gap(v, j * 1.0, j + 1.0)
                        for k in range(max(k0, c * 4), min(k1, c * 4 + 3) + 1):
                            if word & bit_of(i, j, k):
                                dw = gap(w, k * 1.0, k + 1.0)
                                if du * du + dv * dv + dw * dw <= s * s:
                                    return True
    return False
