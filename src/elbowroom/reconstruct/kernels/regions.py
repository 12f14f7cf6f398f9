"""Which pixels of each image may have a say in the voxels that are asked."""

import numpy as np
from numba import njit

from elbowroom.geometry.kernels.rigid import moved
from elbowroom.reconstruct.kernels.place import cube_at

NEAREST_M = 2e-3
"""What comes nearer to the camera's plane may be anywhere in the image [m]."""
ALIGNED = 8
"""Rectangles begin and end at multiples of so many pixels: whole tiles, and whole squares of them."""
FARTHEST_PX = 1e6
"""Places far beyond the image are taken to be here, before they become whole numbers."""


@njit(cache=True, nogil=True, error_model="numpy")
def rectangles_of(cubes, asked, lattice, cameras, spread_px, rectangles):
    """By camera the rectangle of pixels about all voxels that are asked, grown by what may have moved.

    Args:
        cubes: (n,) indices of cubes that hold any.
        asked: (words,) the voxels that are asked; of a word with any all are taken to be.
        lattice: the grid.
        cameras: records; of this moment only `aged_m` is read.
        spread_px: by so much it is wider to every side, beyond the pixels whose widened cones may meet a voxel.
        rectangles: (cameras, 4) int64, written: first row, one past the last, first column, one past the last; none:
            nothing that is asked can be seen.
    """
    outlines = np.empty((cameras.size, 4))
    outlines[:, 0::2], outlines[:, 1::2] = FARTHEST_PX, -FARTHEST_PX
    for number in cubes:
        cube = cube_at(lattice, number)
        low, high = _blocks_asked(asked, cube.word)
        edge = 4.0 * cube.edge
        half = (
            0.5 * edge * (high[0] + 1 - low[0]),
            0.5 * edge * (high[1] + 1 - low[1]),
            0.5 * edge * (high[2] + 1 - low[2]),
        )
        middle = (
            cube.x + edge * low[0] + half[0],
            cube.y + edge * low[1] + half[1],
            cube.z + edge * low[2] + half[2],
        )
        for c in range(cameras.size):
            _widen(outlines[c], cameras[c], middle, half)
    for c in range(cameras.size):
        camera, outline, rectangle = cameras[c], outlines[c], rectangles[c]
        wide = 0.5 + camera.lateral_px + spread_px
        rectangle[0], rectangle[1] = _aligned(outline[2] - wide, outline[3] + wide, camera.height)
        rectangle[2], rectangle[3] = _aligned(outline[0] - wide, outline[1] + wide, camera.width)
        if rectangle[0] >= rectangle[1] or rectangle[2] >= rectangle[3]:
            rectangle[:] = 0


@njit(nogil=True)
def _blocks_asked(asked, word):
    """The least and the greatest place of the blocks of a cube that are asked, by axis."""
    low, high = (3, 3, 3), (0, 0, 0)
    for lane in range(64):
        if asked[word + lane]:
            i, j, k = lane >> 4, (lane >> 2) & 3, lane & 3
            low = min(low[0], i), min(low[1], j), min(low[2], k)
            high = max(high[0], i), max(high[1], j), max(high[2], k)
    return low, high


@njit(nogil=True, error_model="numpy")
def _widen(outline, camera, middle, half):
    """Widens an outline (least and greatest column, least and greatest row) to hold a box as a camera sees it."""
    m, aged = camera.camera_from_world, camera.aged_m
    px, py, pz = moved(m, middle[0], middle[1], middle[2])
    reach_z = abs(m[2, 0]) * half[0] + abs(m[2, 1]) * half[1] + abs(m[2, 2]) * half[2] + aged
    if pz + reach_z <= 0.0:
        return
    near = pz - reach_z
    if near <= NEAREST_M:
        outline[0::2], outline[1::2] = -FARTHEST_PX, FARTHEST_PX
        return
    left, right, top, bottom = FARTHEST_PX, -FARTHEST_PX, FARTHEST_PX, -FARTHEST_PX
    for corner in range(8):
        i = half[0] if corner & 1 else -half[0]
        j = half[1] if corner & 2 else -half[1]
        k = half[2] if corner & 4 else -half[2]
        per_z = 1.0 / (pz + m[2, 0] * i + m[2, 1] * j + m[2, 2] * k)
        x = (px + m[0, 0] * i + m[0, 1] * j + m[0, 2] * k) * per_z
        y = (py + m[1, 0] * i + m[1, 1] * j + m[1, 2] * k) * per_z
        left, right, top, bottom = min(left, x), max(right, x), min(top, y), max(bottom, y)
    # as `aged.sees_through_grown` grows a voxel in it: at the nearest depth and at its farthest side it is widest
    across, down = max(abs(left), abs(right)), max(abs(top), abs(bottom))
    wide_x = aged / near * np.sqrt(1.0 + across * across)
    wide_y = aged / near * np.sqrt(1.0 + down * down)
    outline[0] = min(outline[0], camera.fx * (left - wide_x) + camera.cx)
    outline[1] = max(outline[1], camera.fx * (right + wide_x) + camera.cx)
    outline[2] = min(outline[2], camera.fy * (top - wide_y) + camera.cy)
    outline[3] = max(outline[3], camera.fy * (bottom + wide_y) + camera.cy)


@njit(nogil=True)
def _aligned(first, last, size):
    """The pixels of a row or column from one place to another: the first and one past the last, in whole steps."""
    begin = int(np.floor(min(max(first, 0.0), FARTHEST_PX))) // ALIGNED * ALIGNED
    end = int(np.ceil(min(max(last, -1.0), FARTHEST_PX))) + 1
    end = (end + ALIGNED - 1) // ALIGNED * ALIGNED
    return min(begin, size), min(end, size)
