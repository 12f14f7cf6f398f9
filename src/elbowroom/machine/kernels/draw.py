"""Draws the machine's triangles into depth images: arrays in, arrays out."""

import math
from typing import NamedTuple

import numpy as np
from numba import njit

NEAR_M = 0.001
EDGE_PX = 1e-7


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


class Drawn(NamedTuple):
    """An image of inverse planar depth [1/m], float32, 0 where nothing is, and the first and last column drawn in each
    row; rows without: width and -1."""

    inverse: np.ndarray
    first: np.ndarray
    last: np.ndarray


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
                one, two = (seen[a, 0], seen[a, 1], seen[a, 2]), (seen[b, 0], seen[b, 1], seen[b, 2])
                _fill(one, two, (seen[c, 0], seen[c, 1], seen[c, 2]), view, inverse, first, last)
            elif behind < 3:
                # one number at a time, here and below: assigning rows takes the compiler seconds longer
                for axis in range(3):
                    corners[0, axis] = seen[a, axis]
                    corners[1, axis] = seen[b, axis]
                    corners[2, axis] = seen[c, axis]
                _clip_and_fill(corners, view, inverse, first, last)


@njit(nogil=True, error_model="numpy")
def _sphere_in_view(camera_from_link, centre, radius, view):
    """Whether a sphere may meet the image: not beyond the near plane or a side of the view."""
    pose = camera_from_link
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
def _is_outside(camera_from_link, centre, radius):
    """Whether the camera is outside a sphere, and the near plane too."""
    pose = camera_from_link
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
            for axis in range(3):
                kept[n, axis] = points[p, axis]
            n += 1
        if inside != next_inside:
            t = (NEAR_M - points[p, 2]) / (points[q, 2] - points[p, 2])
            for axis in range(2):
                kept[n, axis] = points[p, axis] + t * (points[q, axis] - points[p, axis])
            kept[n, 2] = NEAR_M
            n += 1
    for p in range(n):
        z = kept[p, 2]
        kept[p, 0], kept[p, 1] = view.fx * kept[p, 0] / z + view.cx, view.fy * kept[p, 1] / z + view.cy
        kept[p, 2] = 1.0 / z
    for p in range(1, n - 1):
        one, two = (kept[0, 0], kept[0, 1], kept[0, 2]), (kept[p, 0], kept[p, 1], kept[p, 2])
        _fill(one, two, (kept[p + 1, 0], kept[p + 1, 1], kept[p + 1, 2]), view, inverse, first, last)


@njit(nogil=True, error_model="numpy")
def _fill(one, two, three, view, inverse, first, last):
    """Draws a triangle given by its corners, each as column, row and inverse depth.

    Inverse depth is linear over the image. Rows are cut by the triangle's edges, each always taken from its
    upper end, so that neighbours meet without gaps.
    """
    ua, va, ia = one
    ub, vb, ib = two
    uc, vc, ic = three
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
        on_long = ua + (v - va) * long_slope
        if v < vb:
            on_short = ua + (v - va) * upper_slope
        elif v > vb or vc > vb:
            on_short = ub + (v - vb) * lower_slope
        else:
            on_short = ub
        x0 = math.ceil(max(min(on_long, on_short) - EDGE_PX, left))
        x1 = math.floor(min(max(on_long, on_short) + EDGE_PX, right))
        if x0 > x1:
            continue
        first[row], last[row] = min(first[row], x0), max(last[row], x1)
        start = ia + down * (row - va) - along * ua
        line = inverse[row]
        # unsigned indices and small numbers, or the compiler does one pixel at a time
        for n in range(x0, x1 + 1):
            x = np.uint64(n)
            value = np.float32(min(max(start + along * np.float64(np.int32(n)), least), most))
            line[x] = max(line[x], value)


@njit(cache=True, nogil=True, error_model="numpy")
def to_kind(view, inverse, first, last):
    """Turns inverse planar depth into inverse depth of the camera's kind, where something was drawn."""
    if view.radial:
        for v in range(view.height):
            y = (v - view.cy) / view.fy
            for u in range(first[v], last[v] + 1):
                x = (u - view.cx) / view.fx
                inverse[v, u] /= math.sqrt(1.0 + x * x + y * y)
