"""Measured returns: how sure they are, which are a surface, which voxels near the body they may lie in."""

import math
from typing import NamedTuple

import numpy as np
from numba import njit

from elbowroom.geometry.kernels.bits import Lattice, bit_of, uncounted, word_of
from elbowroom.machine.kernels.draw import NEAR_M

MOST_M = 1e6
TILE = 16
UNSAFE = np.float32(-1e-6)
"""In place of a depth where the model is about a pixel, but what is about it is not all explained or farther [m]."""
FLOAT_ERROR = np.float32(2e-6)
"""Of a coordinate that float32 arithmetic worked out, more than it errs, as a share of its terms."""
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


class Scratch(NamedTuple):
    """Rows of memory for one image: least and greatest depth per pixel; pixels found; spans and boxes of
    `_bound_returns`."""

    limits: np.ndarray
    found: np.ndarray
    spans: np.ndarray
    boxes: np.ndarray


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
def mark_row_of_tiles(view, depth, model, row, around, scratch):
    """Sets the voxels that the unexplained returns of one row of tiles may lie in.

    That is those that the cube about the measured point meets whose half side is half a pixel at its range,
    moved along the ray by up to `around.sigmas` * sigma. A return that stands alone is passed over: it may
    fly, or have slipped between two links.
    """
    # taken out of the tuples once: each look into them counts references, which costs more than the arithmetic below
    limits, found, spans, boxes = scratch
    width, least, most = view.width, limits[0], limits[1]
    ray, cells, words = (around.sigmas, around.world_from_camera), around.cells, around.words
    left, right = width, 0
    for column in range(around.near.shape[1]):
        start, stop = column * TILE, min(column * TILE + TILE, width)
        set_run(least, start, stop, np.float32(max(around.near[row, column], view.min_depth)))
        set_run(most, start, stop, np.float32(min(around.far[row, column], view.max_depth)))
        if around.far[row, column] > 0.0:
            left, right = min(left, start), stop
    if left >= right:
        return
    eight = found.view(np.uint64)
    for v in range(row * TILE, min(row * TILE + TILE, view.height)):
        _find(depth[v], model[v], least, most, left, right, found)
        # tiles start at whole words of eight pixels; the last pixel whose box was seen to be set: neighbours mostly
        # have the same box
        done, known = left, np.int64(-1)
        for n in range(left // 8, (right + 7) // 8):
            if eight[n] == 0:
                continue
            if 8 * n >= done:
                done = 8 * n
                while done < right and eight[done // 8] != 0:
                    done = min(done + 8, right)
                _bound_returns(view, v, depth[v], (8 * n, done), ray, cells, spans, boxes)
            for u in range(8 * n, min(8 * n + 8, right)):
                if found[u] == 0 or (known >= 0 and _same_box(boxes, u, known)):
                    continue
                # the voxels first: most are set already
                if _all_set(boxes, u, cells.cubes_y, cells.cubes_z, words):
                    known = u
                elif has_support(view, depth, model, u, v):
                    _mark_return(view, u, v, depth[v, u], ray, cells, words)


@njit(nogil=True, error_model="numpy")
def _find(depth, model, least, most, left, right, found):
    """Notes the pixels of a row that are not explained and whose depth lies within their limits."""
    for n in range(left, right):
        u = np.uint64(n)
        d = depth[u]
        found[u] = (
            (d > np.float32(0.0))
            & (d >= least[u])
            & (d <= most[u])
            & (model[u] <= np.float32(0.0))
            & (model[u] >= UNSAFE)
        )


@uncounted(error_model="numpy")
def _bound_returns(view, v, depth, run, ray, cells, spans, boxes):
    """First and last voxel along each axis of a box about all that each return of a run may lie in.

    In float32 and without branches, for many pixels at once; the box is wider by more than that errs.

    Args:
        v, run: row of the run; its first column, one past its last.
        ray: how many sigmas a return may lie off along its ray, and world_from_camera.
        depth: (width,) of the row [m].
        spans: (3, width) float32, written: planar depth from and to, half a pixel there in voxels.
        boxes: (6, width) int32, written: first and last i, j and k; none if the last comes before the first.
    """
    start, stop = run
    sigmas, world_from_camera = ray
    y, scale, one = np.float32((v - view.cy) / view.fy), 1.0 / cells.edge, np.float32(1.0)
    cx, pitch, square = np.float32(view.cx), np.float32(1.0 / view.fx), one + y * y
    half_pixel = np.float32(0.5 / min(view.fx, view.fy) * scale)
    fixed, factor = np.float32(sigmas * view.constant), np.float32(sigmas * view.linear)
    beyond_factor, offset = np.float32(sigmas * view.quadratic), np.float32(view.offset)
    radial, zero = view.radial, np.float32(0.0)
    for n in range(start, stop):
        u = np.uint64(n)
        x = (np.float32(n) - cx) * pitch
        d = depth[u]
        planar = one / np.sqrt(square + x * x) if radial else one
        beyond = max(d - offset, zero)
        spread = fixed + factor * d + beyond_factor * beyond * beyond
        spans[0, u], spans[1, u] = (d - spread) * planar, (d + spread) * planar
        spans[2, u] = half_pixel * d * planar
    for axis in range(3):
        corner = cells.x0 if axis == 0 else cells.y0 if axis == 1 else cells.z0
        end = np.float32(cells.nx if axis == 0 else cells.ny if axis == 1 else cells.nz)
        origin = np.float32((world_from_camera[axis, 3] - corner) * scale)
        turn = np.float32(world_from_camera[axis, 0] * scale) * pitch
        base = np.float32((world_from_camera[axis, 1] * y + world_from_camera[axis, 2]) * scale)
        aside = abs(origin)
        for n in range(start, stop):
            u = np.uint64(n)
            along = turn * (np.float32(n) - cx) + base
            near, far = along * spans[0, u], along * spans[1, u]
            slack = spans[2, u] + FLOAT_ERROR * (aside + abs(near) + abs(far))
            low, high = np.floor(origin + min(near, far) - slack), np.floor(origin + max(near, far) + slack)
            # held near the grid before they become whole numbers
            boxes[2 * axis, u] = np.int32(min(max(low, zero), end))
            boxes[2 * axis + 1, u] = np.int32(max(min(high, end - one), -one))


@uncounted(error_model="numpy")
def _same_box(boxes, u, other):
    """Whether two pixels of a row have the same box."""
    same = True
    for n in range(6):
        same &= boxes[n, u] == boxes[n, other]
    return same


@uncounted(error_model="numpy")
def _all_set(boxes, u, cubes_y, cubes_z, words):
    """Whether all voxels of a box are set already."""
    for i in range(boxes[0, u], boxes[1, u] + 1):
        for j in range(boxes[2, u], boxes[3, u] + 1):
            for k in range(boxes[4, u], boxes[5, u] + 1):
                if not words[word_of(i, j, k, cubes_y, cubes_z)] & bit_of(i, j, k):
                    return False
    return True


@njit(nogil=True, error_model="numpy")
def _mark_return(view, u, v, d, ray, cells, words):
    """Sets the voxels that one return may lie in."""
    sigmas, pose = ray
    x, y = (u - view.cx) / view.fx, (v - view.cy) / view.fy
    z = d / math.sqrt(1.0 + x * x + y * y) if view.radial else float(d)
    half = 0.5 / min(view.fx, view.fy) / cells.edge * z
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
                    words[word_of(i, j, k, cells.cubes_y, cells.cubes_z)] |= bit_of(i, j, k)


@njit(nogil=True, error_model="numpy")
def set_run(array, start, stop, value):
    """Sets a run of an array. Unsigned indices, as below, or the compiler does one pixel at a time."""
    for n in range(start, stop):
        array[np.uint64(n)] = value
