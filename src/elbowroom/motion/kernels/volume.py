"""What is blocked, and whether a ball meets it."""

from typing import NamedTuple

import numpy as np
from numba import njit

from elbowroom.geometry.kernels.bits import bit_of, word_of


class Volume(NamedTuple):
    """What is blocked, one bit a voxel; whether any of the eight voxels is that meet at a voxel's least corner; whether
    any of each 16-voxel cube is; what the blocked voxels are."""

    words: np.ndarray
    corners: np.ndarray
    cubes: np.ndarray
    surface: np.ndarray
    blind: np.ndarray
    disputed: np.ndarray


class Axis(NamedTuple):
    """How the next voxel along an axis is found in a plane of bits.

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
def block(free, cells, words, cubes):
    """Fills a plane and the marks of its cubes: blocked is every voxel of the grid that is not free."""
    for cube in range(cubes.size):
        i = cube // (cells.cubes_y * cells.cubes_z) * 16
        j = cube // cells.cubes_z % cells.cubes_y * 16
        k = cube % cells.cubes_z * 16
        whole = i + 16 <= cells.nx and j + 16 <= cells.ny and k + 16 <= cells.nz
        some = np.uint64(0)
        for w in range(64):
            blocked = ~free[cube * 64 + w]
            if not whole:
                blocked &= _inside(i + w // 16 * 4, j + w // 4 % 4 * 4, k + w % 4 * 4, cells)
            words[cube * 64 + w] = blocked
            some |= blocked
        cubes[cube] = some != 0


@njit(cache=True, nogil=True)
def gather_corners(words, cells, scratch, corners):
    """Fills a plane: whether any of the eight voxels about each voxel's least corner is set; `scratch` is a third."""
    across_y, across_x = cells.cubes_z * 64, cells.cubes_y * cells.cubes_z * 64
    along_z = Axis(1, 0x1111111111111111, 1, 61, 0, 1, cells.cubes_z)
    along_y = Axis(4, 0x000F000F000F000F, 4, across_y - 12, 2, cells.cubes_z, cells.cubes_y)
    along_x = Axis(16, 0xFFFF, 16, across_x - 48, 4, cells.cubes_y * cells.cubes_z, cells.cubes_x)
    _with_previous(words, along_z, corners)
    _with_previous(corners, along_y, scratch)
    _with_previous(scratch, along_x, corners)


@njit
def _with_previous(words, axis, out):
    """Each voxel's bit or that of its lower neighbour along one axis."""
    step, low, near, far, digit, stride, count = axis
    last = np.uint64(low) << np.uint64(3 * step)
    shift, over = np.uint64(step), np.uint64(3 * step)
    for word in range(words.size):
        either = words[word] | ((words[word] & ~last) << shift)
        if (word >> digit) & 3:
            either |= (words[word - near] & last) >> over
        elif (word >> 6) // stride % count:
            either |= (words[word - far] & last) >> over
        out[word] = either


@njit
def _inside(i, j, k, cells):
    """The bits of a word, whose least voxel is (i, j, k), that lie in the grid."""
    if i + 4 <= cells.nx and j + 4 <= cells.ny and k + 4 <= cells.nz:
        return ~np.uint64(0)
    bits = np.uint64(0)
    for x in range(i, min(i + 4, cells.nx)):
        for y in range(j, min(j + 4, cells.ny)):
            for z in range(k, min(k + 4, cells.nz)):
                bits |= bit_of(x, y, z)
    return bits


@njit(inline="always")
def gap(point, low, high):
    """Distance along one axis from a coordinate to an interval."""
    return max(low - point, 0.0, point - high)


@njit(inline="always")
def leaves(x, y, z, r, cells):
    """Whether a ball reaches out of the grid; so does one whose place is not a number."""
    return not (
        x - r >= cells.x0
        and y - r >= cells.y0
        and z - r >= cells.z0
        and x + r <= cells.x0 + cells.nx * cells.edge
        and y + r <= cells.y0 + cells.ny * cells.edge
        and z + r <= cells.z0 + cells.nz * cells.edge
    )


@njit(inline="always")
def counted(x, y, z, r, cells):
    """A ball's centre and radius counted in voxels."""
    inverse = 1.0 / cells.edge
    return (x - cells.x0) * inverse, (y - cells.y0) * inverse, (z - cells.z0) * inverse, r * inverse


@njit(inline="always")
def cell_of(coordinate, count):
    """The cell of a coordinate counted in cells, held within the grid; it is known to be finite."""
    return int(min(max(coordinate, 0.0), count - 1.0))


@njit
def meets_block(words, cubes, cells, x, y, z, r):
    """Whether a ball meets a word with a blocked voxel, or leaves the grid: a test for large balls."""
    if leaves(x, y, z, r, cells):
        return True
    u, v, w, s = counted(x, y, z, r, cells)
    i0, i1 = cell_of(u - s, cells.nx) >> 2, cell_of(u + s, cells.nx) >> 2
    j0, j1 = cell_of(v - s, cells.ny) >> 2, cell_of(v + s, cells.ny) >> 2
    k0, k1 = cell_of(w - s, cells.nz) >> 2, cell_of(w + s, cells.nz) >> 2
    for a in range(i0 >> 2, (i1 >> 2) + 1):
        for b in range(j0 >> 2, (j1 >> 2) + 1):
            for c in range(k0 >> 2, (k1 >> 2) + 1):
                cube = (a * cells.cubes_y + b) * cells.cubes_z + c
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
def meets_voxel(words, cells, x, y, z, r):
    """Whether a ball meets a blocked voxel, or leaves the grid: exact, a test for balls of about a voxel."""
    if leaves(x, y, z, r, cells):
        return True
    u, v, w, s = counted(x, y, z, r, cells)
    i0, i1 = cell_of(u - s, cells.nx), cell_of(u + s, cells.nx)
    j0, j1 = cell_of(v - s, cells.ny), cell_of(v + s, cells.ny)
    k0, k1 = cell_of(w - s, cells.nz), cell_of(w + s, cells.nz)
    for a in range(i0 >> 2, (i1 >> 2) + 1):
        for b in range(j0 >> 2, (j1 >> 2) + 1):
            for c in range(k0 >> 2, (k1 >> 2) + 1):
                word = words[word_of(a * 4, b * 4, c * 4, cells.cubes_y, cells.cubes_z)]
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
