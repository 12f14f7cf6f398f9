"""Where the 64 voxels of a block lie in an image: rectangles of pixels about their outlines, and depths about them.

In float32, for many voxels at once, and by more than that errs wider than `kernels.pixel` works them out for one: what
these pixels settle, the pixel test would say as well.

A corner at (dx, dy, dz) from a voxel's middle (x, y, z) is seen (dx - u dz) / (z + dz) beside it, where u = x / z. So a
voxel reaches no farther than sum_a |dx_a - u dz_a| / (z - reach_z) to either side, over its three half edges a.
"""

import numpy as np
from numba import njit

from elbowroom.geometry.kernels.bits import lowest_bit, uncounted
from elbowroom.geometry.kernels.noise import in_float32, margin_at
from elbowroom.geometry.kernels.rigid import moved
from elbowroom.reconstruct.kernels.box import INSIDE, SLOP_PX, SLOP_REL, place_boxes
from elbowroom.reconstruct.kernels.cone import Pixel, has_left, misses, prepare, steepness
from elbowroom.reconstruct.kernels.pixel import (
    BLOCKED,
    DISPUTES,
    IS_BLIND,
    IS_SURFACE,
    THROUGH,
    add_answer,
    ask_pixel,
    depths_of,
    outline_of,
    pixels_within,
    settle_voxel,
)
from elbowroom.reconstruct.kernels.place import box_in
from elbowroom.reconstruct.kernels.rows import EIGHT, short_of, shorts_of, tellings_of
from elbowroom.reconstruct.kernels.texels import NO_RETURN, greatest_of

OUTLINES = np.dtype(
    (
        np.record,
        [(name, "i4", 64) for name in ("left", "right", "top", "bottom")]
        + [(name, "u4", 64) for name in ("clear_from", "hidden_to", "stopped_to")]
        + [(name, "f4", 64) for name in ("u", "v", "inner_u", "inner_v", "near", "far", "middle", "per_far")]
        + [("short", "u8", 9), ("tell", "u8", 9), ("row", "i8", 9), ("column", "i8", 9)],
    )
)
"""Scratch memory for 64 voxels, one in each lane.

left, right, top, bottom: pixels whose cones may meet it, ends included. clear_from: what is free from there on is free
beyond it; hidden_to: what is measured up to there is before it; stopped_to: what is free up to there and meets its
middle is not free beyond it [quanta]. u, v: the place of its middle; inner_u, inner_v: how far from there pixels surely
see it [px]. near, far, middle: its depth [m]. per_far: one by the depth of its farthest corner along the axis [1/m].

Of pieces of 8 x 8 pixels about one voxel: row and column of their first, those that are short of its far side, and
those of them that say anything of it.
"""
OPEN, STOPPED, IN_SURFACE = np.int64(0), np.int64(1), np.int64(2)
"""What is known of a voxel that is asked: nothing; that the camera does not see through; that it is a surface, so that
nothing but whether the camera sees through matters. Not literals: numba would compile it once for each."""
SEEN, NOTHING_SAID, UNKNOWN = 0, 1, 2
"""What the rectangle about a voxel says: all is free beyond it; not that, and no pixel says anything of it; neither."""
MOST_PIXELS = 24
"""Wider rectangles are left to the pixel test, which passes over tiles of pixels at once."""
MOST_OF_BLOCK = 48
"""Of blocks that cover more pixels either way each voxel is asked for itself."""
IN_EACH_ROW = np.uint64(0x0101010101010101)
"""Times the bits of one row, the same bits in each of eight."""
SPARE = np.float32(2.0) * SLOP_PX
"""By so much rectangles are wider [px]."""


@uncounted(cache=True, error_model="numpy")
def outlines(camera, first, edge, out):
    """Fills the outlines of the voxels of a block that lies wholly inside the image.

    Args:
        camera: its record.
        first: voxel 0, as `kernels.box.place_boxes` gives it.
        edge: of a voxel [m].
        out: a record of `OUTLINES`, written.
    """
    px, py, pz = first
    half = 0.5 * edge
    (ax, ay, az), (bx, by, bz), (dx, dy, dz) = half_edges(camera, edge)
    reach_z = abs(dx) + abs(dy) + abs(dz)
    cx, cy = np.float32(camera.cx), np.float32(camera.cy)
    wide = np.float32(0.5 + camera.lateral_px) + SPARE
    disc_u, disc_v = np.float32(half * camera.fx), np.float32(half * camera.fy)
    last_u, last_v = np.int32(camera.width - 1), np.int32(camera.height - 1)
    one = np.float32(1.0)
    for lane in range(64):
        x = px + camera.offset[0, 0, lane]
        y = py + camera.offset[0, 1, lane]
        z = pz + camera.offset[0, 2, lane]
        per_z, per_near = one / z, one / (z - reach_z)
        u, v = x * per_z, y * per_z
        wide_u = (abs(ax - u * dx) + abs(ay - u * dy) + abs(az - u * dz)) * per_near + wide
        wide_v = (abs(bx - v * dx) + abs(by - v * dy) + abs(bz - v * dz)) * per_near + wide
        u, v = u + cx, v + cy
        out.left[lane] = max(np.int32(np.ceil(u - wide_u)), np.int32(0))
        out.right[lane] = min(np.int32(np.floor(u + wide_u)), last_u)
        out.top[lane] = max(np.int32(np.ceil(v - wide_v)), np.int32(0))
        out.bottom[lane] = min(np.int32(np.floor(v + wide_v)), last_v)
        out.u[lane] = u
        out.v[lane] = v
        out.inner_u[lane] = disc_u * per_z
        out.inner_v[lane] = disc_v * per_z
        out.near[lane] = z - reach_z
        out.far[lane] = z + reach_z
        out.middle[lane] = z
        out.per_far[lane] = one / (z + reach_z)
    if camera.radial:
        _from_centre(camera, first, edge, out)
    _depths(camera, out)


@njit(inline="always")
def half_edges(camera, edge):
    """A voxel's three half edges along each axis of the camera, x times fx and y times fy, in float32."""
    m, half = camera.camera_from_world, 0.5 * edge
    x, y = half * camera.fx, half * camera.fy
    return (
        (np.float32(m[0, 0] * x), np.float32(m[0, 1] * x), np.float32(m[0, 2] * x)),
        (np.float32(m[1, 0] * y), np.float32(m[1, 1] * y), np.float32(m[1, 2] * y)),
        (np.float32(m[2, 0] * half), np.float32(m[2, 1] * half), np.float32(m[2, 2] * half)),
    )


@uncounted(cache=True, error_model="numpy")
def _from_centre(camera, first, edge, out):
    """Rows near, far and middle as distances from the camera's centre."""
    px, py, pz = first
    rfx, rfy = np.float32(1.0 / camera.fx), np.float32(1.0 / camera.fy)
    diagonal, half = np.float32(0.8660255 * edge), np.float32(0.5 * edge)
    for lane in range(64):
        x = (px + camera.offset[0, 0, lane]) * rfx
        y = (py + camera.offset[0, 1, lane]) * rfy
        z = pz + camera.offset[0, 2, lane]
        distance = np.sqrt(x * x + y * y + z * z)
        out.near[lane] = distance - diagonal
        out.far[lane] = distance + diagonal
        out.middle[lane] = distance - half


@uncounted(cache=True, error_model="numpy")
def _depths(camera, out):
    """Rows clear_from, hidden_to and stopped_to, from near, far and middle."""
    of_depth, per_quantum = in_float32(camera.margin), np.float32(1.0 / camera.quantum)
    most, zero, two, three = np.float32(65535.0), np.float32(0.0), np.float32(2.0), np.float32(3.0)
    for lane in range(64):
        far = out.far[lane]
        slop = abs(far) * SLOP_REL
        margin = margin_at(of_depth, far)
        # a quantum more than the pixel test allows for rounding
        clear = (far + margin + slop) * per_quantum + three
        hidden = (out.near[lane] - margin - slop) * per_quantum - three
        stopped = (out.middle[lane] + margin - slop) * per_quantum - two
        out.clear_from[lane] = np.uint32(np.int32(min(clear, most)))
        out.hidden_to[lane] = np.uint32(np.int32(min(max(hidden, zero), most)))
        out.stopped_to[lane] = np.uint32(np.int32(min(max(stopped, zero), most)))


@njit(inline="always")
def _run(begin, first, last):
    """Which of eight pixels of a row, from `begin` on, lie between two, ends included; bits of a byte."""
    first, last = max(first - begin, 0), min(last - begin, EIGHT - 1)
    ones = (np.uint64(2) << np.uint64(max(last - first, 0))) - np.uint64(1)
    return ones << np.uint64(first) if first <= last else np.uint64(0)


@uncounted(cache=True, error_model="numpy", forceinline=True)
def _is_stopped(camera, texels, block, lane):
    """Whether some pixel that surely meets a voxel is surely not free beyond it.

    A disc about the middle, parallel to the image, lies in the voxel: pixels beside its middle, above and below it.
    """
    u, v, stopped_to = block.u[lane], block.v[lane], block.stopped_to[lane]
    wide = np.float32(0.5 + camera.lateral_px) - SPARE
    across, down = wide + block.inner_u[lane], wide + block.inner_v[lane]
    top, bottom = np.int64(np.ceil(v - down)), np.int64(np.floor(v + down))
    for row in range(max(top, 0), min(bottom, camera.height - 1) + 1):
        reach = across if abs(np.float32(row) - v) <= wide else wide
        left, right = (
            max(np.int64(np.ceil(u - reach)), 0),
            min(np.int64(np.floor(u + reach)), camera.width - 1),
        )
        for column in range(left, right + 1, EIGHT):
            begin = min(column, camera.width - EIGHT)
            at = camera.first_texel + row * camera.width + begin
            if short_of(texels.trust_texels, at, stopped_to) & _run(begin, column, right):
                return True
    return False


@uncounted(cache=True, error_model="numpy", forceinline=True)
def _some_meet(camera, block, lane, edge, pixels):
    """Whether the widened cone of some pixels surely meets a voxel.

    Its half edges, seen from as far away as its farthest corner, span a hexagon that lies in its outline. That and a
    widened pixel have a point in common unless a line along a side of one of them parts them (separating axes).

    Args:
        camera: its record.
        block, lane: outlines of the voxels, and which of them.
        edge: of a voxel [m].
        pixels: a word of 8 x 8, and column and row of the first.
    """
    (ax, ay, az), (bx, by, bz), (dx, dy, dz) = half_edges(camera, edge)
    u, v, per_far = block.u[lane], block.v[lane], block.per_far[lane]
    x, y = u - np.float32(camera.cx), v - np.float32(camera.cy)
    au, av = (ax - x * dx) * per_far, (bx - y * dx) * per_far
    bu, bv = (ay - x * dy) * per_far, (by - y * dy) * per_far
    cu, cv = (az - x * dz) * per_far, (bz - y * dz) * per_far
    wide = np.float32(0.5 + camera.lateral_px) - SPARE
    # how far a pixel's middle may be from the voxel's along the normal of each side
    ab, ac, bc = abs(au * bv - av * bu), abs(au * cv - av * cu), abs(bu * cv - bv * cu)
    of_a, of_b, of_c = (
        ab + ac + wide * (abs(au) + abs(av)),
        ab + bc + wide * (abs(bu) + abs(bv)),
        ac + bc + wide * (abs(cu) + abs(cv)),
    )
    across, down = abs(au) + abs(bu) + abs(cu) + wide, abs(av) + abs(bv) + abs(cv) + wide
    rest, left, top = pixels
    while rest:
        n = lowest_bit(rest)
        rest &= rest - np.uint64(1)
        du, dv = np.float32(left + (n & 7)) - u, np.float32(top + (n >> 3)) - v
        if (
            (abs(du) <= across)
            & (abs(dv) <= down)
            & (abs(au * dv - av * du) <= of_a)
            & (abs(bu * dv - bv * du) <= of_b)
            & (abs(cu * dv - cv * du) <= of_c)
        ):
            return True
    return False


@uncounted(cache=True, error_model="numpy", forceinline=True)
def _settled(camera, texels, block, lane, edge, known):
    """What the rectangle about a voxel settles: SEEN, NOTHING_SAID, or UNKNOWN.

    Args:
        camera, texels: its record; those of all cameras.
        block: outlines of its voxels.
        lane: of the voxel.
        edge: of a voxel [m].
        known: OPEN, STOPPED or IN_SURFACE.
    """
    left, right = np.int64(block.left[lane]), np.int64(block.right[lane])
    top, bottom = np.int64(block.top[lane]), np.int64(block.bottom[lane])
    if right - left >= MOST_PIXELS or bottom - top >= MOST_PIXELS:
        return UNKNOWN
    clear_from, between = block.clear_from[lane], (block.clear_from[lane], block.hidden_to[lane])
    short, tell, width = np.uint64(0), np.uint64(0), camera.width
    for row in range(top, bottom + 1, EIGHT):
        last = bottom - row
        for column in range(left, right + 1, EIGHT):
            begin = min(column, width - EIGHT)
            at = camera.first_texel + row * width + begin
            columns = _run(begin, column, right) * IN_EACH_ROW
            if known != STOPPED:
                short |= shorts_of(texels.trust_texels, at, width, last, clear_from) & columns
            if known == IN_SURFACE:
                continue
            tell |= tellings_of(texels.doubt_texels, at, width, last, between) & columns
            if tell and (known == STOPPED or short):
                return UNKNOWN
    if known == STOPPED:
        return NOTHING_SAID
    if not short:
        return SEEN
    if right - left < EIGHT and bottom - top < EIGHT:
        # what is free no farther than before the voxel is not free beyond it, if it meets it at all
        begin, last = min(left, width - EIGHT), bottom - top
        at = camera.first_texel + top * width + begin
        before = shorts_of(texels.trust_texels, at, width, last, block.hidden_to[lane])
        before &= _run(begin, left, right) * _rows_to(last)
        if before:
            meets = _some_meet(camera, block, lane, edge, (before, begin, top))
            return NOTHING_SAID if meets else UNKNOWN
    return NOTHING_SAID if _is_stopped(camera, texels, block, lane) else UNKNOWN


@njit(inline="always")
def _rows_to(last):
    """The first bit of each of eight rows up to a number, ends included."""
    return IN_EACH_ROW >> np.uint64(8 * (EIGHT - 1 - min(last, EIGHT - 1)))


@uncounted(cache=True, error_model="numpy", forceinline=True)
def _pieces(camera, texels, pixels, depths, known, block):
    """Cuts a rectangle of at most 24 x 24 pixels into pieces of 8 x 8 and notes those with pixels short of a voxel.

    Args:
        camera, texels: its record; those of all cameras.
        pixels: the rectangle.
        depths: of the voxel along its rays.
        known: as of `_settled`.
        block: its fields short, tell, row and column are written.

    Returns:
        How many there are, and whether any pixel that is short says anything of the voxel; of one IN_SURFACE it is not
        asked.
    """
    many, tells, width = 0, np.uint64(0), camera.width
    between = depths.clear_from, depths.hidden_to
    for row in range(pixels.top, pixels.bottom + 1, EIGHT):
        last = pixels.bottom - row
        for column in range(pixels.left, pixels.right + 1, EIGHT):
            begin = min(column, width - EIGHT)
            at = camera.first_texel + row * width + begin
            # of rows past the last the texels of the last would be counted again
            own = _run(begin, column, pixels.right) * _rows_to(last)
            short = shorts_of(texels.trust_texels, at, width, last, depths.clear_from) & own
            if not short:
                continue
            tell = np.uint64(0)
            if known != IN_SURFACE:
                tell = tellings_of(texels.doubt_texels, at, width, last, between) & short
            tells |= tell
            block.short[many], block.tell[many] = short, tell
            block.row[many], block.column[many] = row, begin
            many += 1
    return many, tells != 0


@uncounted(cache=True, error_model="numpy", forceinline=True)
def _settle_few(camera, texels, box, known, scratch):
    """As `kernels.pixel.settle_voxel`, of a voxel wholly in view that at most 24 x 24 pixels may see: eight at once.

    Args:
        camera, texels, box: as there.
        known: as of `_settled`. Of one IN_SURFACE nothing is told but whether it is seen through.
        scratch: outlines and a voxel, records.
    """
    block, voxel = scratch
    m, half = camera.camera_from_world, 0.5 * box.edge
    middle = moved(m, box.x, box.y, box.z)
    reach_z = half * (abs(m[2, 0]) + abs(m[2, 1]) + abs(m[2, 2]))
    pixels = pixels_within(camera, outline_of(camera, middle, half))
    few = pixels.right - pixels.left < MOST_PIXELS and pixels.bottom - pixels.top < MOST_PIXELS
    if not few or not pixels.whole:
        return settle_voxel(camera, texels, box, voxel)
    depths = depths_of(camera, middle, box.edge, reach_z)
    many, some_tell = _pieces(camera, texels, pixels, depths, known, block)
    if not many:
        return THROUGH
    if known == STOPPED and not some_tell:
        return 0
    prepare(camera, box, voxel)
    if known == IN_SURFACE:
        return THROUGH if _are_all_free(camera, texels, depths, many, block, voxel) else 0
    answer = BLOCKED if known == STOPPED else 0
    # first those that may dispute, then those that may only keep it from being seen through
    for turn in range(2):
        for piece in range(many):
            if turn == 1 and answer & BLOCKED:
                break
            rest = block.tell[piece] if turn == 0 else block.short[piece] & ~block.tell[piece]
            answer = _ask_piece(camera, texels, depths, (rest, piece, turn == 1), answer, block, voxel)
            if answer & IS_SURFACE:
                return DISPUTES | IS_SURFACE
    return answer & ~BLOCKED if answer else THROUGH


@uncounted(cache=True, error_model="numpy", forceinline=True)
def _are_all_free(camera, texels, depths, many, block, voxel):
    """Whether all pixels of so many pieces that are short of a voxel and meet it are free beyond it all the same.

    Args:
        camera, texels, depths: as of `kernels.pixel.ask_pixel`.
        many, block: pieces, and how many.
        voxel: the scratch record, prepared.
    """
    for piece in range(many):
        rest = block.short[piece]
        while rest:
            n = lowest_bit(rest)
            rest &= rest - np.uint64(1)
            u, v = block.column[piece] + (n & 7), block.row[piece] + (n >> 3)
            if misses(voxel, u, v):
                continue
            texel = texels.trust_texels[camera.first_texel + v * camera.width + u]
            free_to = texel >> np.uint32(16)
            _, steep_far = steepness(camera, u, v)
            t = (free_to * camera.quantum - depths.margin) / steep_far
            if not has_left(camera, voxel, Pixel(u, v, free_to, texel), t):
                return False
    return True


@uncounted(cache=True, error_model="numpy", forceinline=True)
def _ask_piece(camera, texels, depths, asked, answer, block, voxel):
    """Adds to an answer what pixels of a piece say of a voxel, until one of them says all that matters.

    Args:
        camera, texels, depths: as of `kernels.pixel.ask_pixel`.
        asked: which pixels, a word; of which piece; whether BLOCKED is all that matters, which else is IS_SURFACE.
        answer: of other pixels, a sum.
        block: pieces.
        voxel: the scratch record, prepared.
    """
    rest, piece, until_blocked = asked
    while rest and not (until_blocked and answer & BLOCKED):
        n = lowest_bit(rest)
        rest &= rest - np.uint64(1)
        u, v = block.column[piece] + (n & 7), block.row[piece] + (n >> 3)
        at = camera.first_texel + v * camera.width + u
        measured = texels.doubt_texels[at]
        if answer & IS_BLIND and greatest_of(measured) == NO_RETURN:
            continue
        if misses(voxel, u, v):
            continue
        free_to = texels.trust_texels[at] >> np.uint32(16)
        answer |= ask_pixel(camera, texels, depths, voxel, Pixel(u, v, free_to, measured))
        if answer & IS_SURFACE:
            break
    return answer


@uncounted(cache=True, error_model="numpy")
def _is_silent(camera, texels, boxes):
    """Whether no pixel that may see any voxel of a block says anything of what lies as deep as the block.

    Then none of its voxels, all wholly in view, is disputed: their pixels are among these, their depths within its.
    """
    m, edge = camera.camera_from_world, 4.0 * boxes.edge
    aside = 1.5 * boxes.edge
    middle = moved(m, boxes.x + aside, boxes.y + aside, boxes.z + aside)
    u0, u1, v0, v1 = outline_of(camera, middle, 0.5 * edge)
    spare = np.float64(SPARE)
    pixels = pixels_within(camera, (u0 - spare, u1 + spare, v0 - spare, v1 + spare))
    if pixels.right - pixels.left >= MOST_OF_BLOCK or pixels.bottom - pixels.top >= MOST_OF_BLOCK:
        return False
    reach_z = 0.5 * edge * (abs(m[2, 0]) + abs(m[2, 1]) + abs(m[2, 2]))
    depths = depths_of(camera, middle, edge, reach_z)
    # a quantum more to both sides than of a voxel: rounding may go either way
    between = np.uint32(min(depths.clear_from + 1, 65535)), np.uint32(max(np.int64(depths.hidden_to) - 1, 0))
    for row in range(pixels.top, pixels.bottom + 1, EIGHT):
        for column in range(pixels.left, pixels.right + 1, EIGHT):
            begin = min(column, camera.width - EIGHT)
            at = camera.first_texel + row * camera.width + begin
            tell = tellings_of(texels.doubt_texels, at, camera.width, pixels.bottom - row, between)
            if tell & (_run(begin, column, pixels.right) * IN_EACH_ROW):
                return False
    return True


@uncounted(cache=True, error_model="numpy")
def settle_block(camera, texels, asked, stopped, boxes, scratch):
    """As `kernels.pixel.settle_word`, faster.

    Args:
        camera, texels, boxes: as there.
        asked: voxels that are asked, a word, and those of which nothing but whether they are seen through matters.
        stopped: whether it is known of all of them that the camera does not see through.
        scratch: outlines and a voxel, records.
    """
    answers = (np.uint64(0), np.uint64(0), np.uint64(0), np.uint64(0))
    first, state = place_boxes(camera, boxes)
    by_outlines = state == INSIDE and camera.width >= EIGHT
    lanes, voxel = scratch
    if by_outlines and stopped and _is_silent(camera, texels, boxes):
        return answers
    if by_outlines:
        outlines(camera, first, boxes.edge, lanes)
    rest, through = asked[0], np.uint64(0)
    while rest:
        lane = lowest_bit(rest)
        bit = np.uint64(1) << np.uint64(lane)
        rest &= ~bit
        if not by_outlines:
            answers = add_answer(answers, bit, settle_voxel(camera, texels, box_in(boxes, lane), voxel))
            continue
        known = STOPPED if stopped else (IN_SURFACE if asked[1] & bit else OPEN)
        says = _settled(camera, texels, lanes, lane, boxes.edge, known)
        if says == SEEN:
            through |= bit
        elif says == UNKNOWN:
            answer = _settle_few(camera, texels, box_in(boxes, lane), known, scratch)
            answers = add_answer(answers, bit, answer)
    return answers[0] | through, answers[1], answers[2], answers[3]
