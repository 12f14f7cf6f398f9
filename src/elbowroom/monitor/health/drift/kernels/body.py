"""Where the machine's surface should be in an image, and how far off it is seen: arrays and floats."""

import math
from typing import NamedTuple

import numpy as np
from numba import njit

from elbowroom.geometry.kernels.bits import uncounted
from elbowroom.geometry.kernels.noise import sigma
from elbowroom.geometry.kernels.pinhole import radial_over_planar
from elbowroom.machine.kernels.draw import Mesh, draw

BEND_M = 0.004
"""A spot is flat if its neighbours' depths leave it by no more than this."""
LEAST_COSINE = 0.3
"""Of the angle between ray and normal; what is grazed more says little."""


class Shown(NamedTuple):
    """What should be seen of the machine.

    Fields:
        inverse: inverse planar depth of its surface, shape (height, width), float32 [1/m], 0 where nothing is.
        link: the link in front, shape (height, width), int16, -1 where none is.
    """

    inverse: np.ndarray
    link: np.ndarray


class Raw(NamedTuple):
    """Where a camera's raw image sees what a pinhole view does.

    Fields:
        pixel: place in the flattened image, shape (height, width), int64; -1: none.
        per_planar: depth of the camera's kind per planar depth, shape (height, width).
    """

    pixel: np.ndarray
    per_planar: np.ndarray


class Found(NamedTuple):
    """Spots of the machine's surface, at most m of them.

    Fields:
        link: shape (m,), int64.
        numbers: shape (m, 8): point and normal in the camera's frame, offset towards the camera along the normal,
            sigma [m].
    """

    link: np.ndarray
    numbers: np.ndarray


@njit(cache=True, nogil=True)
def draw_links(mesh, camera_from_links, view, canvas, shown):
    """Draws each link by itself, and keeps which of them is in front.

    Args:
        mesh: all links.
        camera_from_links: (links, 4, 4).
        view: the camera; depth is planar whatever its kind.
        canvas: empty, and empty again afterwards.
        shown: written.
    """
    shown.inverse[:] = 0.0
    shown.link[:] = -1
    for link in range(mesh.radius.size):
        one = Mesh(
            mesh.vertices,
            mesh.faces,
            mesh.vertex_start[link : link + 2],
            mesh.face_start[link : link + 2],
            mesh.centre[link : link + 1],
            mesh.radius[link : link + 1],
            mesh.closed[link : link + 1],
        )
        draw(one, camera_from_links[link : link + 1], view, canvas)
        _keep_nearer(canvas, link, shown)


@uncounted()
def _keep_nearer(canvas, link, shown):
    """Puts a link into what is shown, where it is nearer, and wipes the canvas."""
    width = canvas.inverse.shape[1]
    for v in range(canvas.first.size):
        for u in range(canvas.first[v], canvas.last[v] + 1):
            if canvas.inverse[v, u] > shown.inverse[v, u]:
                shown.inverse[v, u] = canvas.inverse[v, u]
                shown.link[v, u] = link
            canvas.inverse[v, u] = 0.0
        canvas.first[v], canvas.last[v] = width, -1


@njit(cache=True, nogil=True)
def surface_spots(view, shown, image, raw, gate, found):
    """Spots where a link is flat over 3 x 3 pixels, and how far from the model's surface the image shows one.

    Args:
        view: the camera that `shown` was drawn for.
        shown: as of `draw_links`.
        image: flattened, float32 [m, the camera's kind]; what is out of the view's range is no return.
        raw: which of its pixels see the same.
        gate: what is farther off is something else [m].
        found: written.

    Returns:
        How many spots were written.
    """
    inverse, link_of, numbers = shown.inverse, found.link, found.numbers
    n = 0
    # every other pixel of every other row: neighbours share what they are judged by
    for v in range(1, view.height - 1, 2):
        for u in range(1, view.width - 1, 2):
            pixel = raw.pixel[v, u]
            if pixel < 0 or not _is_one_link(shown.link, u, v):
                continue
            depth = float(image[pixel])
            if not (depth > 0.0 and depth >= view.min_depth and depth <= view.max_depth and depth < np.inf):
                continue
            if _bend(inverse, u, v) > 2.0 * BEND_M:
                continue
            z = 1.0 / inverse[v, u]
            x, y = (u - view.cx) / view.fx, (v - view.cy) / view.fy
            nx, ny, nz, scale = _normal(view, inverse, u, v, x, y)
            if scale / radial_over_planar(x, y) < LEAST_COSINE:
                continue
            offset, spread = (z - depth / raw.per_planar[v, u]) * scale, sigma(view, z) * scale
            if abs(offset) > gate + 3.0 * spread:
                continue
            if n == link_of.size:
                return n
            link_of[n] = shown.link[v, u]
            numbers[n, 0], numbers[n, 1], numbers[n, 2] = x * z, y * z, z
            numbers[n, 3], numbers[n, 4], numbers[n, 5] = nx, ny, nz
            numbers[n, 6], numbers[n, 7] = offset, spread
            n += 1
    return n


@uncounted()
def _is_one_link(link, u, v):
    """Whether a pixel and all eight about it show the same link."""
    alone = link[v, u] >= 0
    for i in range(-1, 2):
        for j in range(-1, 2):
            alone &= link[v + i, u + j] == link[v, u]
    return alone


@uncounted()
def _bend(inverse, u, v):
    """By how much depth leaves a plane from neighbour to neighbour, rows and columns together, twice over [m]."""
    w = inverse[v, u]
    z = 1.0 / w
    bend_u = inverse[v, u + 1] + inverse[v, u - 1] - 2.0 * w
    bend_v = inverse[v + 1, u] + inverse[v - 1, u] - 2.0 * w
    return (abs(bend_u) + abs(bend_v)) * z * z


@uncounted()
def _normal(view, inverse, u, v, x, y):
    """Normal of the surface in a pixel whose ray is (x, y, 1), towards the camera.

    Inverse depth is linear over a plane's image, its slopes are the normal's. Beside it how far the surface goes along
    its normal per metre of planar depth: -(normal . (x, y, 1)).
    """
    w = inverse[v, u]
    along = 0.5 * (inverse[v, u + 1] - inverse[v, u - 1]) * view.fx
    down = 0.5 * (inverse[v + 1, u] - inverse[v - 1, u]) * view.fy
    at_axis = w - along * x - down * y
    length = math.sqrt(along * along + down * down + at_axis * at_axis)
    return -along / length, -down / length, -at_axis / length, w / length
