"""Draws triangles into depth images and compares them with measured ones: arrays in, arrays out."""

import math
from typing import NamedTuple

import numpy as np
from numba import njit

from elbowroom.geometry._kernels import Lattice, bit_of, word_of

NEAR_M = 0.001
MOST_M = 1e6
EDGE_PX = 1e-7
TILE = 16
UNSAFE = np.float32(-1e-6)
"""In place of a depth where the model is about a pixel, but what is about it is not all explained or farther [m]."""


SUPPORT = 4
"""Of eight neighbours, how many must be like a return beside the machine's edge for it to count as a surface."""


class View(NamedTuple):
    """A pinhole camera as kernels take it: image, intrinsics [px], kind of depth, range [m], noise, and whether a
    return at a step of depth may lie anywhere between its two sides (flying pixels)."""

    width: int
    height: int
    fx: float
    fy: float
    cx: float
    cy: float
    radial: bool
    min_depth: float
    max_depth: float
    constant: float
    linear: float
    quadratic: float
    offset: float
    flying: bool


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


class Mesh(NamedTuple):
    """Triangles of many links; link l has vertices vertex_start[l] to vertex_start[l + 1].

    Faces refer to `vertices` as a whole. `centre`, `radius`: a sphere about each link, in its frame.
    `closed`: the link's surface is closed and its faces turn outwards, so that from outside the backs of
    faces are hidden.
    """

    vertices: np.ndarray
    faces: np.ndarray
    vertex_start: np.ndarray
    face_start: np.ndarray
    centre: np.ndarray
    radius: np.ndarray
    closed: np.ndarray


@njit(cache=True, nogil=True, error_model="numpy")
def draw(mesh, camera_from_link, view, inverse, first, last):
    """Draws links into an image of inverse planar depth; what is nearer wins.

    Args:
        mesh: the links.
        camera_from_link: (links, 4, 4).
        view: the camera.
        inverse: (height, width) float32, 1 / planar depth [1/m], 0 where nothing is.
        first, last: (height,) first and last column drawn in each row; rows without: width and -1.
    """
    seen = np.empty((mesh.vertices.shape[0], 3))
    corners = np.empty((3, 3))
    for l in range(mesh.radius.size):  # noqa: E741
        if mesh.face_start[l + 1] == mesh.face_start[l]:
            continue
        pose = camera_from_link[l]
        if not _sphere_in_view(pose, mesh.centre[l], mesh.radius[l], view):
            continue
        backs = not (mesh.closed[l] and _is_outside(pose, mesh.centre[l], mesh.radius[l]))
        for p in range(mesh.vertex_start[l], mesh.vertex_start[l + 1]):
            a, b, c = mesh.vertices[p, 0], mesh.vertices[p, 1], mesh.vertices[p, 2]
            x = pose[0, 0] * a + pose[0, 1] * b + pose[0, 2] * c + pose[0, 3]
            y = pose[1, 0] * a + pose[1, 1] * b + pose[1, 2] * c + pose[1, 3]
            z = pose[2, 0] * a + pose[2, 1] * b + pose[2, 2] * c + pose[2, 3]
            if z >= NEAR_M:
                seen[p, 0], seen[p, 1], seen[p, 2] = (
                    view.fx * x / z + view.cx,
                    view.fy * y / z + view.cy,
                    1.0 / z,
                )
            else:
                # behind the near plane: kept as it is, for clipping; told apart by the sign
                seen[p, 0], seen[p, 1], seen[p, 2] = x, y, min(z - NEAR_M, -1e-12)
        for f in range(mesh.face_start[l], mesh.face_start[l + 1]):
            a, b, c = mesh.faces[f, 0], mesh.faces[f, 1], mesh.faces[f, 2]
            behind = (seen[a, 2] < 0.0) + (seen[b, 2] < 0.0) + (seen[c, 2] < 0.0)
            if behind == 0:
                area = (seen[b, 0] - seen[a, 0]) * (seen[c, 1] - seen[a, 1])
                area -= (seen[c, 0] - seen[a, 0]) * (seen[b, 1] - seen[a, 1])
                if area > 0.0 and not backs:
                    continue
                _fill(
                    seen[a, 0], seen[a, 1], seen[a, 2], seen[b, 0], seen[b, 1], seen[b, 2],
                    seen[c, 0], seen[c, 1], seen[c, 2], view, inverse, first, last,
                )  # fmt: skip
            elif behind < 3:
                corners[0], corners[1], corners[2] = seen[a], seen[b], seen[c]
                _clip_and_fill(corners, view, inverse, first, last)


@njit(nogil=True, error_model="numpy")
def _sphere_in_view(pose, centre, radius, view):
    """Whether a sphere may meet the image: not beyond the near plane or a side of the view."""
    a, b, c = centre[0], centre[1], centre[2]
    x = pose[0, 0] * a + pose[0, 1] * b + pose[0, 2] * c + pose[0, 3]
    y = pose[1, 0] * a + pose[1, 1] * b + pose[1, 2] * c + pose[1, 3]
    z = pose[2, 0] * a + pose[2, 1] * b + pose[2, 2] * c + pose[2, 3]
    if z + radius < NEAR_M:
        return False
    left, right = view.cx + 0.5, view.width - 0.5 - view.cx
    above, below = view.cy + 0.5, view.height - 0.5 - view.cy
    return (
        view.fx * x + left * z >= -radius * math.hypot(view.fx, left)
        and right * z - view.fx * x >= -radius * math.hypot(view.fx, right)
        and view.fy * y + above * z >= -radius * math.hypot(view.fy, above)
        and below * z - view.fy * y >= -radius * math.hypot(view.fy, below)
    )


@njit(nogil=True, error_model="numpy")
def _is_outside(pose, centre, radius):
    """Whether the camera is outside a sphere, and the near plane too."""
    square = 0.0
    for i in range(3):
        along = pose[i, 0] * centre[0] + pose[i, 1] * centre[1] + pose[i, 2] * centre[2] + pose[i, 3]
        square += along * along
    return square > (radius + 2 * NEAR_M) ** 2


@njit(nogil=True, error_model="numpy")
def _clip_and_fill(corners, view, inverse, first, last):
    """Cuts a triangle at the near plane and draws the one or two triangles that are left."""
    points = np.empty((3, 3))
    for p in range(3):
        if corners[p, 2] < 0.0:
            points[p, 0], points[p, 1], points[p, 2] = corners[p, 0], corners[p, 1], corners[p, 2] + NEAR_M
        else:
            z = 1.0 / corners[p, 2]
            points[p, 0] = (corners[p, 0] - view.cx) * z / view.fx
            points[p, 1] = (corners[p, 1] - view.cy) * z / view.fy
            points[p, 2] = z
    kept = np.empty((4, 3))
    n = 0
    for p in range(3):
        q = (p + 1) % 3
        inside, next_inside = corners[p, 2] > 0.0, corners[q, 2] > 0.0
        if inside:
            kept[n] = points[p]
            n += 1
        if inside != next_inside:
            t = (NEAR_M - points[p, 2]) / (points[q, 2] - points[p, 2])
            kept[n] = points[p] + t * (points[q] - points[p])
            kept[n, 2] = NEAR_M
            n += 1
    for p in range(n):
        z = kept[p, 2]
        kept[p, 0], kept[p, 1] = view.fx * kept[p, 0] / z + view.cx, view.fy * kept[p, 1] / z + view.cy
        kept[p, 2] = 1.0 / z
    for p in range(1, n - 1):
        _fill(
            kept[0, 0], kept[0, 1], kept[0, 2], kept[p, 0], kept[p, 1], kept[p, 2],
            kept[p + 1, 0], kept[p + 1, 1], kept[p + 1, 2], view, inverse, first, last,
        )  # fmt: skip


@njit(nogil=True, error_model="numpy")
def _fill(ua, va, ia, ub, vb, ib, uc, vc, ic, view, inverse, first, last):
    """Draws a triangle given by its corners' columns, rows and inverse depths.

    Inverse depth is linear over the image. Rows are cut by the triangle's edges, each always taken from its
    upper end, so that neighbours meet without gaps.
    """
    # corners from the top down
    if vb < va:
        ua, va, ia, ub, vb, ib = ub, vb, ib, ua, va, ia
    if vc < va:
        ua, va, ia, uc, vc, ic = uc, vc, ic, ua, va, ia
    if vc < vb:
        ub, vb, ib, uc, vc, ic = uc, vc, ic, ub, vb, ib
    if not (va <= view.height - 1 + EDGE_PX and vc >= -EDGE_PX):
        return
    left, right = min(ua, ub, uc), max(ua, ub, uc)
    if not (left <= view.width - 1 + EDGE_PX and right >= -EDGE_PX):
        return
    top, bottom = math.ceil(max(va - EDGE_PX, 0.0)), math.floor(min(vc + EDGE_PX, view.height - 1.0))
    left, right = max(left - EDGE_PX, 0.0), min(right + EDGE_PX, view.width - 1.0)
    if top > bottom or math.ceil(left) > math.floor(right):
        return
    area = (ub - ua) * (vc - va) - (uc - ua) * (vb - va)
    if abs(area) < 1e-12:
        return
    along = ((ib - ia) * (vc - va) - (ic - ia) * (vb - va)) / area
    down = ((ic - ia) * (ub - ua) - (ib - ia) * (uc - ua)) / area
    least, most = min(ia, ib, ic), max(ia, ib, ic)
    long_slope = (uc - ua) / (vc - va)
    upper_slope = (ub - ua) / (vb - va) if vb > va else 0.0
    lower_slope = (uc - ub) / (vc - vb) if vc > vb else 0.0
    for row in range(top, bottom + 1):
        v = min(max(float(row), va), vc)
        one = ua + (v - va) * long_slope
        if v < vb:
            two = ua + (v - va) * upper_slope
        elif v > vb or vc > vb:
            two = ub + (v - vb) * lower_slope
        else:
            two = ub
        x0 = math.ceil(max(min(one, two) - EDGE_PX, left))
        x1 = math.floor(min(max(one, two) + EDGE_PX, right))
        if x0 > x1:
            continue
        first[row], last[row] = min(first[row], x0), max(last[row], x1)
        start = ia + down * (row - va) - along * ua
        for x in range(x0, x1 + 1):
            value = np.float32(min(max(start + along * x, least), most))
            inverse[row, x] = max(inverse[row, x], value)


@njit(cache=True, nogil=True, error_model="numpy")
def to_kind(view, inverse, first, last):
    """Turns inverse planar depth into inverse depth of the camera's kind, where something was drawn."""
    if view.radial:
        for v in range(view.height):
            y = (v - view.cy) / view.fy
            for u in range(first[v], last[v] + 1):
                x = (u - view.cx) / view.fx
                inverse[v, u] /= math.sqrt(1.0 + x * x + y * y)


@njit(cache=True, nogil=True, error_model="numpy")
def explain(view, depth, inverse, first, last, tolerance, sigmas, model, around):
    """Fills `model` where a measured depth fits what was drawn in the 3 x 3 pixels about it; wipes `inverse`.

    Sets the voxels of the returns that do not fit, too.

    Args:
        view: the camera.
        depth: (height, width) float32, measured [m, the camera's kind].
        inverse: (height, width) float32, from `draw` and `to_kind`; zeros afterwards.
        first, last: (height,) columns drawn in each row.
        tolerance, sigmas: a depth d fits if it lies within tolerance [m] + sigmas * sigma(d).
        model: (height, width) float32 zeros; where a pixel fits, the depth drawn in it, or else nearest about it
            [m, same kind]. Of a camera whose pixels fly, also what `_settle_edges` says.
        around: where to look for other returns, and the plane for their voxels; without tiles: nowhere.
    """
    height, width = view.height, view.width
    left, right = width, -1
    for v in range(height):
        left, right = min(left, first[v]), max(right, last[v])
    left, right = max(0, left - 1), min(width - 1, right + 1)
    # for each of three rows: greatest and least inverse depth of a pixel and its neighbours
    across = np.zeros((8, width + 2), dtype=np.float32)
    # above the first row is nothing
    across[3:6] = np.inf
    limits = np.empty((2, width), dtype=np.float32)
    found = np.zeros((width + 7) // 8 * 8, dtype=np.uint8)
    for v in range(-1, height):
        _across(inverse, v + 1, first, last, left, right, across, (v + 1) % 3)
        if v < 0:
            continue
        start, stop = width, -1
        for row in range(max(0, v - 1), min(height, v + 2)):
            start, stop = min(start, first[row]), max(stop, last[row])
        if stop >= 0:
            start, stop = max(0, start - 1), min(width - 1, stop + 1)
            _compare(view, depth[v], inverse[v], across, start, stop, tolerance, sigmas, model[v])
    if view.flying:
        _settle_edges(view, depth, first, last, model)
    for row in range(around.near.shape[0]):
        _mark_row_of_tiles(view, depth, model, row, around, limits, found)
    for v in range(height):
        _set(inverse[v], first[v], last[v] + 1, np.float32(0.0))


@njit(nogil=True, error_model="numpy")
def _across(inverse, v, first, last, left, right, across, row):
    """Greatest (row) and least (row + 3) inverse depth of each pixel of image row v and its two neighbours.

    Zero and infinity where there is none. Column u of the image is column u + 1 of `across`.
    """
    most, least = across[row], across[row + 3]
    _set(most, left, right + 3, np.float32(0.0))
    _set(least, left, right + 3, np.float32(np.inf))
    if v < inverse.shape[0] and last[v] >= 0:
        _of_neighbours(inverse[v], first[v], last[v], across[6], across[7], most, least)


@njit(nogil=True, error_model="numpy")
def _set(array, start, stop, value):
    """Sets a run of an array. Unsigned indices, as below, or the compiler does one pixel at a time."""
    for n in range(start, stop):
        array[np.uint64(n)] = value


@njit(nogil=True, error_model="numpy")
def _of_neighbours(drawn, first, last, padded, filled, most, least):
    """Greatest and least of three neighbours; `padded` takes what was drawn, `filled` has infinity for 0."""
    start, stop = max(0, first - 1), min(drawn.size - 1, last + 1)
    one, two, zero, far = np.uint64(1), np.uint64(2), np.float32(0.0), np.float32(np.inf)
    _set(padded, start, stop + 3, zero)
    for n in range(first, last + 1):
        u = np.uint64(n)
        padded[u + one] = drawn[u]
    for n in range(start, stop + 3):
        u = np.uint64(n)
        filled[u] = padded[u] if padded[u] > zero else far
    for n in range(start, stop + 1):
        u = np.uint64(n)
        most[u + one] = max(padded[u], max(padded[u + one], padded[u + two]))
    for n in range(start, stop + 1):
        u = np.uint64(n)
        least[u + one] = min(filled[u], min(filled[u + one], filled[u + two]))


@njit(nogil=True, error_model="numpy")
def _compare(view, depth, drawn, across, start, stop, tolerance, sigmas, model):
    """Fills one row of the model where depth fits; without branches, for many pixels at once."""
    one, zero = np.float32(1.0), np.float32(0.0)
    fixed, factor = np.float32(tolerance + sigmas * view.constant), np.float32(sigmas * view.linear)
    square, offset = np.float32(sigmas * view.quadratic), np.float32(view.offset)
    low, high = np.float32(view.min_depth), np.float32(min(view.max_depth, MOST_M))
    for u in range(start, stop + 1):
        nearest = max(across[0, u + 1], max(across[1, u + 1], across[2, u + 1]))
        farthest = min(across[3, u + 1], min(across[4, u + 1], across[5, u + 1]))
        d = depth[u]
        beyond = max(d - offset, zero)
        slack = fixed + factor * d + square * beyond * beyond
        valid = (d > zero) & (d >= low) & (d <= high)
        fits = valid & (nearest > zero) & ((d + slack) * nearest >= one) & ((d - slack) * farthest <= one)
        # behind the model's nearest surface and beside it: perhaps a mixed pixel of its edge (`_settle_edges`)
        # up to the surface drawn in the pixel itself; beside the drawn edge up to the nearest one about it
        free_to = one / (drawn[u] if drawn[u] > zero else nearest)
        unfit = -free_to if view.flying & (nearest > zero) else zero
        model[u] = free_to if fits else unfit


@njit(nogil=True, error_model="numpy")
def _has_support(view, depth, model, u, v):
    """Whether at least `SUPPORT` of eight neighbours are like an unexplained return: a surface, not a flying pixel.

    Where no pixels fly one neighbour is enough.

    Like it is a neighbour that is unexplained too and about as deep, and one that has no return or lies outside the
    image: so a lost neighbour never takes support away. Anything three pixels wide has support in its middle.
    """
    d = depth[v, u]
    slack = 4.5 * _sigma(view, d) + d / min(view.fx, view.fy)
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


@njit(nogil=True, error_model="numpy")
def _settle_edges(view, depth, first, last, model):
    """Pixels that the model is about without fitting, below zero on entry by the depth that the model frees.

    Those that see past the machine's edge and stand alone are mixed pixels of the edge: explained, infinity. Others
    about which all is explained or farther are specks, and explained as well: they stay below zero. The rest becomes
    `UNSAFE`.
    """
    for turn in range(3):
        for v in range(view.height):
            start, stop = view.width, -1
            for row in range(max(0, v - 1), min(view.height, v + 2)):
                start, stop = min(start, first[row]), max(stop, last[row])
            for u in range(max(0, start - 1), min(view.width - 1, stop + 1) + 1 if stop >= 0 else 0):
                if model[v, u] >= 0.0:
                    continue
                if turn == 0:
                    # with another mark first, so that all are judged by the same neighbours
                    d = depth[v, u]
                    past = _is_return(view, d) and d > -model[v, u]
                    if past and not _has_support(view, depth, model, u, v):
                        model[v, u] = -np.inf
                elif turn == 1:
                    if model[v, u] == -np.inf:
                        model[v, u] = np.inf
                elif not _is_speck(view, depth, model, u, v):
                    model[v, u] = UNSAFE


@njit(nogil=True, error_model="numpy")
def _is_speck(view, depth, model, u, v):
    """Whether all neighbours of a pixel, or of it and one beside it, are explained or see past the model in it."""
    least = -model[v, u]
    for dv in range(-1, 2):
        for du in range(-1, 2):
            ov, ou = v + dv, u + du
            if not (0 < v < view.height - 1 and 0 < u < view.width - 1):
                return False
            if not (0 < ov < view.height - 1 and 0 < ou < view.width - 1):
                continue
            clear = True
            for nv in range(min(v, ov) - 1, max(v, ov) + 2):
                for nu in range(min(u, ou) - 1, max(u, ou) + 2):
                    near_one = abs(nv - v) <= 1 and abs(nu - u) <= 1
                    near_other = abs(nv - ov) <= 1 and abs(nu - ou) <= 1
                    own = (nv == v and nu == u) or (nv == ov and nu == ou)
                    if (near_one or near_other) and not own:
                        d = depth[nv, nu]
                        clear &= model[nv, nu] > 0.0 or (_is_return(view, d) and d > least)
            if clear:
                return True
    return False


@njit(nogil=True, error_model="numpy")
def _is_return(view, d):
    """Whether a depth was measured at all."""
    return d > 0.0 and d >= view.min_depth and d <= view.max_depth and d <= MOST_M


@njit(nogil=True, error_model="numpy")
def _sigma(view, d):
    """Standard deviation at a measured depth (geometry.noise)."""
    beyond = max(d - view.offset, 0.0)
    return view.constant + view.linear * d + view.quadratic * beyond * beyond


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
def _mark_row_of_tiles(view, depth, model, row, around, limits, found):
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
        _set(least, start, stop, np.float32(max(around.near[row, column], view.min_depth)))
        _set(most, start, stop, np.float32(min(around.far[row, column], view.max_depth)))
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
                        and _has_support(view, depth, model, u, v)
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
    spread = sigmas * _sigma(view, d) * z / d
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
