"""Draws the machine's triangles into depth images: arrays in, arrays out."""

import math
from typing import NamedTuple

import numpy as np
from numba import njit

from elbowroom.geometry.kernels.bits import uncounted
from elbowroom.geometry.kernels.pinhole import pixel_of, radial_over_planar
from elbowroom.geometry.kernels.rigid import moved

NEAR_M = 0.001
"""What is nearer to the camera's plane is cut off [m]."""
EDGE_PX = 1e-7
"""So far beyond an edge a pixel's centre is still on it: rounding leaves no gap between neighbours [px]."""


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


class Canvas(NamedTuple):
    """An image that is drawn into.

    Fields:
        inverse: 1 / depth, 0 where nothing is, shape (height, width), float32 [1/m]; planar as `draw` leaves it.
        first, last: first and last column drawn in each row, shape (height,), int64; rows without: width and -1.
    """

    inverse: np.ndarray
    first: np.ndarray
    last: np.ndarray


class Corner(NamedTuple):
    """A triangle's corner in the image: column, row [px], inverse planar depth [1/m]."""

    u: float
    v: float
    inverse: float


class Slopes(NamedTuple):
    """Columns per row along a triangle's edges: from top to bottom, from top to middle, from middle to bottom."""

    long: float
    upper: float
    lower: float


class Plane(NamedTuple):
    """Inverse depth over a triangle's image: its top corner, change per column and per row, least and most of it."""

    top: Corner
    along: float
    down: float
    least: float
    most: float


@njit(cache=True, nogil=True, error_model="numpy")
def draw(mesh, camera_from_links, view, canvas):
    """Draws links into an image of inverse planar depth; what is nearer wins.

    Args:
        mesh: the links.
        camera_from_links: (links, 4, 4).
        view: the camera.
        canvas: where to.
    """
    # of each vertex column, row and inverse depth
    seen = np.empty((mesh.vertices.shape[0], 3))
    for l in range(mesh.radius.size):  # noqa: E741
        if mesh.face_start[l + 1] == mesh.face_start[l]:
            continue
        camera_from_link = camera_from_links[l]
        if not _sphere_in_view(camera_from_link, mesh.centre[l], mesh.radius[l], view):
            continue
        backs = not (mesh.closed[l] and _is_outside(camera_from_link, mesh.centre[l], mesh.radius[l]))
        for p in range(mesh.vertex_start[l], mesh.vertex_start[l + 1]):
            x, y, z = moved(camera_from_link, mesh.vertices[p, 0], mesh.vertices[p, 1], mesh.vertices[p, 2])
            if z >= NEAR_M:
                u, v = pixel_of(view, x, y, z)
                seen[p, 0], seen[p, 1], seen[p, 2] = u, v, 1.0 / z
            else:
                # behind the near plane: kept as it is, for clipping; told apart by the sign
                seen[p, 0], seen[p, 1], seen[p, 2] = x, y, min(z - NEAR_M, -1e-12)
        for f in range(mesh.face_start[l], mesh.face_start[l + 1]):
            a, b, c = mesh.faces[f, 0], mesh.faces[f, 1], mesh.faces[f, 2]
            behind = (seen[a, 2] < 0.0) + (seen[b, 2] < 0.0) + (seen[c, 2] < 0.0)
            if behind == 0:
                area = (seen[b, 0] - seen[a, 0]) * (seen[c, 1] - seen[a, 1])
                area -= (seen[c, 0] - seen[a, 0]) * (seen[b, 1] - seen[a, 1])
                if (backs or not area > 0.0) and _meets_centres(seen, a, b, c, view):
                    _fill(_corner(seen, a), _corner(seen, b), _corner(seen, c), view, canvas)
            elif behind < 3:
                _clip_and_fill(seen, (a, b, c), view, canvas)


@uncounted(error_model="numpy")
def _meets_centres(seen, a, b, c, view):
    """Whether a pixel's centre lies in the rectangle about a triangle: of small ones few hold any."""
    low, high = (
        min(seen[a, 1], seen[b, 1], seen[c, 1]) - EDGE_PX,
        max(seen[a, 1], seen[b, 1], seen[c, 1]) + EDGE_PX,
    )
    if not math.ceil(low) <= high:
        return False
    low, high = (
        min(seen[a, 0], seen[b, 0], seen[c, 0]) - EDGE_PX,
        max(seen[a, 0], seen[b, 0], seen[c, 0]) + EDGE_PX,
    )
    return math.ceil(low) <= high


@njit(nogil=True, error_model="numpy")
def _sphere_in_view(camera_from_link, centre, radius, view):
    """Whether a sphere may meet the image: not beyond the near plane or a side of the view."""
    x, y, z = moved(camera_from_link, centre[0], centre[1], centre[2])
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
    x, y, z = moved(camera_from_link, centre[0], centre[1], centre[2])
    return x * x + y * y + z * z > (radius + 2 * NEAR_M) ** 2


@njit(inline="always")
def _corner(rows, n):
    """One row of an array as a corner."""
    return Corner(rows[n, 0], rows[n, 1], rows[n, 2])


@njit(nogil=True, error_model="numpy")
def _clip_and_fill(seen, face, view, canvas):
    """Cuts a triangle at the near plane and draws the one or two triangles that are left."""
    points = np.empty((3, 3))
    # one number at a time, here and below: assigning rows takes the compiler seconds longer
    for p in range(3):
        u, v, w = seen[face[p], 0], seen[face[p], 1], seen[face[p], 2]
        if w < 0.0:
            points[p, 0], points[p, 1], points[p, 2] = u, v, w + NEAR_M
        else:
            z = 1.0 / w
            points[p, 0], points[p, 1], points[p, 2] = (
                (u - view.cx) * z / view.fx,
                (v - view.cy) * z / view.fy,
                z,
            )
    kept = np.empty((4, 3))
    n = 0
    for p in range(3):
        q = (p + 1) % 3
        inside, next_inside = seen[face[p], 2] > 0.0, seen[face[q], 2] > 0.0
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
        u, v = pixel_of(view, kept[p, 0], kept[p, 1], kept[p, 2])
        kept[p, 0], kept[p, 1], kept[p, 2] = u, v, 1.0 / kept[p, 2]
    for p in range(1, n - 1):
        _fill(_corner(kept, 0), _corner(kept, p), _corner(kept, p + 1), view, canvas)


@uncounted(error_model="numpy")
def _fill(a, b, c, view, canvas):
    """Draws a triangle given by its corners.

    Inverse depth is linear over the image. Rows are cut by the triangle's edges, each always taken from its
    upper end, so that neighbours meet without gaps.
    """
    # corners from the top down
    if b.v < a.v:
        a, b = b, a
    if c.v < a.v:
        a, c = c, a
    if c.v < b.v:
        b, c = c, b
    left, right = min(a.u, b.u, c.u), max(a.u, b.u, c.u)
    if not (a.v <= view.height - 1 + EDGE_PX and c.v >= -EDGE_PX):
        return
    if not (left <= view.width - 1 + EDGE_PX and right >= -EDGE_PX):
        return
    top, bottom = math.ceil(max(a.v - EDGE_PX, 0.0)), math.floor(min(c.v + EDGE_PX, view.height - 1.0))
    left, right = max(left - EDGE_PX, 0.0), min(right + EDGE_PX, view.width - 1.0)
    if top > bottom or math.ceil(left) > math.floor(right):
        return
    area = (b.u - a.u) * (c.v - a.v) - (c.u - a.u) * (b.v - a.v)
    if abs(area) < 1e-12:
        return
    plane = Plane(
        a,
        ((b.inverse - a.inverse) * (c.v - a.v) - (c.inverse - a.inverse) * (b.v - a.v)) / area,
        ((c.inverse - a.inverse) * (b.u - a.u) - (b.inverse - a.inverse) * (c.u - a.u)) / area,
        min(a.inverse, b.inverse, c.inverse),
        max(a.inverse, b.inverse, c.inverse),
    )
    slopes = Slopes(
        (c.u - a.u) / (c.v - a.v),
        (b.u - a.u) / (b.v - a.v) if b.v > a.v else 0.0,
        (c.u - b.u) / (c.v - b.v) if c.v > b.v else 0.0,
    )
    for row in range(top, bottom + 1):
        one, two = _crossings(a, b, c, slopes, row)
        x0 = math.ceil(max(min(one, two) - EDGE_PX, left))
        x1 = math.floor(min(max(one, two) + EDGE_PX, right))
        if x0 <= x1:
            _fill_run(plane, row, x0, x1, canvas)


@njit(inline="always")
def _crossings(a, b, c, slopes, row):
    """The columns at which a row crosses the long edge of a triangle and one of the others, corners from the top."""
    v = min(max(float(row), a.v), c.v)
    one = a.u + (v - a.v) * slopes.long
    if v < b.v:
        two = a.u + (v - a.v) * slopes.upper
    elif v > b.v or c.v > b.v:
        two = b.u + (v - b.v) * slopes.lower
    else:
        two = b.u
    return one, two


@njit(inline="always")
def _fill_run(plane, row, x0, x1, canvas):
    """Draws the pixels from column x0 to x1 of a row."""
    canvas.first[row], canvas.last[row] = min(canvas.first[row], x0), max(canvas.last[row], x1)
    start = plane.top.inverse + plane.down * (row - plane.top.v) - plane.along * plane.top.u
    line = canvas.inverse[row]
    # unsigned indices and small numbers, or the compiler does one pixel at a time
    for n in range(x0, x1 + 1):
        x = np.uint64(n)
        value = np.float32(min(max(start + plane.along * np.float64(np.int32(n)), plane.least), plane.most))
        line[x] = max(line[x], value)


@njit(cache=True, nogil=True, error_model="numpy")
def to_kind(view, canvas):
    """Turns inverse planar depth into inverse depth of the camera's kind, where something was drawn."""
    if view.radial:
        for v in range(view.height):
            y = (v - view.cy) / view.fy
            for u in range(canvas.first[v], canvas.last[v] + 1):
                x = (u - view.cx) / view.fx
                canvas.inverse[v, u] /= radial_over_planar(x, y)
