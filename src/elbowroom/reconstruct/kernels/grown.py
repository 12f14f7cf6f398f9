"""Where 64 boxes, grown by what anything may have moved, lie in an image, and what tiles of its pixels settle of them.

In float32, for many boxes at once, and by more than that errs wider, or narrower, than `kernels.aged` works them out
for one: what these rectangles settle, that would say as well. A rectangle about a box's outline holds all pixels that
may meet it: are all free beyond it, the camera sees through. One inside it holds pixels whose rays run into the ball
about its middle: is any free no farther than into the ball, the camera does not.
"""

from typing import Any

import numpy as np
from numba import njit

from elbowroom.geometry.kernels.bits import lowest_bit, uncounted
from elbowroom.geometry.kernels.noise import in_float32, margin_at
from elbowroom.reconstruct.kernels.box import ALL, OUTSIDE, PLANE_EPS, SLOP_REL, bits_of, place_boxes
from elbowroom.reconstruct.kernels.outline import SPARE, half_edges
from elbowroom.reconstruct.kernels.place import VOXELS
from elbowroom.reconstruct.kernels.planes import NOTHING
from elbowroom.reconstruct.kernels.pyramid import least_of_tiles

INNER = (
    (np.float32(0.0), np.float32(0.7071), np.float32(0.7071)),
    (np.float32(0.7), np.float32(0.504), np.float32(0.504)),
    (np.float32(0.0), np.float32(0.95), np.float32(0.312)),
    (np.float32(0.0), np.float32(0.312), np.float32(0.95)),
)
"""Rectangles parallel to the image that lie in a ball of radius 1: how far behind its middle, half wide and high."""
RECTANGLES = 1 + len(INNER)
_SIDES = ("top", "bottom", "left", "right")
_BYTES = 64 * 4
_ROWS: Any = {
    "names": [*_SIDES, "limit", "u", "v", "z", "margin", "marks", "mark_words"],
    "formats": [("i4", (RECTANGLES, 64))] * 4
    + [("f4", (RECTANGLES, 64))]
    + [("f4", 64)] * 4
    + [("u1", (2, 64)), ("u8", (2, 8))],
    # the last two are the same bytes
    "offsets": [
        *range(0, 5 * RECTANGLES * _BYTES, RECTANGLES * _BYTES),
        *range(5 * RECTANGLES * _BYTES, (5 * RECTANGLES + 4) * _BYTES, _BYTES),
        (5 * RECTANGLES + 4) * _BYTES,
        (5 * RECTANGLES + 4) * _BYTES,
    ],
    "itemsize": (5 * RECTANGLES + 4) * _BYTES + 128,
}
GROWN = np.dtype((np.record, np.dtype(_ROWS)))
"""Scratch memory for 64 grown boxes, one in each lane.

top, bottom, left, right: rectangles of tiles, ends included, no farther than pixels are worked on: first one about the
box's outline, then those of `INNER`. limit: what is free from here on is free beyond the box; of `INNER`, what is free
no farther than below it is not [quanta]. u, v, z: the box's middle, from the principal point [px] and along the optical
axis [m]. margin: of depth, of a voxel where it lies, of a block none [m]. marks: whether the box is surely in view, and
whether it surely is not.
"""


@uncounted(cache=True, error_model="numpy")
def _place(camera, first, boxes, out):
    """Fills the scratch record.

    Args:
        camera: its record.
        first: box 0, as `kernels.box.place_boxes` gives it.
        boxes: all 64.
        out: written.
    """
    px, py, pz = first
    scale = boxes.scale
    (ax, ay, az), (bx, by, bz), (dx, dy, dz) = half_edges(camera, boxes.edge)
    reach_z, grown = abs(dx) + abs(dy) + abs(dz), np.float32(camera.aged_m)
    fx, fy, one, eps = (
        np.float32(camera.fx),
        np.float32(camera.fy),
        np.float32(1.0),
        np.float32(2.0 * PLANE_EPS),
    )
    per_fx, per_fy = one / fx, one / fy
    cx, cy, lateral = np.float32(camera.cx), np.float32(camera.cy), np.float32(camera.lateral_px)
    wide, spare, most, two = np.float32(0.5), SPARE, np.float32(1e6), np.int32(2)
    last_u, last_v = np.float32(camera.width - 1), np.float32(camera.height - 1)
    begin_v, end_v, begin_u, end_u = _ends(camera)
    for lane in range(64):
        x = px + camera.offset[scale, 0, lane]
        y = py + camera.offset[scale, 1, lane]
        z = pz + camera.offset[scale, 2, lane]
        near = z - reach_z - grown
        before = near > eps
        per_z, per_near = one / (z if z > eps else one), one / (near if before else one)
        # as of the ungrown box, whose nearest depth is greater
        per_box = one / (near + grown if before else one)
        u, v = x * per_z, y * per_z
        wide_u = (abs(ax - u * dx) + abs(ay - u * dy) + abs(az - u * dz)) * per_box
        wide_v = (abs(bx - v * dx) + abs(by - v * dy) + abs(bz - v * dz)) * per_box
        slope_u, slope_v = (abs(u) + wide_u) * per_fx, (abs(v) + wide_v) * per_fy
        wide_u += fx * grown * per_near * np.sqrt(one + slope_u * slope_u) + lateral + spare
        wide_v += fy * grown * per_near * np.sqrt(one + slope_v * slope_v) + lateral + spare
        lanes_u, lanes_v = u + cx, v + cy
        left, right, top, bottom = lanes_u - wide_u, lanes_u + wide_u, lanes_v - wide_v, lanes_v + wide_v
        whole = (left >= np.float32(0.0)) & (right <= last_u) & (top >= np.float32(0.0)) & (bottom <= last_v)
        out.top[0, lane] = max(np.int32(np.ceil(max(top - wide, -most))), begin_v) >> two
        out.bottom[0, lane] = min(np.int32(np.floor(min(bottom + wide, most))), end_v) >> two
        out.left[0, lane] = max(np.int32(np.ceil(max(left - wide, -most))), begin_u) >> two
        out.right[0, lane] = min(np.int32(np.floor(min(right + wide, most))), end_u) >> two
        # its outline holds a disc about its middle
        disc_u, disc_v = fx * grown * per_z + lateral - spare, fy * grown * per_z + lateral - spare
        reaches_out = (lanes_u < disc_u) | (lanes_v < disc_v)
        reaches_out |= (lanes_u > last_u - disc_u) | (lanes_v > last_v - disc_v)
        out.u[lane], out.v[lane], out.z[lane] = u, v, z
        out.marks[0, lane] = before & whole
        out.marks[1, lane] = (near < np.float32(0.0)) | (before & reaches_out)


@uncounted(cache=True, error_model="numpy")
def _depths(camera, boxes, out):
    """Row margin of the scratch record, and of limit the first."""
    (_, _, _), (_, _, _), (dx, dy, dz) = half_edges(camera, boxes.edge)
    grown, per_quantum = np.float32(camera.aged_m), np.float32(1.0 / camera.quantum)
    reach = abs(dx) + abs(dy) + abs(dz) + grown
    per_fx, per_fy = np.float32(1.0 / camera.fx), np.float32(1.0 / camera.fy)
    of_depth, radial = in_float32(camera.margin), camera.radial
    diagonal = np.float32(0.8660255 * boxes.edge) + grown
    keeps = np.float32(1.0 if boxes.scale == VOXELS else 0.0)
    most, three = np.float32(65535.0), np.float32(3.0)
    for lane in range(64):
        z = out.z[lane]
        far = z + reach
        if radial:
            x, y = out.u[lane] * per_fx, out.v[lane] * per_fy
            far = abs(z) * np.sqrt(np.float32(1.0) + x * x + y * y) + diagonal
        slop = abs(far) * SLOP_REL
        margin = margin_at(of_depth, far)
        out.margin[lane] = keeps * margin - slop
        clear = (far + margin + slop) * per_quantum + three
        out.limit[0, lane] = min(clear, most)


@njit(inline="always")
def _ends(camera):
    """First and last row, first and last column of the pixels that are worked on."""
    within = camera.within
    return np.int32(within[0]), np.int32(within[1] - 1), np.int32(within[2]), np.int32(within[3] - 1)


@uncounted(cache=True, error_model="numpy")
def _place_inner(camera, radius, out):
    """The rectangles of `INNER` of the scratch record: tiles that lie wholly in them.

    Args:
        camera: its record.
        radius: of the balls, float32 [m].
        out: with u, v, z and margin; written.
    """
    one, zero, most = np.float32(1.0), np.float32(0.0), np.float32(1e6)
    fx, fy, per_quantum = np.float32(camera.fx), np.float32(camera.fy), np.float32(1.0 / camera.quantum)
    per_fx, per_fy, cx, cy = one / fx, one / fy, np.float32(camera.cx), np.float32(camera.cy)
    begin_v, end_v, begin_u, end_u = _ends(camera)
    two, three, spare = np.int32(2), np.int32(3), SPARE
    nearest = max(radius, np.float32(2.0 * PLANE_EPS))
    radial = np.float32(1.0 if camera.radial else 0.0)
    for number in range(RECTANGLES - 1):
        behind, half_wide, half_high = INNER[number]
        row = number + 1
        for lane in range(64):
            z = out.z[lane]
            depth = z + behind * radius
            per_depth = one / (depth if z > nearest else one)
            across, down = half_wide * radius * per_depth * fx, half_high * radius * per_depth * fy
            u, v = out.u[lane] * z * per_depth, out.v[lane] * z * per_depth
            aside, above = max(abs(u) - across, zero) * per_fx, max(abs(v) - down, zero) * per_fy
            steep = np.sqrt(one + radial * (aside * aside + above * above))
            across, down, u, v = across - spare, down - spare, u + cx, v + cy
            top = max(np.int32(np.ceil(max(v - down, -most))), begin_v)
            bottom = min(np.int32(np.floor(min(v + down, most))), end_v)
            left = max(np.int32(np.ceil(max(u - across, -most))), begin_u)
            right = min(np.int32(np.floor(min(u + across, most))), end_u)
            out.top[row, lane] = (top + three) >> two
            out.bottom[row, lane] = ((bottom + np.int32(1)) >> two) - np.int32(1)
            out.left[row, lane] = (left + three) >> two
            out.right[row, lane] = ((right + np.int32(1)) >> two) - np.int32(1)
            limit = (depth * steep + out.margin[lane]) * per_quantum - np.float32(2.0)
            out.limit[row, lane] = limit if z > nearest else -one


@njit(inline="always")
def _least(camera, texels, grown, number, lane):
    """The least that pixels of one of a box's rectangles are free up to [quanta]; nothing is free of an empty one."""
    top, bottom = np.int64(grown.top[number, lane]), np.int64(grown.bottom[number, lane])
    left, right = np.int64(grown.left[number, lane]), np.int64(grown.right[number, lane])
    if top > bottom or left > right:
        return np.float32(-1.0)
    across = (camera.width + 3) >> 2
    both = least_of_tiles(texels.trust_squares, camera.first_tile, across, (top, bottom, left, right))
    return np.float32(both >> np.uint32(16))


@uncounted(cache=True, error_model="numpy", forceinline=True)
def _is_stopped(camera, texels, lane, grown):
    """Whether some pixel whose ray runs into the ball about the middle of a box is free no farther than into it."""
    for number in range(1, RECTANGLES):
        least = _least(camera, texels, grown, number, lane)
        if np.float32(0.0) <= least < grown.limit[number, lane]:
            return True
    return False


@uncounted(cache=True, error_model="numpy")
def look_grown(camera, texels, asked, boxes, grown):
    """Of 64 boxes grown by what anything may have moved: words of those that a camera surely sees through, and of
    those that it surely does not; of blocks, of none of whose voxels.

    Args:
        camera: its record.
        texels: of all cameras, with squares of trust.
        asked: which of them, a word.
        boxes: voxels, or blocks of four.
        grown: scratch.
    """
    first, state = place_boxes(camera, boxes)
    if state == OUTSIDE:
        return NOTHING, ALL
    _place(camera, first, boxes, grown)
    _depths(camera, boxes, grown)
    # the ball that lies in the grown voxel, or in each of the grown voxels of a block
    inner = 0.5 if boxes.scale == VOXELS else -0.525
    radius = np.float32(camera.aged_m + inner * boxes.edge)
    has_ball = radius > np.float32(0.0)
    if has_ball:
        _place_inner(camera, radius, grown)
    whole = bits_of(grown, 0)
    out = bits_of(grown, 1) if boxes.scale == VOXELS else NOTHING
    through, stopped, rest = NOTHING, out, asked & ~out
    while rest:
        lane = lowest_bit(rest)
        bit = np.uint64(1) << np.uint64(lane)
        rest &= ~bit
        if whole & bit and _least(camera, texels, grown, 0, lane) >= grown.limit[0, lane]:
            through |= bit
        elif has_ball and _is_stopped(camera, texels, lane, grown):
            stopped |= bit
    return through, stopped
