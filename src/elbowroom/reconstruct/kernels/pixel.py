"""The exit test: one voxel against every pixel whose widened cone meets it (docs/architecture.md, "The pixel test").

A pixel's cone holds the directions (x, y, 1) with u within 0.5 + lateral of its centre. Along grid axis a such a
direction moves by d_a(u, v), linear in u and v. With the voxel's faces at low_a and high_a from the camera's centre,
the cone has left the voxel at depth t once t * d_a is beyond the far face for some axis, has not reached it while
t * d_a is before the near face for some axis, and misses it if it passes a silhouette edge on the outer side.
"""

import numpy as np
from numba import njit
from numba.cpython.unsafe.numbers import trailing_zeros

from elbowroom.geometry.kernels.bits import uncounted
from elbowroom.reconstruct.kernels.box import (
    CENTRE,
    LATERAL,
    LENS,
    MARGIN,
    PLANE_EPS,
    QUANTUM,
    RADIAL,
    SIZE,
    TURN,
)
from elbowroom.reconstruct.kernels.pyramid import NEUTRAL, NO_RETURN

THROUGH, DISPUTES, IS_SURFACE, IS_BLIND = 1, 2, 4, 8
PIXEL_FLOATS = 64
# rows of the scratch array: d_a = D0 + D1 u + D2 v, its half width, faces; then silhouette lines
D0, D1, D2, DW, LOW, HIGH, LINES = 0, 3, 6, 9, 12, 15, 18


@uncounted(cache=True, error_model="numpy")
def _silhouette(b, c, s, count):
    """Adds the two lines that bound the voxel as seen along the third axis; none if the camera is within its shadow.

    In the plane of axes b and c the voxel is a rectangle; the directions that meet it lie between two of its corners.
    """
    low_b, high_b, low_c, high_c = s[LOW + b], s[HIGH + b], s[LOW + c], s[HIGH + c]
    if low_b <= 0.0 <= high_b and low_c <= 0.0 <= high_c:
        return count
    # the extreme corners, counter-clockwise from `first` to `second` as seen from the origin
    if low_b > 0.0:
        first_b, first_c = (high_b, low_c) if low_c > 0.0 else (low_b, low_c)
        second_b, second_c = (high_b, high_c) if high_c < 0.0 else (low_b, high_c)
    elif high_b < 0.0:
        first_b, first_c = (low_b, high_c) if high_c < 0.0 else (high_b, high_c)
        second_b, second_c = (low_b, low_c) if low_c > 0.0 else (high_b, low_c)
    elif low_c > 0.0:
        first_b, first_c, second_b, second_c = high_b, low_c, low_b, low_c
    else:
        first_b, first_c, second_b, second_c = low_b, high_c, high_b, high_c
    for corner in range(2):
        # inside where cross(first, d) >= 0 and cross(d, second) >= 0
        pb = first_b if corner == 0 else -second_b
        pc = first_c if corner == 0 else -second_c
        for row in range(3):
            s[LINES + 4 * count + row] = pb * s[3 * row + c] - pc * s[3 * row + b]
        count += 1
    return count


@uncounted(cache=True, error_model="numpy")
def _prepare(numbers, c, x, y, z, edge, s):
    """Fills the scratch array for one voxel and camera; returns the number of silhouette lines."""
    half = 0.5 * edge
    wide = 0.5 + numbers[c, LATERAL]
    for n in range(12):
        s[n] = numbers[c, TURN + n]
    for a in range(3):
        middle = (x if a == 0 else (y if a == 1 else z)) - numbers[c, CENTRE + a]
        s[LOW + a] = middle - half
        s[HIGH + a] = middle + half
    # not literals: numba would compile it once for each of them
    first, second, third = np.int64(0), np.int64(1), np.int64(2)
    count = _silhouette(first, second, s, first)
    count = _silhouette(second, third, s, count)
    count = _silhouette(third, first, s, count)
    for line in range(count):
        at = LINES + 4 * line
        s[at + 3] = (abs(s[at + 1]) + abs(s[at + 2])) * wide
    return count


@njit(cache=True, nogil=True, forceinline=True)
def _misses(s, count, u, v):
    for line in range(count):
        at = LINES + 4 * line
        if s[at] + s[at + 1] * u + s[at + 2] * v + s[at + 3] < 0.0:
            return True
    return False


@njit(cache=True, nogil=True, forceinline=True)
def _has_left(s, u, v, t):
    """Whether all of the pixel's cone is beyond the voxel from depth t on."""
    for a in range(3):
        d = s[D0 + a] + s[D1 + a] * u + s[D2 + a] * v
        low, high = d - s[DW + a], d + s[DW + a]
        if low >= 0.0 and t * low > s[HIGH + a]:
            return True
        if high <= 0.0 and t * high < s[LOW + a]:
            return True
    return False


@njit(cache=True, nogil=True, forceinline=True)
def _not_reached(s, u, v, t):
    """Whether no part of the pixel's cone has reached the voxel up to depth t."""
    for a in range(3):
        d = s[D0 + a] + s[D1 + a] * u + s[D2 + a] * v
        if max(t * (d + s[DW + a]), 0.0) < s[LOW + a]:
            return True
        if min(t * (d - s[DW + a]), 0.0) > s[HIGH + a]:
            return True
    return False


@njit(cache=True, nogil=True, inline="always")
def _says_nothing(doubtful, clear_from, hidden_to):
    """Whether measured bounds lie wholly behind a voxel, or wholly before it, or are `NEUTRAL`: no dispute."""
    return (
        doubtful >> np.uint32(16) >= clear_from
        or np.uint32(NO_RETURN) - (doubtful & np.uint32(0xFFFF)) <= hidden_to
    )


@uncounted(cache=True)
def _bounds(texels, first, width, ua, ub, va, vb):
    """Least and greatest depth over at least a rectangle of texels, ends included, in quanta; eight at a time.

    Rows of fewer than eight texels are not bounded.
    """
    if width < 8:
        return np.uint32(0), np.uint32(NO_RETURN)
    mask = np.uint32(0xFFFF)
    least, low = NEUTRAL, mask
    u = min(ua, width - 8)
    while True:
        for v in range(va, vb + 1):
            at = first + v * width + u
            for n in range(8):
                least = min(least, texels[at + n])
                low = min(low, texels[at + n] & mask)
        if u + 7 >= ub:
            break
        u = min(u + 8, width - 8)
    return least >> np.uint32(16), np.uint32(NO_RETURN) - low


@uncounted(cache=True, error_model="numpy")
def settle_voxel(numbers, c, trust, doubt, first, trust_tiles, doubt_tiles, tile_first, x, y, z, edge, s):
    """What camera c says of the voxel around (x, y, z): a sum of THROUGH or DISPUTES, IS_SURFACE, IS_BLIND; or 0.

    `first` and `tile_first` are where the camera's pixels and tiles begin; `s` is a scratch array of PIXEL_FLOATS.
    """
    width, height = int(numbers[c, SIZE]), int(numbers[c, SIZE + 1])
    tiles_across = (width + 3) >> 2
    fx, fy = numbers[c, LENS], numbers[c, LENS + 1]
    ox, oy = numbers[c, LENS + 2], numbers[c, LENS + 3]
    lateral = numbers[c, LATERAL]
    half = 0.5 * edge
    px = numbers[c, 0] * x + numbers[c, 1] * y + numbers[c, 2] * z + numbers[c, 3]
    py = numbers[c, 4] * x + numbers[c, 5] * y + numbers[c, 6] * z + numbers[c, 7]
    pz = numbers[c, 8] * x + numbers[c, 9] * y + numbers[c, 10] * z + numbers[c, 11]
    reach_z = half * (abs(numbers[c, 8]) + abs(numbers[c, 9]) + abs(numbers[c, 10]))
    near, far = pz - reach_z, pz + reach_z
    if far <= 0.0:
        return 0
    if near <= PLANE_EPS:
        return DISPUTES
    u0, u1, v0, v1 = 1e9, -1e9, 1e9, -1e9
    for corner in range(8):
        i = half if corner & 1 else -half
        j = half if corner & 2 else -half
        k = half if corner & 4 else -half
        qx = px + numbers[c, 0] * i + numbers[c, 1] * j + numbers[c, 2] * k
        qy = py + numbers[c, 4] * i + numbers[c, 5] * j + numbers[c, 6] * k
        qz = pz + numbers[c, 8] * i + numbers[c, 9] * j + numbers[c, 10] * k
        per_z = 1.0 / qz
        u, v = fx * qx * per_z + ox, fy * qy * per_z + oy
        u0, u1, v0, v1 = min(u0, u), max(u1, u), min(v0, v), max(v1, v)
    wide = 0.5 + lateral
    whole = (
        np.floor(u0 - lateral) >= 0.0
        and np.ceil(u1 + lateral) <= width - 1.0
        and np.floor(v0 - lateral) >= 0.0
        and np.ceil(v1 + lateral) <= height - 1.0
    )
    if u1 + wide < 0.0 or u0 - wide > width - 1.0 or v1 + wide < 0.0 or v0 - wide > height - 1.0:
        return 0
    ua, ub = int(np.ceil(max(u0 - wide, 0.0))), int(np.floor(min(u1 + wide, width - 1.0)))
    va, vb = int(np.ceil(max(v0 - wide, 0.0))), int(np.floor(min(v1 + wide, height - 1.0)))
    radial = numbers[c, RADIAL] != 0.0
    if radial:
        distance = np.sqrt(px * px + py * py + pz * pz)
        near, far = distance - 0.8660255 * edge, distance + 0.8660255 * edge
    beyond = max(far - numbers[c, MARGIN + 4], 0.0)
    margin = (
        numbers[c, MARGIN]
        + far * (numbers[c, MARGIN + 1] + far * numbers[c, MARGIN + 2])
        + numbers[c, MARGIN + 3] * beyond * beyond
    )
    quantum = numbers[c, QUANTUM]
    clear_from = np.uint32(min((far + margin) / quantum + 2.0, 65535.0))
    hidden_to = np.uint32(max((near - margin) / quantum - 2.0, 0.0))
    if ub - ua < 8:
        least, most = _bounds(trust, first, width, ua, ub, va, vb)
    else:
        least, most = _bounds(trust_tiles, tile_first, tiles_across, ua >> 2, ub >> 2, va >> 2, vb >> 2)
    if least >= clear_from:
        return THROUGH if whole else 0
    if most <= hidden_to:
        return 0
    lines = _prepare(numbers, c, x, y, z, edge, s)
    blocked = False
    answer = 0
    for tv in range(va >> 2, (vb >> 2) + 1):
        for tu in range(ua >> 2, (ub >> 2) + 1):
            # 4 x 4 pixels at once, where none of them can add anything
            tile = tile_first + tv * tiles_across + tu
            if trust_tiles[tile] >> np.uint32(16) >= clear_from:
                continue
            if blocked and _says_nothing(doubt_tiles[tile], clear_from, hidden_to):
                continue
            for v in range(max(va, 4 * tv), min(vb, 4 * tv + 3) + 1):
                row = first + v * width
                for u in range(max(ua, 4 * tu), min(ub, 4 * tu + 3) + 1):
                    trusted = trust[row + u] >> np.uint32(16)
                    if trusted >= clear_from:
                        continue
                    doubtful = doubt[row + u]
                    greatest = np.uint32(NO_RETURN) - (doubtful & np.uint32(0xFFFF))
                    if blocked and (
                        _says_nothing(doubtful, clear_from, hidden_to)
                        or (answer & IS_BLIND and greatest == NO_RETURN)
                    ):
                        continue  # it can add nothing to what is known already
                    if _misses(s, lines, u, v):
                        continue
                    steep_near, steep_far = 1.0, 1.0
                    if radial:
                        # of the directions in the cone, the least and the greatest ratio of radial to planar depth
                        xn, yn = abs(u - ox) / fx, abs(v - oy) / fy
                        wx, wy = wide / fx, wide / fy
                        steep_far = np.sqrt(1.0 + (xn + wx) * (xn + wx) + (yn + wy) * (yn + wy))
                        xl, yl = max(xn - wx, 0.0), max(yn - wy, 0.0)
                        steep_near = np.sqrt(1.0 + xl * xl + yl * yl)
                    if _has_left(s, u, v, (trusted * quantum - margin) / steep_far):
                        continue
                    blocked = True
                    if _says_nothing(doubtful, clear_from, hidden_to):
                        continue
                    if greatest == NO_RETURN:
                        answer |= DISPUTES | IS_BLIND
                        continue
                    least = doubtful >> np.uint32(16)
                    if _not_reached(s, u, v, (greatest * quantum + margin) / steep_near):
                        continue
                    if _has_left(s, u, v, (least * quantum - margin) / steep_far):
                        continue
                    return DISPUTES | IS_SURFACE
    if not blocked:
        return THROUGH if whole else 0
    return answer


@uncounted(cache=True, error_model="numpy")
def settle_word(
    numbers, c, trust, doubt, first, trust_tiles, doubt_tiles, tile_first, voxels, x, y, z, edge, s
):
    """What camera c says of the set voxels of a block: words (through, disputed, surface, blind).

    (x, y, z) is the centre of the block's voxel (0, 0, 0), `s` a scratch array of PIXEL_FLOATS.
    """
    through, disputed, surface, blind = np.uint64(0), np.uint64(0), np.uint64(0), np.uint64(0)
    rest = voxels
    while rest:
        lane = np.int64(trailing_zeros(rest))
        bit = np.uint64(1) << np.uint64(lane)
        rest &= ~bit
        answer = settle_voxel(
            numbers,
            c,
            trust,
            doubt,
            first,
            trust_tiles,
            doubt_tiles,
            tile_first,
            x + (lane >> 4) * edge,
            y + ((lane >> 2) & 3) * edge,
            z + (lane & 3) * edge,
            edge,
            s,
        )
        if answer & THROUGH:
            through |= bit
        if answer & DISPUTES:
            disputed |= bit
        if answer & IS_SURFACE:
            surface |= bit
        if answer & IS_BLIND:
            blind |= bit
    return through, disputed, surface, blind


@uncounted(cache=True, error_model="numpy")
def settle_centre(numbers, c, first, doubt, x, y, z, edge):
    """The thesis' depth test (section 3.1): the voxel's centre against the one pixel that it projects to."""
    px = numbers[c, 0] * x + numbers[c, 1] * y + numbers[c, 2] * z + numbers[c, 3]
    py = numbers[c, 4] * x + numbers[c, 5] * y + numbers[c, 6] * z + numbers[c, 7]
    pz = numbers[c, 8] * x + numbers[c, 9] * y + numbers[c, 10] * z + numbers[c, 11]
    if pz <= PLANE_EPS:
        return 0
    u = np.floor(numbers[c, LENS] * px / pz + numbers[c, LENS + 2] + 0.5)
    v = np.floor(numbers[c, LENS + 1] * py / pz + numbers[c, LENS + 3] + 0.5)
    if not (u >= 0.0 and u < numbers[c, SIZE] and v >= 0.0 and v < numbers[c, SIZE + 1]):
        return 0
    texel = doubt[first + int(v) * int(numbers[c, SIZE]) + int(u)]
    if texel == NEUTRAL:
        return 0
    least = texel >> np.uint32(16)
    greatest = np.uint32(NO_RETURN) - (texel & np.uint32(0xFFFF))
    if greatest == NO_RETURN:
        return DISPUTES | IS_BLIND
    at = np.sqrt(px * px + py * py + pz * pz) if numbers[c, RADIAL] != 0.0 else pz
    beyond = max(at - numbers[c, MARGIN + 4], 0.0)
    margin = (
        numbers[c, MARGIN]
        + at * (numbers[c, MARGIN + 1] + at * numbers[c, MARGIN + 2])
        + numbers[c, MARGIN + 3] * beyond * beyond
    )
    # texels round by a quantum or two to the safe side; the plain comparison undoes that
    measured = (greatest - 1) * numbers[c, QUANTUM]
    if measured > at + margin and least * numbers[c, QUANTUM] + 4 * numbers[c, QUANTUM] > at + margin:
        return THROUGH
    if measured + margin >= at - 0.5 * edge:
        return DISPUTES | IS_SURFACE
    return 0
