"""Measured returns: how sure they are, which are a surface, which voxels near the body they may lie in."""

import math
from typing import NamedTuple

import numpy as np
from numba import njit

from elbowroom.geometry._kernels import Lattice, bit_of, word_of
from elbowroom.machine._kernels_draw import NEAR_M

MOST_M = 1e6
TILE = 16
UNSAFE = np.float32(-1e-6)
"""In place of a depth where the model is about a pixel, but what is about it is not all explained or farther [m]."""
SUPPORT = 4
"""Of eight neighbours, how many must be like a return beside the machine's edge for it to count as a surface."""


class Around(NamedTuple):
    """Where returns near the body are looked for: least and greatest depth per tile (`mark_tiles`), how far
    along its ray a return may lie off [sigmas], the camera's pose, the voxel grid, the plane to set bits in.
    """

    near: np.ndarray
    far: np.ndarray
    sigmas: float
    world_from_camera: np.ndarray
    cells: Lattice
    words: np.ndarray


@njit(nogil=True, error_model="numpy")
def is_return(view, d):
    """Whether a depth was measured at all."""
    return d > 0.0 and d >= view.min_depth and d <= view.max_depth and d <= MOST_M


@njit(nogil=True, error_model="numpy")
def sigma(view, d):
    """Standard deviation at a measured depth (geometry.noise)."""
    beyond = max(d - view.offset, 0.0)
    return view.constant + view.linear * d + view.quadratic * beyond * beyond


@njit(nogil=True, error_model="numpy")
def has_support(view, depth, model, u, v):
    """Whether at least `SUPPORT` of eight neighbours are like an unexplained return: a surface, not a flying pixel.

    Where no pixels fly one neighbour is enough.

    Like it is a neighbour that is unexplained too and about as deep, and one that has no return or lies outside the
    image: so a lost neighbour never takes support away. Anything three pixels wide has support in its middle.
    """
    d = depth[v, u]
    slack = 4.5 * sigma(view, d) + d / min(view.fx, view.fy)
    support = 0
    for nv in range(v - 1, v + 2):
        for nu in range(u - 1, u + 2):
            if nv == v and nu == u:
                continue
            if nv < 0 or nv >= view.height or nu < 0 or nu >= view.width:
                support += 1
                continue
            other = depth[nv, nu]
            lost = not (other > 0.0 and other >= view.min_depth and other <= view.max_depth)
            if lost or (model[nv, nu] <= 0.0 and abs(other - d) <= slack):
                support += 1
    return support >= (SUPPORT if view.flying else 1)


@njit(cache=True, nogil=True, error_model="numpy")
def mark_tiles(balls, link, radius, camera_from_link, view, near, far):
    """Per tile of 16 x 16 pixels, the least and greatest depth of the balls that may be seen in it.

    Args:
        balls: (n, 3) middles, in the frame of their `link`; `radius`: (n,) [m].
        camera_from_link: (links, 4, 4).
        view: the camera.
        near, far: (rows, columns) of tiles, infinity and 0 before [m, the camera's kind].
    """
    for n in range(link.size):
        pose, r = camera_from_link[link[n]], radius[n]
        a, b, c = balls[n, 0], balls[n, 1], balls[n, 2]
        x = pose[0, 0] * a + pose[0, 1] * b + pose[0, 2] * c + pose[0, 3]
        y = pose[1, 0] * a + pose[1, 1] * b + pose[1, 2] * c + pose[1, 3]
        z = pose[2, 0] * a + pose[2, 1] * b + pose[2, 2] * c + pose[2, 3]
        if z + r <= 0.0:
            continue
        away = math.sqrt(x * x + y * y + z * z) if view.radial else z
        u0, u1, v0, v1 = 0.0, view.width - 1.0, 0.0, view.height - 1.0
        if z - r > NEAR_M:
            u0 = max(u0, view.cx + view.fx * min((x - r) / (z - r), (x - r) / (z + r)))
            u1 = min(u1, view.cx + view.fx * max((x + r) / (z - r), (x + r) / (z + r)))
            v0 = max(v0, view.cy + view.fy * min((y - r) / (z - r), (y - r) / (z + r)))
            v1 = min(v1, view.cy + view.fy * max((y + r) / (z - r), (y + r) / (z + r)))
        if u0 > u1 or v0 > v1:
            continue
        for row in range(int(v0) // TILE, int(v1) // TILE + 1):
            for column in range(int(u0) // TILE, int(u1) // TILE + 1):
                near[row, column] = min(near[row, column], away - r)
                far[row, column] = max(far[row, column], away + r)


@njit(nogil=True, error_model="numpy")
def mark_row_of_tiles(view, depth, model, row, around, limits, found):
    """Sets the voxels that the unexplained returns of one row of tiles may lie in.

    That is those that the cube about the measured point meets whose half side is half a pixel at its range,
    moved along the ray by up to `around.sigmas` * sigma. A return that stands alone is passed over: it may
    fly, or have slipped between two links.
    """
    if row >= around.near.shape[0]:
        return
    width, least, most = view.width, limits[0], limits[1]
    # taken out of the tuple once: each look into it counts references, which costs more than the arithmetic below
    sigmas, pose, cells, words = around.sigmas, around.world_from_camera, around.cells, around.words
    for column in range(around.near.shape[1]):
        start, stop = column * TILE, min(column * TILE + TILE, width)
        set_run(least, start, stop, np.float32(max(around.near[row, column], view.min_depth)))
        set_run(most, start, stop, np.float32(min(around.far[row, column], view.max_depth)))
    eight = found.view(np.uint64)
    for v in range(row * TILE, min(row * TILE + TILE, view.height)):
        _find(depth[v], model[v], least, most, width, found)
        for n in range(eight.size):
            if eight[n] != 0:
                for u in range(8 * n, 8 * n + 8):
                    # the voxels first: neighbours mostly lie in the same ones
                    if (
                        found[u] != 0
                        and _mark_return(view, u, v, depth[v, u], sigmas, pose, cells, words, False)
                        and has_support(view, depth, model, u, v)
                    ):
                        _mark_return(view, u, v, depth[v, u], sigmas, pose, cells, words, True)


@njit(nogil=True, error_model="numpy")
def _find(depth, model, least, most, width, found):
    """Notes the pixels of a row that are not explained and whose depth lies within their limits."""
    for n in range(width):
        u = np.uint64(n)
        d = depth[u]
        found[u] = (
            (d > np.float32(0.0))
            & (d >= least[u])
            & (d <= most[u])
            & (model[u] <= np.float32(0.0))
            & (model[u] >= UNSAFE)
        )


@njit(nogil=True, error_model="numpy")
def _mark_return(view, u, v, d, sigmas, pose, cells, words, sets):
    """Sets the voxels that one return may lie in, or only says whether any of them is not set yet."""
    x, y = (u - view.cx) / view.fx, (v - view.cy) / view.fy
    z = d / math.sqrt(1.0 + x * x + y * y) if view.radial else float(d)
    half = 0.5 * z / min(view.fx, view.fy) / cells.edge
    scale = 1.0 / cells.edge
    # the ray in voxels from the grid's corner
    ox, oy, oz = (
        (pose[0, 3] - cells.x0) * scale,
        (pose[1, 3] - cells.y0) * scale,
        (pose[2, 3] - cells.z0) * scale,
    )
    rx = (pose[0, 0] * x + pose[0, 1] * y + pose[0, 2]) * scale
    ry = (pose[1, 0] * x + pose[1, 1] * y + pose[1, 2]) * scale
    rz = (pose[2, 0] * x + pose[2, 1] * y + pose[2, 2]) * scale
    spread = sigmas * sigma(view, d) * z / d
    # steps of at most half a voxel
    steps = min(math.ceil(4.0 * spread / cells.edge), 1000)
    for n in range(steps + 1):
        away = z if steps == 0 else z + spread * (2.0 * n / steps - 1.0)
        px, py, pz = ox + rx * away, oy + ry * away, oz + rz * away
        if not (
            -half <= px < cells.nx + half and -half <= py < cells.ny + half and -half <= pz < cells.nz + half
        ):
            continue
        for i in range(max(0, math.floor(px - half)), min(cells.nx - 1, math.floor(px + half)) + 1):
            for j in range(max(0, math.floor(py - half)), min(cells.ny - 1, math.floor(py + half)) + 1):
                for k in range(max(0, math.floor(pz - half)), min(cells.nz - 1, math.floor(pz + half)) + 1):
                    word, bit = word_of(i, j, k, cells.cubes_y, cells.cubes_z), bit_of(i, j, k)
                    if sets:
                        words[word] |= bit
                    elif not words[word] & bit:
                        return True
    return False


@njit(nogil=True, error_model="numpy")
def set_run(array, start, stop, value):
    """Sets a run of an array. Unsigned indices, as below, or the compiler does one pixel at a time."""
    for n in range(start, stop):
        array[np.uint64(n)] = value
