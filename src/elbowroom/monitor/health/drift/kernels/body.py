"""Where the machine's surface should be in an image, and how far off it is seen: arrays and floats."""

import math
from typing import NamedTuple

import numpy as np
from numba import njit

from elbowroom.machine.kernels.draw import Mesh, draw

BEND_M = 0.004
"""A spot is flat if its neighbours' depths leave it by no more than this."""
LEAST_COSINE = 0.3


class Raw(NamedTuple):
    """The raw image beside the drawn one.

    image: flattened, float32 [m, the camera's kind]. pixel: (height, width) int64, place in `image` that sees the same;
    -1: none does. per_planar: (height, width), depth of the camera's kind per planar depth.
    """

    image: np.ndarray
    pixel: np.ndarray
    per_planar: np.ndarray


class Limits(NamedTuple):
    """Which returns count: the camera's range, and how far off something else begins [m]."""

    least: float
    greatest: float
    gate: float


@njit(cache=True, nogil=True)
def draw_links(mesh, camera_from_link, view, inverse, first, last, composite, shown):
    """Draws each link by itself, and keeps which of them is in front.

    Args:
        mesh: all links.
        camera_from_link: (links, 4, 4).
        view: the camera; depth is planar whatever its kind.
        inverse, first, last: an empty canvas, empty again afterwards.
        composite: (height, width) float32, written: inverse planar depth [1/m], 0 where nothing is.
        shown: (height, width) int16, written: the link, -1 where none is.
    """
    composite[:] = 0.0
    shown[:] = -1
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
        draw(one, camera_from_link[link : link + 1], view, inverse, first, last)
        for v in range(view.height):
            for u in range(first[v], last[v] + 1):
                if inverse[v, u] > composite[v, u]:
                    composite[v, u] = inverse[v, u]
                    shown[v, u] = link
                inverse[v, u] = 0.0
            first[v], last[v] = view.width, -1


@njit(cache=True, nogil=True)
def surface_spots(view, composite, shown, raw, limits, link_of, numbers):
    """Spots where a link is flat over 3 x 3 pixels, and how far from the model's surface the image shows one.

    Args:
        view, composite, shown: as of `draw_links`.
        raw: `Raw`.
        limits: `Limits`.
        link_of: (m,) int64, written.
        numbers: (m, 8), written: point and normal in the camera's frame, offset towards the camera along the normal,
            sigma [m].

    Returns:
        How many spots were written.
    """
    image, raw_pixel, per_planar = raw
    least, greatest, gate = limits
    n = 0
    # every other pixel of every other row: neighbours share what they are judged by
    for v in range(1, view.height - 1, 2):
        y = (v - view.cy) / view.fy
        for u in range(1, view.width - 1, 2):
            link = shown[v, u]
            if link < 0 or raw_pixel[v, u] < 0:
                continue
            alone = True
            for i in range(-1, 2):
                for j in range(-1, 2):
                    alone &= shown[v + i, u + j] == link
            if not alone:
                continue
            depth = float(image[raw_pixel[v, u]])
            if not (depth > 0.0 and depth >= least and depth <= greatest and depth < np.inf):
                continue
            w = composite[v, u]
            z = 1.0 / w
            bend_u = composite[v, u + 1] + composite[v, u - 1] - 2.0 * w
            bend_v = composite[v + 1, u] + composite[v - 1, u] - 2.0 * w
            if (abs(bend_u) + abs(bend_v)) * z * z > 2.0 * BEND_M:
                continue
            x = (u - view.cx) / view.fx
            along = 0.5 * (composite[v, u + 1] - composite[v, u - 1]) * view.fx
            down = 0.5 * (composite[v + 1, u] - composite[v - 1, u]) * view.fy
            at_axis = w - along * x - down * y
            length = math.sqrt(along * along + down * down + at_axis * at_axis)
            # per metre of planar depth: -(normal . (x, y, 1))
            scale = w / length
            if scale / math.sqrt(1.0 + x * x + y * y) < LEAST_COSINE:
                continue
            offset = (z - depth / per_planar[v, u]) * scale
            beyond = max(z - view.offset, 0.0)
            sigma = (view.constant + view.linear * z + view.quadratic * beyond * beyond) * scale
            if abs(offset) > gate + 3.0 * sigma:
                continue
            if n == link_of.size:
                return n
            link_of[n] = link
            numbers[n, 0], numbers[n, 1], numbers[n, 2] = x * z, y * z, z
            numbers[n, 3], numbers[n, 4], numbers[n, 5] = -along / length, -down / length, -at_axis / length
            numbers[n, 6], numbers[n, 7] = offset, sigma
            n += 1
    return n
