"""One look of a camera at the 64 children of a cube: through, unsure, and what is known of those that are unsure."""

from typing import NamedTuple

import numpy as np
from numba import njit

from elbowroom.geometry.kernels.bits import lowest_bit, uncounted
from elbowroom.reconstruct.kernels.box import (
    CROSSING,
    INSIDE,
    OUTSIDE,
    bits_of,
    bound_inside,
    bound_partly,
    decide_inside,
    decide_partly,
    look_up,
    place_boxes,
)
from elbowroom.reconstruct.kernels.planes import NOTHING
from elbowroom.reconstruct.kernels.pyramid import least_of_tiles
from elbowroom.reconstruct.kernels.texels import NEUTRAL, NO_RETURN

ROUNDING_M = 2e-5
"""More than float32 can err in the depth of a voxel [m]."""


class Look(NamedTuple):
    """What a camera says of 64 boxes: words of those that it sees through and of those that it is unsure of, whether
    their cube lies partly outside the image, and how many pixels a box reaches to every side of its centre pixel.
    """

    through: np.uint64
    unsure: np.uint64
    partly: bool
    reach: int


@uncounted(cache=True)
def ask(camera, windows, boxes, keep_partly, lanes):
    """Looks at the 64 children of a cube.

    Args:
        camera, windows: its record, and the windows of all.
        boxes: the children.
        keep_partly: whether the camera is unsure, too, of a box that it sees through as far as that is in view.
        lanes: scratch; `measured_at_centre`, `sort_out` and `contested` go on from it.
    """
    through, unsure, reach = NOTHING, NOTHING, 0
    first, state = place_boxes(camera, boxes)
    if state == INSIDE:
        reach = bound_inside(camera, boxes.scale, first, lanes)
        look_up(windows, camera.quantum, lanes)
        through, unsure = decide_inside(lanes)
    elif state != OUTSIDE:
        reach = bound_partly(camera, boxes.scale, first, lanes)
        look_up(windows, camera.quantum, lanes)
        through, unsure, cut = decide_partly(lanes)
        if keep_partly:
            unsure |= cut
    return Look(through, unsure, state != INSIDE and state != OUTSIDE, reach)


@uncounted(cache=True)
def _may_be_measured(camera, doubt_tiles, lanes):
    """The boxes between whose depth bounds something may be measured in the tile of their centre's pixel.

    Tiles stay in the cache, pixels do not: this saves most looks at single pixels.
    """
    across = (np.int32(camera.width) + np.int32(3)) >> np.int32(2)
    tiles = doubt_tiles[camera.first_tile :]
    for lane in range(64):
        row, column = np.int32(lanes.v[lane]), np.int32(lanes.u[lane])
        lanes.texel[lane] = (row >> np.int32(2)) * across + (column >> np.int32(2))
    for lane in range(64):
        tile = tiles[np.uint32(lanes.texel[lane])]
        lanes.least_quanta[lane] = np.int32(tile >> np.uint32(16))
        lanes.greatest_quanta[lane] = np.int32(NO_RETURN) - np.int32(tile & np.uint32(0xFFFF))
    # a quantum is a power of two, so these products are exact
    quantum = np.float32(camera.quantum)
    for lane in range(64):
        least = np.float32(lanes.least_quanta[lane]) * quantum
        greatest = np.float32(lanes.greatest_quanta[lane]) * quantum
        beyond_all = (greatest < lanes.near[lane]) & (lanes.greatest_quanta[lane] != np.int32(NO_RETURN))
        lanes.marks[0, lane] = (not beyond_all) & (least <= lanes.far[lane])
        lanes.marks[1, lane] = lanes.greatest[lane] == np.float32(np.inf)
        lanes.marks[2, lane] = lanes.state[lane] != CROSSING
    return bits_of(lanes, 0), bits_of(lanes, 1), bits_of(lanes, 2)


@njit(inline="always")
def _centre_pixel(camera, lanes, lane):
    """Where the texel of the pixel lies that a lane's centre projects to."""
    return camera.first_texel + int(lanes.v[lane]) * camera.width + int(lanes.u[lane])


@uncounted(cache=True)
def measured_at_centre(camera, texels, look, known, lanes):
    """Which unsure boxes hold the measured point of their centre's pixel, and which have pixels without a return.

    Of `known` boxes it need not be told whether they are a surface.
    """
    surface, unsure = NOTHING, look.unsure
    quantum = camera.quantum
    rest, lost, in_front = _may_be_measured(camera, texels.doubt_tiles, lanes)
    if look.partly:
        unsure &= in_front
    rest &= unsure & ~known
    # without branches, so that the looks of many lanes are under way at once
    while rest:
        lane = lowest_bit(rest)
        rest &= rest - np.uint64(1)
        texel = texels.doubt_texels[_centre_pixel(camera, lanes, lane)]
        greatest = np.uint32(NO_RETURN) - (texel & np.uint32(0xFFFF))
        depth = greatest * quantum
        holds = (lanes.near[lane] <= depth) & (depth <= lanes.far[lane])
        holds &= (texel != NEUTRAL) & (greatest != np.uint32(NO_RETURN))
        surface |= np.uint64(holds) << np.uint64(lane)
    return surface, lost & unsure


@uncounted(cache=True)
def sort_out(camera, texels, edge, unsure, lanes):
    """What one look at the middle pixel settles of unsure voxels: words (surely a surface, surely not through).

    The ray through a voxel's centre lies in the cone of the pixel that the centre projects to, and runs inside the
    voxel for at least half an edge to both sides of it. So a return there makes the pixel test say *surface*, and one
    before the centre keeps it from saying *through*, whatever the other pixels hold. All voxels lie wholly in view.
    """
    quantum = np.float32(camera.quantum)
    # how far the near and far bounds lie from the centre, and how far at least the ray runs inside
    extent = np.float32(camera.half_diagonal[0] if camera.radial else camera.half_extent[0, 2])
    inner = np.float32(0.5 * edge * (1.0 if camera.radial else camera.least_cosine))
    rounding, half, width = np.float32(2.0 * ROUNDING_M), np.float32(0.5), np.int32(camera.width)
    trust, doubt = texels.trust_texels[camera.first_texel :], texels.doubt_texels[camera.first_texel :]
    for lane in range(64):
        lanes.texel[lane] = np.int32(lanes.v[lane]) * width + np.int32(lanes.u[lane])
    for lane in range(64):
        pixel = np.uint32(lanes.texel[lane])
        lanes.least_quanta[lane] = np.int32(trust[pixel] >> np.uint32(16))
        # of `NEUTRAL` it is 0
        lanes.greatest_quanta[lane] = np.int32(NO_RETURN) - np.int32(doubt[pixel] & np.uint32(0xFFFF))
    for lane in range(64):
        near, far = lanes.near[lane], lanes.far[lane]
        at, margin = half * (near + far), half * (far - near) - extent - rounding
        greatest = lanes.greatest_quanta[lane]
        off = abs(np.float32(greatest) * quantum - at)
        lanes.marks[0, lane] = np.float32(lanes.least_quanta[lane]) * quantum < at + margin - rounding
        lanes.marks[1, lane] = (
            (greatest != np.int32(0)) & (greatest != np.int32(NO_RETURN)) & (off < inner + margin - rounding)
        )
    stopped = bits_of(lanes, 0) & unsure
    surface = bits_of(lanes, 1) & stopped
    rest = surface if camera.flies else NOTHING
    while rest:
        lane = lowest_bit(rest)
        bit = np.uint64(1) << np.uint64(lane)
        rest &= ~bit
        near, far = np.float64(lanes.near[lane]), np.float64(lanes.far[lane])
        reach = inner + 0.5 * (far - near) - extent - 2.0 * ROUNDING_M
        if _may_be_alone(camera, texels, lanes, lane, 0.5 * (near + far), reach):
            surface &= ~bit
    return surface, stopped


@uncounted(cache=True)
def _may_be_alone(camera, texels, lanes, lane, at, reach):
    """Whether the middle pixel of a voxel may be one that disputes nothing (`pixel._is_alone`).

    Surely not, if no pixel about it sees anything before the voxel, and one beside it something in it, or nothing.

    Args:
        camera, texels, lanes, lane: as of `sort_out`.
        at, reach: depth of the voxel's centre, and what lies so near to it is surely in it [m].
    """
    u, v = int(lanes.u[lane]), int(lanes.v[lane])
    if u < 1 or v < 1 or u > camera.width - 2 or v > camera.height - 2:
        return True
    near = np.float64(lanes.near[lane]) + ROUNDING_M
    alone = True
    for row in range(v - 1, v + 2):
        for column in range(u - 1, u + 2):
            texel = texels.doubt_texels[camera.first_texel + row * camera.width + column]
            greatest = np.uint32(NO_RETURN) - (texel & np.uint32(0xFFFF))
            depth = greatest * camera.quantum
            if texel == NEUTRAL or depth <= near:
                return True
            if (row == v) != (column == u) and (greatest == NO_RETURN or abs(depth - at) < reach):
                alone = False
    return alone


@uncounted(cache=True)
def contested(camera, texels, asked, look, lanes):
    """Of the boxes that are asked those that unexplained pixels dispute.

    Looked at are all tiles that hold a pixel within `look.reach` of a box's centre pixel.
    """
    disputed, reach = NOTHING, look.reach
    width, height = camera.width, camera.height
    across = (width + 3) >> 2
    quantum = np.float32(camera.quantum)
    rest = asked
    while rest:
        lane = lowest_bit(rest)
        bit = np.uint64(1) << np.uint64(lane)
        rest &= ~bit
        if look.partly and lanes.state[lane] == CROSSING:
            disputed |= bit
            continue
        u, v = int(lanes.u[lane]), int(lanes.v[lane])
        left, right = max(u - reach, 0) >> 2, min(u + reach, width - 1) >> 2
        top, bottom = max(v - reach, 0) >> 2, min(v + reach, height - 1) >> 2
        rectangle = top, bottom, left, right
        both = least_of_tiles(texels.doubt_squares, camera.first_tile, across, rectangle)
        greatest = np.uint32(NO_RETURN) - (both & np.uint32(0xFFFF))
        past = np.float32(both >> np.uint32(16)) * quantum > lanes.far[lane]
        hidden = greatest < NO_RETURN and np.float32(greatest) * quantum < lanes.near[lane]
        if not (past or hidden):
            disputed |= bit
    return disputed
