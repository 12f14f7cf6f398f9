"""Measured returns: how sure they are, which are a surface, which voxels near the body they may lie in."""

import math
from typing import NamedTuple

import numpy as np
from numba import njit

from elbowroom.geometry.kernels.bits import Lattice, uncounted, word_of
from elbowroom.geometry.kernels.noise import sigma
from elbowroom.geometry.kernels.rigid import moved, turned
from elbowroom.machine.kernels.draw import NEAR_M

MOST_M = 1e6
"""What claims to be farther is no return [m]."""
TILE = 16
"""Pixels along the edge of a tile."""
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
    lattice: Lattice
    words: np.ndarray


class Scratch(NamedTuple):
    """What is noted of the pixels of one row of tiles, or of one row of them, by column of the image.

    Fields:
        limits: least and greatest depth that is looked for, shape (2, width), float32 [m].
        found: whether a return is to be looked at, uint8, in whole words of eight pixels.
        spans: planar depth from and to [m], half a pixel there [voxels], shape (3, width), float32.
        boxes: first and last i, j and k of the voxels that a return may lie in, shape (6, width), int32; none if the
            last comes before the first.
        same: whether a pixel has the same box as the one before, uint8, shape (width,).
    """

    limits: np.ndarray
    found: np.ndarray
    spans: np.ndarray
    boxes: np.ndarray
    same: np.ndarray


class Spread(NamedTuple):
    """A number of sigmas, and something beside them, by depth: float32, for `sigma` of float32 depths."""

    constant: float
    linear: float
    quadratic: float
    offset: float


@njit(inline="always")
def spread_of(view, sigmas, beside):
    """So many sigmas of a view's noise and so much beside them [m]."""
    return Spread(
        np.float32(beside + sigmas * view.constant),
        np.float32(sigmas * view.linear),
        np.float32(sigmas * view.quadratic),
        np.float32(view.offset),
    )


@uncounted(error_model="numpy")
def least_from(bound):
    """The least float32 number that is not below a bound."""
    least = np.float32(bound)
    return least if least >= bound else np.nextafter(least, np.float32(np.inf))


@uncounted(error_model="numpy")
def most_to(bound):
    """The greatest float32 number that is not above a bound."""
    most = np.float32(bound)
    return most if most <= bound else np.nextafter(most, np.float32(-np.inf))


@uncounted(error_model="numpy")
def is_return(view, d):
    """Whether a depth was measured at all."""
    return d > 0.0 and d >= view.min_depth and d <= view.max_depth and d <= MOST_M


@uncounted(error_model="numpy")
def has_support(view, depth, model, u, v):
    """Whether at least `SUPPORT` of eight neighbours are like an unexplained return: a surface, not a flying pixel.

    Where no pixels fly one neighbour is enough.

    Like it is a neighbour that is unexplained too and about as deep, and one that has no return or lies outside the
    image: so a lost neighbour never takes support away. Anything three pixels wide has support in its middle.
    """
    d = depth[v, u]
    slack = 4.5 * sigma(view, d) + d / min(view.fx, view.fy)
    support, enough = 0, SUPPORT if view.flying else 1
    for nv in range(v - 1, v + 2):
        for nu in range(u - 1, u + 2):
            if nv == v and nu == u:
                continue
            if nv < 0 or nv >= view.height or nu < 0 or nu >= view.width:
                support += 1
            else:
                other = depth[nv, nu]
                lost = not (other > 0.0 and other >= view.min_depth and other <= view.max_depth)
                if lost or (model[nv, nu] <= 0.0 and abs(other - d) <= slack):
                    support += 1
            if support >= enough:
                return True
    return False


@njit(cache=True, nogil=True, error_model="numpy")
def mark_tiles(balls, camera_from_links, view, near, far):
    """Per tile of 16 x 16 pixels, the least and greatest depth of the balls that may be seen in it.

    Args:
        balls: link, centre and radius of each (`kernels.body.Clusters`).
        camera_from_links: (links, 4, 4).
        view: the camera.
        near, far: (rows, columns) of tiles, infinity and 0 before [m, the camera's kind].
    """
    for n in range(balls.link.size):
        r = balls.radius[n]
        x, y, z = moved(
            camera_from_links[balls.link[n]], balls.centre[n, 0], balls.centre[n, 1], balls.centre[n, 2]
        )
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
    left, right = _limit(view, row, around, scratch.limits)
    if left >= right:
        return
    for v in range(row * TILE, min(row * TILE + TILE, view.height)):
        _find(depth[v], model[v], scratch.limits, left, right, scratch.found)
        _mark_row(view, depth, model, v, left, right, around, scratch)


@uncounted(error_model="numpy")
def _limit(view, row, around, limits):
    """Writes the depths that are looked for in the pixels of a row of tiles; first and one past the last column."""
    near, far, width, least, most = around.near, around.far, view.width, limits[0], limits[1]
    left, right = width, 0
    for column in range(near.shape[1]):
        start, stop = column * TILE, min(column * TILE + TILE, width)
        set_run(least, start, stop, np.float32(max(near[row, column], view.min_depth)))
        set_run(most, start, stop, np.float32(min(far[row, column], view.max_depth)))
        if far[row, column] > 0.0:
            left, right = min(left, start), stop
    return left, right


@uncounted(error_model="numpy")
def _find(depth, model, limits, left, right, found):
    """Notes the pixels of a row that are not explained and whose depth lies within their limits."""
    least, most = limits[0], limits[1]
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
def _mark_row(view, depth, model, v, left, right, around, scratch):
    """Sets the voxels of the returns that were found in one row of pixels, from column left up to right."""
    # taken out of the tuples once: each look into them counts references, which costs more than the arithmetic below
    found, boxes, same = scratch.found, scratch.boxes, scratch.same
    lattice, words = around.lattice, around.words
    measured, eight = depth[v], found.view(np.uint64)
    # tiles start at whole words of eight pixels; whether the box of the pixel before was seen to be set: neighbours
    # mostly have the same box
    done, known = left, False
    for n in range(left // 8, (right + 7) // 8):
        if eight[n] == 0:
            continue
        if 8 * n >= done:
            done = 8 * n
            while done < right and eight[done // 8] != 0:
                done = min(done + 8, right)
            _bound_returns(view, v, measured, 8 * n, done, around, scratch)
            _same_boxes(boxes, 8 * n, done, same)
        for u in range(8 * n, min(8 * n + 8, right)):
            known = known and same[u] != 0
            if found[u] == 0 or known:
                continue
            # the voxels first: most are set already
            known = _all_set(boxes, u, lattice, words)
            if not known and has_support(view, depth, model, u, v):
                _mark_return(view, u, v, measured[u], around)


@uncounted(error_model="numpy")
def _bound_returns(view, v, depth, start, stop, around, scratch):
    """First and last voxel along each axis of a box about all that each return of a run may lie in.

    In float32 and without branches, for many pixels at once; the box is wider by more than that errs.

    Args:
        v, start, stop: row of the run, its first column, one past its last.
        depth: (width,) of the row [m].
        around: how far returns may be off, the camera's pose, the grid.
        scratch: its spans and boxes are written.
    """
    y, scale, one = np.float32((v - view.cy) / view.fy), 1.0 / around.lattice.edge, np.float32(1.0)
    cx, pitch, square = np.float32(view.cx), np.float32(1.0 / view.fx), one + y * y
    half_pixel = np.float32(0.5 / min(view.fx, view.fy) * scale)
    noise, radial, spans = spread_of(view, around.sigmas, 0.0), view.radial, scratch.spans
    for n in range(start, stop):
        u = np.uint64(n)
        x = (np.float32(n) - cx) * pitch
        d = depth[u]
        planar = one / np.sqrt(square + x * x) if radial else one
        spread = sigma(noise, d)
        spans[0, u], spans[1, u] = (d - spread) * planar, (d + spread) * planar
        spans[2, u] = half_pixel * d * planar
    for axis in range(3):
        _bound_along(axis, y, view, start, stop, around, scratch)


@uncounted(error_model="numpy")
def _bound_along(axis, y, view, start, stop, around, scratch):
    """The boxes of `_bound_returns` along one axis, from their spans; y: Y/Z of the row's rays."""
    lattice, pose, spans, boxes = around.lattice, around.world_from_camera, scratch.spans, scratch.boxes
    scale, one, zero = 1.0 / lattice.edge, np.float32(1.0), np.float32(0.0)
    cx, pitch = np.float32(view.cx), np.float32(1.0 / view.fx)
    corner = lattice.x0 if axis == 0 else lattice.y0 if axis == 1 else lattice.z0
    end = np.float32(lattice.nx if axis == 0 else lattice.ny if axis == 1 else lattice.nz)
    origin = np.float32((pose[axis, 3] - corner) * scale)
    turn = np.float32(pose[axis, 0] * scale) * pitch
    base = np.float32((pose[axis, 1] * y + pose[axis, 2]) * scale)
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
def _same_boxes(boxes, start, stop, same):
    """Notes which pixels of a run have the same box as the one before; the first one has not."""
    for n in range(start, stop):
        u, before = np.uint64(n), np.uint64(max(n - 1, 0))
        same[u] = (
            (n > start)
            & (boxes[0, u] == boxes[0, before])
            & (boxes[1, u] == boxes[1, before])
            & (boxes[2, u] == boxes[2, before])
            & (boxes[3, u] == boxes[3, before])
            & (boxes[4, u] == boxes[4, before])
            & (boxes[5, u] == boxes[5, before])
        )


@njit(inline="always")
def _row_bits(i, j, k, last):
    """Of the word of voxel (i, j, k), the bits of the voxels (i, j, k) to (i, j, last), as far as they are its own."""
    row = (np.uint64(2) << np.uint64(min(last - (k & ~3), 3))) - (np.uint64(1) << np.uint64(k & 3))
    return row << np.uint64(((i & 3) * 4 + (j & 3)) * 4)


@uncounted(error_model="numpy")
def _all_set(boxes, u, lattice, words):
    """Whether all voxels of a box are set already."""
    last = boxes[5, u]
    for i in range(boxes[0, u], boxes[1, u] + 1):
        for j in range(boxes[2, u], boxes[3, u] + 1):
            k = boxes[4, u]
            while k <= last:
                bits = _row_bits(i, j, k, last)
                if words[word_of(i, j, k, lattice.cubes_y, lattice.cubes_z)] & bits != bits:
                    return False
                k = (k & ~3) + 4
    return True


@uncounted(error_model="numpy")
def _mark_return(view, u, v, d, around):
    """Sets the voxels that one return may lie in."""
    pose, lattice = around.world_from_camera, around.lattice
    x, y = (u - view.cx) / view.fx, (v - view.cy) / view.fy
    z = d / math.sqrt(1.0 + x * x + y * y) if view.radial else float(d)
    scale = 1.0 / lattice.edge
    half = 0.5 / min(view.fx, view.fy) / lattice.edge * z
    # the ray in voxels from the grid's corner
    ox, oy, oz = (
        (pose[0, 3] - lattice.x0) * scale,
        (pose[1, 3] - lattice.y0) * scale,
        (pose[2, 3] - lattice.z0) * scale,
    )
    rx, ry, rz = turned(pose, x, y, 1.0)
    rx, ry, rz = rx * scale, ry * scale, rz * scale
    spread = around.sigmas * sigma(view, d) * z / d
    # steps of at most half a voxel
    steps = min(math.ceil(4.0 * spread / lattice.edge), 1000)
    for n in range(steps + 1):
        away = z if steps == 0 else z + spread * (2.0 * n / steps - 1.0)
        _set_cube(ox + rx * away, oy + ry * away, oz + rz * away, half, lattice, around.words)


@uncounted(error_model="numpy")
def _set_cube(x, y, z, half, lattice, words):
    """Sets the voxels that a cube about (x, y, z) meets, all in voxels from the grid's corner."""
    nx, ny, nz = lattice.nx, lattice.ny, lattice.nz
    if not (-half <= x < nx + half and -half <= y < ny + half and -half <= z < nz + half):
        return
    first, last = max(0, math.floor(z - half)), min(nz - 1, math.floor(z + half))
    for i in range(max(0, math.floor(x - half)), min(nx - 1, math.floor(x + half)) + 1):
        for j in range(max(0, math.floor(y - half)), min(ny - 1, math.floor(y + half)) + 1):
            k = first
            while k <= last:
                words[word_of(i, j, k, lattice.cubes_y, lattice.cubes_z)] |= _row_bits(i, j, k, last)
                k = (k & ~3) + 4


@uncounted(error_model="numpy")
def set_run(array, start, stop, value):
    """Sets a run of an array. Unsigned indices, as above, or the compiler does one pixel at a time."""
    for n in range(start, stop):
        array[np.uint64(n)] = value
