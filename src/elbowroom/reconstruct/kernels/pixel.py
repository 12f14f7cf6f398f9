"""The exit test: one voxel against every pixel whose widened cone meets it (docs/architecture.md, "The pixel test").

What stands in inner loops is inlined by LLVM (`forceinline`): a call would cost more than the arithmetic.
"""

from typing import NamedTuple

import numpy as np
from numba import njit

from elbowroom.geometry.kernels.bits import lowest_bit, uncounted
from elbowroom.geometry.kernels.noise import margin_at
from elbowroom.geometry.kernels.rigid import moved
from elbowroom.reconstruct.kernels.box import PLANE_EPS
from elbowroom.reconstruct.kernels.cone import Pixel, has_left, misses, not_reached, prepare, steepness
from elbowroom.reconstruct.kernels.place import box_in
from elbowroom.reconstruct.kernels.texels import NEUTRAL, NO_RETURN, greatest_of

THROUGH, DISPUTES, IS_SURFACE, IS_BLIND, BLOCKED = 1, 2, 4, 8, 16
"""Answers. BLOCKED is said within this file alone: some pixel is not free beyond the voxel."""


class Pixels(NamedTuple):
    """The pixels whose widened cones may meet a voxel, ends included, and whether the voxel is all in view."""

    left: int
    right: int
    top: int
    bottom: int
    whole: bool


class Depths(NamedTuple):
    """Where a voxel lies along its rays: the margin of depth [m]; what is free from here on [quanta] is free beyond
    the voxel; what is measured up to there [quanta] is before it."""

    margin: float
    clear_from: np.uint32
    hidden_to: np.uint32


@njit(inline="always")
def _says_nothing(measured, depths):
    """Whether measured bounds lie wholly behind a voxel, or wholly before it, or are `NEUTRAL`: no dispute."""
    return measured >> np.uint32(16) >= depths.clear_from or greatest_of(measured) <= depths.hidden_to


@uncounted(cache=True)
def _bounds(texels, first, width, pixels):
    """Least and greatest depth over at least a rectangle of texels, in quanta; eight at a time.

    Rows of fewer than eight texels are not bounded.

    Args:
        texels: of all cameras.
        first, width: where this one's begin, and how many are in a row.
        pixels: the rectangle; of tiles, if the texels are tiles.
    """
    if width < 8:
        return np.uint32(0), np.uint32(NO_RETURN)
    mask = np.uint32(0xFFFF)
    least, low = NEUTRAL, mask
    u = min(pixels.left, width - 8)
    while True:
        for v in range(pixels.top, pixels.bottom + 1):
            at = first + v * width + u
            for n in range(8):
                least = min(least, texels[at + n])
                low = min(low, texels[at + n] & mask)
        if u + 7 >= pixels.right:
            break
        u = min(u + 8, width - 8)
    return least >> np.uint32(16), np.uint32(NO_RETURN) - low


@uncounted(cache=True, error_model="numpy", forceinline=True)
def outline_of(camera, middle, half):
    """Least and greatest column, least and greatest row of a voxel's corners; its middle in camera axes."""
    m = camera.camera_from_world
    px, py, pz = middle
    u0, u1, v0, v1 = 1e9, -1e9, 1e9, -1e9
    for corner in range(8):
        i = half if corner & 1 else -half
        j = half if corner & 2 else -half
        k = half if corner & 4 else -half
        qx = px + m[0, 0] * i + m[0, 1] * j + m[0, 2] * k
        qy = py + m[1, 0] * i + m[1, 1] * j + m[1, 2] * k
        qz = pz + m[2, 0] * i + m[2, 1] * j + m[2, 2] * k
        per_z = 1.0 / qz
        u, v = camera.fx * qx * per_z + camera.cx, camera.fy * qy * per_z + camera.cy
        u0, u1, v0, v1 = min(u0, u), max(u1, u), min(v0, v), max(v1, v)
    return u0, u1, v0, v1


@uncounted(cache=True, error_model="numpy", forceinline=True)
def pixels_within(camera, outline):
    """The pixels whose widened cones may meet what has this outline; none of them: left is beyond right."""
    u0, u1, v0, v1 = outline
    lateral = camera.lateral_px
    last_u, last_v, wide = camera.width - 1.0, camera.height - 1.0, 0.5 + lateral
    whole = (
        np.floor(u0 - lateral) >= 0.0
        and np.ceil(u1 + lateral) <= last_u
        and np.floor(v0 - lateral) >= 0.0
        and np.ceil(v1 + lateral) <= last_v
    )
    outside = u1 + wide < 0.0 or u0 - wide > last_u or v1 + wide < 0.0 or v0 - wide > last_v
    # far outside, numbers may be too great to be whole ones
    u0, u1, v0, v1 = (1.0, 0.0, 1.0, 0.0) if outside else (u0 - wide, u1 + wide, v0 - wide, v1 + wide)
    return Pixels(
        int(np.ceil(max(u0, 0.0))),
        int(np.floor(min(u1, last_u))),
        int(np.ceil(max(v0, 0.0))),
        int(np.floor(min(v1, last_v))),
        whole,
    )


@uncounted(cache=True, error_model="numpy", forceinline=True)
def depths_of(camera, middle, edge, reach_z):
    """Where a voxel lies along its rays.

    Args:
        camera: its record.
        middle: of the voxel, in the camera's axes [m].
        edge: of the voxel [m].
        reach_z: from its middle along the optical axis [m].
    """
    px, py, pz = middle
    near, far = pz - reach_z, pz + reach_z
    if camera.radial:
        distance = np.sqrt(px * px + py * py + pz * pz)
        near, far = distance - 0.8660255 * edge, distance + 0.8660255 * edge
    margin = margin_at(camera.margin, far)
    # two quanta: that by which texels are rounded, and one for the rounding here
    return Depths(
        margin,
        np.uint32(min((far + margin) / camera.quantum + 2.0, 65535.0)),
        np.uint32(max((near - margin) / camera.quantum - 2.0, 0.0)),
    )


@uncounted(cache=True, error_model="numpy", forceinline=True)
def bounds_about(camera, texels, pixels):
    """Least and greatest depth of what pixels free, in quanta: over all of them, or over the tiles that hold them."""
    if pixels.right - pixels.left < 8:
        return _bounds(texels.trust_texels, camera.first_texel, camera.width, pixels)
    tiles = Pixels(pixels.left >> 2, pixels.right >> 2, pixels.top >> 2, pixels.bottom >> 2, pixels.whole)
    return _bounds(texels.trust_tiles, camera.first_tile, (camera.width + 3) >> 2, tiles)


@uncounted(cache=True, forceinline=True)
def _is_before(texels, at, depths):
    """Whether a pixel sees something, be it the machine, that lies wholly before a voxel."""
    measured = texels.doubt_texels[at]
    greatest = greatest_of(texels.trust_texels[at] if measured == NEUTRAL else measured)
    return 0 < greatest <= depths.hidden_to


@uncounted(cache=True, forceinline=True)
def _is_between(camera, texels, depths, u, v):
    """Whether a pixel lies between two, on either side of it, that see something before a voxel; none at the edge."""
    if u < 1 or v < 1 or u > camera.width - 2 or v > camera.height - 2:
        return False
    at, across = camera.first_texel + v * camera.width + u, camera.width
    for step in (1, across - 1, across, across + 1):
        if _is_before(texels, at - step, depths) and _is_before(texels, at + step, depths):
            return True
    return False


@uncounted(cache=True)
def _is_alone(camera, texels, depths, pixel):
    """Whether nothing that a camera can resolve is seen of a voxel in a pixel, for what is seen about it.

    It lies between two that see something nearer, or none of the eight pixels about it says anything of the voxel
    either. None at the image's edge is alone.
    """
    if pixel.u < 1 or pixel.v < 1 or pixel.u > camera.width - 2 or pixel.v > camera.height - 2:
        return False
    if _is_between(camera, texels, depths, pixel.u, pixel.v):
        return True
    for v in range(pixel.v - 1, pixel.v + 2):
        for u in range(pixel.u - 1, pixel.u + 2):
            measured = texels.doubt_texels[camera.first_texel + v * camera.width + u]
            if (v != pixel.v or u != pixel.u) and not (
                _says_nothing(measured, depths) or _is_between(camera, texels, depths, u, v)
            ):
                return False
    return True


@uncounted(cache=True, error_model="numpy", forceinline=True)
def ask_pixel(camera, texels, depths, voxel, pixel):
    """What one pixel whose cone meets the voxel says of it: 0, or BLOCKED with what else it says.

    Where pixels fly, one alone disputes nothing.

    Args:
        camera, texels: its record; those of all cameras.
        depths: of the voxel along its rays.
        voxel: the scratch record, prepared.
        pixel: that is asked.
    """
    quantum, margin = camera.quantum, depths.margin
    steep_near, steep_far = steepness(camera, pixel.u, pixel.v)
    if has_left(camera, voxel, pixel, (pixel.free_to * quantum - margin) / steep_far):
        return 0
    if _says_nothing(pixel.measured, depths):
        return BLOCKED
    greatest = greatest_of(pixel.measured)
    if greatest == NO_RETURN:
        if camera.flies and _is_alone(camera, texels, depths, pixel):
            return BLOCKED
        return BLOCKED | DISPUTES | IS_BLIND
    least = pixel.measured >> np.uint32(16)
    if not_reached(camera, voxel, pixel, (greatest * quantum + margin) / steep_near):
        return BLOCKED
    if has_left(camera, voxel, pixel, (least * quantum - margin) / steep_far):
        return BLOCKED
    if camera.flies and _is_alone(camera, texels, depths, pixel):
        return BLOCKED
    return BLOCKED | DISPUTES | IS_SURFACE


@uncounted(cache=True, error_model="numpy", forceinline=True)
def _ask_pixels(camera, texels, pixels, depths, voxel):
    """What pixels say of a voxel one by one: a sum of answers; 0: all are free beyond it."""
    answer = 0
    across = (camera.width + 3) >> 2
    for tv in range(pixels.top >> 2, (pixels.bottom >> 2) + 1):
        for tu in range(pixels.left >> 2, (pixels.right >> 2) + 1):
            # 4 x 4 pixels at once, where none of them can add anything
            tile = camera.first_tile + tv * across + tu
            if texels.trust_tiles[tile] >> np.uint32(16) >= depths.clear_from:
                continue
            if answer & BLOCKED and _says_nothing(texels.doubt_tiles[tile], depths):
                continue
            for v in range(max(pixels.top, 4 * tv), min(pixels.bottom, 4 * tv + 3) + 1):
                row = camera.first_texel + v * camera.width
                for u in range(max(pixels.left, 4 * tu), min(pixels.right, 4 * tu + 3) + 1):
                    free_to = texels.trust_texels[row + u] >> np.uint32(16)
                    if free_to >= depths.clear_from:
                        continue
                    measured = texels.doubt_texels[row + u]
                    # one that can add nothing to what is known already
                    if answer & BLOCKED and (
                        _says_nothing(measured, depths)
                        or (answer & IS_BLIND and greatest_of(measured) == NO_RETURN)
                    ):
                        continue
                    if misses(voxel, u, v):
                        continue
                    answer |= ask_pixel(camera, texels, depths, voxel, Pixel(u, v, free_to, measured))
                    if answer & IS_SURFACE:
                        return BLOCKED | DISPUTES | IS_SURFACE
    return answer


@uncounted(cache=True, error_model="numpy")
def settle_voxel(camera, texels, box, voxel):
    """What a camera says of a voxel: a sum of THROUGH or DISPUTES, IS_SURFACE, IS_BLIND; or 0.

    Args:
        camera: its record.
        texels: of all cameras.
        box: the voxel.
        voxel: scratch.
    """
    m, half = camera.camera_from_world, 0.5 * box.edge
    middle = moved(m, box.x, box.y, box.z)
    reach_z = half * (abs(m[2, 0]) + abs(m[2, 1]) + abs(m[2, 2]))
    if middle[2] + reach_z <= 0.0:
        return 0
    if middle[2] - reach_z <= PLANE_EPS:
        return DISPUTES
    pixels = pixels_within(camera, outline_of(camera, middle, half))
    if pixels.left > pixels.right:
        return 0
    free = THROUGH if pixels.whole else 0
    # what bounds over all pixels settle: most voxels
    depths = depths_of(camera, middle, box.edge, reach_z)
    least, most = bounds_about(camera, texels, pixels)
    if least >= depths.clear_from:
        return free
    if most <= depths.hidden_to:
        return 0
    prepare(camera, box, voxel)
    answer = _ask_pixels(camera, texels, pixels, depths, voxel)
    return answer & ~BLOCKED if answer else free


@njit(inline="always")
def add_answer(answers, bit, answer):
    """Words (through, disputed, surface, blind) with what is said of one voxel added to them.

    Args:
        answers: the words.
        bit: of the voxel.
        answer: a sum, as of `settle_voxel`.
    """
    nothing = np.uint64(0)
    return (
        answers[0] | (bit if answer & THROUGH else nothing),
        answers[1] | (bit if answer & DISPUTES else nothing),
        answers[2] | (bit if answer & IS_SURFACE else nothing),
        answers[3] | (bit if answer & IS_BLIND else nothing),
    )


@uncounted(cache=True, error_model="numpy")
def settle_word(camera, texels, voxels, boxes, voxel):
    """What a camera says of the set voxels of a block: words (through, disputed, surface, blind).

    Args:
        camera, texels, voxel: as of `settle_voxel`.
        voxels: those that are asked, a word.
        boxes: all voxels of the block.
    """
    answers, rest = (np.uint64(0), np.uint64(0), np.uint64(0), np.uint64(0)), voxels
    while rest:
        lane = lowest_bit(rest)
        bit = np.uint64(1) << np.uint64(lane)
        rest &= ~bit
        answers = add_answer(answers, bit, settle_voxel(camera, texels, box_in(boxes, lane), voxel))
    return answers
