"""What one camera says of 64 boxes at once: through, nothing, or mixed (docs/architecture.md, "The footprint test").

The 64 boxes are the 4 x 4 x 4 children of a cube, child (i, j, k) in lane 16 i + 4 j + k. Arithmetic, table look-up
and comparison are loops of their own over rows of one scratch array: so LLVM can prove that nothing overlaps, and
vectorises the first and the last. Divisions need numba's "numpy" error model, or each would be a branch.
"""

from typing import NamedTuple

import numpy as np
from numba import njit

from elbowroom.geometry.kernels.bits import uncounted
from elbowroom.reconstruct.kernels.pyramid import NO_RETURN

FLOATS = 7 * 64
NEAR, FAR, LEAST, GREATEST, STATE, U, V = (64 * row for row in range(7))
INTS = 3 * 64
TEXEL, LOW_LEAST, LOW_GREATEST = (64 * row for row in range(3))
OUTSIDE, PARTLY, INSIDE, CROSSING = (np.float32(state) for state in range(4))

SLOP_PX = np.float32(0.01)
"""More than float32 arithmetic can err in a pixel coordinate of an image up to 16384 wide."""
SLOP_REL = np.float32(2e-6)
"""Relative allowance on depth bounds for the same reason."""
PLANE_EPS = np.float32(1e-3)
"""A box nearer to the camera's plane than this [m] counts as crossing it."""
WIDEST_PX = np.float32(32768)
"""More than any image has."""
ALL = np.uint64(0xFFFFFFFFFFFFFFFF)
GATHER = np.uint64(0x0102040810204080)
ZERO, ONE_F, HALF = np.float32(0), np.float32(1), np.float32(0.5)

# columns of Views.numbers: camera_from_world (3 x 4), then these
LENS, SIZE, MARGIN, LATERAL, QUANTUM, RADIAL, BLANK, LOWEST, SPLIT, HALF_EXTENT, CENTRE, TURN, COSINE, COLUMNS = (
    12, 16, 18, 23, 24, 25, 26, 27, 28, 29, 37, 40, 52, 53,
)  # fmt: skip


class Views(NamedTuple):
    """All cameras of a carve as arrays, first index the camera.

    numbers (n, COLUMNS) float64: camera_from_world (3 x 4), fx fy cx cy, width height, margin (see `margin_at`),
    lateral [px], quantum [m], whether depth is radial, whether nothing was delivered, the finest level of windows,
    whether the machine explains some of its pixels, half extents of a voxel along the camera axes and its half
    diagonal [m], the
    same of a block of 4 voxels, the camera's centre in the world [m], and how a pixel's
    direction turns in the world: d_a = D0 + D1 u + D2 v along axis a, and its half width over a widened pixel, as
    D0 (3), D1 (3), D2 (3), half width (3); least cosine between a pixel's ray and the optical axis.
    levels (n, levels, 2) int64: where each level of windows begins, and its row length.
    offset (n, 2, 3, 64) float32: from child 0 to each child of a block (0) or cube (1), in camera axes, x times fx and
    y times fy. windows: over what pixels free. texel_first (n,): where each camera's level 0 begins in trust_texels,
    what its pixels free, and in doubt_texels, what they measured of anything but the machine; tile_first (n,) the same
    of level 2, tiles of 4 x 4 pixels. doubt_squares (3, tiles): the least of 2 x 2, 4 x 4 and 8 x 8 of doubt_tiles, the
    tile itself first; of no size where nothing asks for them.
    """

    numbers: np.ndarray
    levels: np.ndarray
    offset: np.ndarray
    windows: np.ndarray
    texel_first: np.ndarray
    trust_texels: np.ndarray
    doubt_texels: np.ndarray
    tile_first: np.ndarray
    trust_tiles: np.ndarray
    doubt_tiles: np.ndarray
    doubt_squares: np.ndarray


@uncounted(cache=True, error_model="numpy")
def place_cube(numbers, c, scale, x, y, z, edge):
    """A cube of 64 children in camera axes: child 0's centre (x times fx, y times fy, z), and where the cube lies.

    (x, y, z) is the world centre of child 0, `edge` a child's edge, `scale` 0 for a block of voxels, 1 for a cube of
    blocks. The state says it of the whole cube: OUTSIDE nothing of it can be seen, INSIDE all of it, else PARTLY.
    """
    fx, fy, ox, oy = numbers[c, LENS + 0], numbers[c, LENS + 1], numbers[c, LENS + 2], numbers[c, LENS + 3]
    px = numbers[c, 0] * x + numbers[c, 1] * y + numbers[c, 2] * z + numbers[c, 3]
    py = numbers[c, 4] * x + numbers[c, 5] * y + numbers[c, 6] * z + numbers[c, 7]
    pz = numbers[c, 8] * x + numbers[c, 9] * y + numbers[c, 10] * z + numbers[c, 11]
    reach = 1.5 * edge
    mx = px + reach * (numbers[c, 0] + numbers[c, 1] + numbers[c, 2])
    my = py + reach * (numbers[c, 4] + numbers[c, 5] + numbers[c, 6])
    mz = pz + reach * (numbers[c, 8] + numbers[c, 9] + numbers[c, 10])
    ex = 4.0 * numbers[c, HALF_EXTENT + 4 * scale + 0]
    ey = 4.0 * numbers[c, HALF_EXTENT + 4 * scale + 1]
    ez = 4.0 * numbers[c, HALF_EXTENT + 4 * scale + 2]
    near, far = mz - ez, mz + ez
    state = PARTLY
    if far <= 0.0:
        state = OUTSIDE
    elif near > 2.0 * PLANE_EPS:
        rn, rf = 1.0 / near, 1.0 / far
        widen = numbers[c, LATERAL] + 2.0 * SLOP_PX
        u0 = min((mx - ex) * rn, (mx - ex) * rf) * fx + ox - widen
        u1 = max((mx + ex) * rn, (mx + ex) * rf) * fx + ox + widen
        v0 = min((my - ey) * rn, (my - ey) * rf) * fy + oy - widen
        v1 = max((my + ey) * rn, (my + ey) * rf) * fy + oy + widen
        w, h = numbers[c, SIZE + 0], numbers[c, SIZE + 1]
        if u1 <= -1.0 or v1 <= -1.0 or u0 >= w or v0 >= h:
            state = OUTSIDE
        elif u0 >= 0.0 and v0 >= 0.0 and u1 <= w - 1.0 and v1 <= h - 1.0:
            state = INSIDE
    return np.float32(px * fx), np.float32(py * fy), np.float32(pz), state


@uncounted(cache=True, error_model="numpy")
def _choose_windows(numbers, levels, c, reach, floats, ints):
    """Points each lane at the window around its centre pixel that reaches at least `reach` pixels to every side.

    At the last level all of the image is one texel.
    """
    level = int(numbers[c, LOWEST])
    while (2 << level) < reach and level < levels.shape[1] - 1:
        level += 1
    first, stride = np.int32(levels[c, level, 0]), np.int32(levels[c, level, 1])
    shift = np.int32(level)
    for lane in range(64):
        u, v = np.int32(floats[U + lane]), np.int32(floats[V + lane])
        ints[TEXEL + lane] = first + (v >> shift) * stride + (u >> shift)


@uncounted(cache=True, error_model="numpy")
def _add_margin(numbers, offset, c, scale, px, py, pz, floats):
    """Rows NEAR and FAR: a lane's depth bounds become what a pixel's depth is compared with."""
    if numbers[c, RADIAL] != 0.0:
        rfx, rfy = np.float32(1.0 / numbers[c, LENS + 0]), np.float32(1.0 / numbers[c, LENS + 1])
        diagonal = np.float32(numbers[c, HALF_EXTENT + 4 * scale + 3])
        for lane in range(64):
            x = (px + offset[c, scale, 0, lane]) * rfx
            y = (py + offset[c, scale, 1, lane]) * rfy
            z = pz + offset[c, scale, 2, lane]
            distance = np.sqrt(x * x + y * y + z * z)
            floats[NEAR + lane] = distance - diagonal
            floats[FAR + lane] = distance + diagonal
    m0, m1, m2 = (
        np.float32(numbers[c, MARGIN + 0]),
        np.float32(numbers[c, MARGIN + 1]),
        np.float32(numbers[c, MARGIN + 2]),
    )
    m3, m4 = np.float32(numbers[c, MARGIN + 3]), np.float32(numbers[c, MARGIN + 4])
    for lane in range(64):
        far = floats[FAR + lane]
        beyond = max(far - m4, ZERO)
        margin = m0 + far * (m1 + far * m2) + m3 * beyond * beyond + abs(far) * SLOP_REL
        floats[NEAR + lane] = floats[NEAR + lane] - margin
        floats[FAR + lane] = far + margin


@uncounted(cache=True, error_model="numpy")
def bound_inside(numbers, levels, offset, c, scale, px, py, pz, floats, ints):
    """Depth bounds and windows of the 64 children of a cube that lies wholly inside the image.

    Returns how many pixels a child may reach to every side of its centre pixel.
    """
    fx, fy = np.float32(numbers[c, LENS + 0]), np.float32(numbers[c, LENS + 1])
    ox, oy = np.float32(numbers[c, LENS + 2]) + HALF, np.float32(numbers[c, LENS + 3]) + HALF
    ex, ey, ez = (
        np.float32(numbers[c, HALF_EXTENT + 4 * scale]) * fx,
        np.float32(numbers[c, HALF_EXTENT + 4 * scale + 1]) * fy,
        np.float32(numbers[c, HALF_EXTENT + 4 * scale + 2]),
    )
    reach = np.int32(0)
    for lane in range(64):
        x = px + offset[c, scale, 0, lane]
        y = py + offset[c, scale, 1, lane]
        z = pz + offset[c, scale, 2, lane]
        near = z - ez
        rz, rn = ONE_F / z, ONE_F / near
        floats[NEAR + lane] = near
        floats[FAR + lane] = z + ez
        floats[U + lane] = np.floor(x * rz + ox)
        floats[V + lane] = np.floor(y * rz + oy)
        # of both sides of the box the one away from the axis reaches farther from the centre
        wide = (abs(x) + ex) * rn - abs(x) * rz
        high = (abs(y) + ey) * rn - abs(y) * rz
        reach = max(reach, np.int32(max(wide, high) * np.float32(1024)))
    # pixels from floor(u_min - lateral) to ceil(u_max + lateral), seen from the centre pixel
    pixels = int(np.ceil(reach / 1024.0 + numbers[c, LATERAL] + 1.5 + 2 * SLOP_PX)) - 1
    _choose_windows(numbers, levels, c, pixels, floats, ints)
    _add_margin(numbers, offset, c, scale, px, py, pz, floats)
    return pixels


@uncounted(cache=True, error_model="numpy")
def bound_partly(numbers, levels, offset, c, scale, px, py, pz, floats, ints):
    """The same for a cube that the image's edge or the camera's plane cuts; row STATE says where each child lies."""
    fx, fy = np.float32(numbers[c, LENS + 0]), np.float32(numbers[c, LENS + 1])
    ox, oy = np.float32(numbers[c, LENS + 2]), np.float32(numbers[c, LENS + 3])
    ox_half, oy_half = ox + HALF, oy + HALF
    ex, ey, ez = (
        np.float32(numbers[c, HALF_EXTENT + 4 * scale]) * fx,
        np.float32(numbers[c, HALF_EXTENT + 4 * scale + 1]) * fy,
        np.float32(numbers[c, HALF_EXTENT + 4 * scale + 2]),
    )
    lateral = np.float32(numbers[c, LATERAL]) + SLOP_PX
    last_u, last_v = np.float32(numbers[c, SIZE + 0] - 1), np.float32(numbers[c, SIZE + 1] - 1)
    reach = np.int32(0)
    for lane in range(64):
        x = px + offset[c, scale, 0, lane]
        y = py + offset[c, scale, 1, lane]
        z = pz + offset[c, scale, 2, lane]
        near, far = z - ez, z + ez
        floats[NEAR + lane] = near
        floats[FAR + lane] = far
        in_front = near > PLANE_EPS
        rn = ONE_F / (near if in_front else ONE_F)
        rf = ONE_F / (far if in_front else ONE_F)
        rz = ONE_F / (z if in_front else ONE_F)
        left, right, top, bottom = x - ex, x + ex, y - ey, y + ey
        # brought near while still floats, so that the cast to int below is safe
        u0 = np.floor(min(max(min(left * rn, left * rf) + ox - lateral, -ONE_F), last_u + ONE_F))
        u1 = np.ceil(min(max(max(right * rn, right * rf) + ox + lateral, -ONE_F), last_u + ONE_F))
        v0 = np.floor(min(max(min(top * rn, top * rf) + oy - lateral, -ONE_F), last_v + ONE_F))
        v1 = np.ceil(min(max(max(bottom * rn, bottom * rf) + oy + lateral, -ONE_F), last_v + ONE_F))
        visible = (u1 >= ZERO) & (u0 <= last_u) & (v1 >= ZERO) & (v0 <= last_v)
        whole = (u0 >= ZERO) & (u1 <= last_u) & (v0 >= ZERO) & (v1 <= last_v)
        state = (INSIDE if whole else PARTLY) if visible else OUTSIDE
        behind = OUTSIDE if far <= ZERO else CROSSING
        floats[STATE + lane] = state if in_front else behind
        u = min(max(np.floor(x * rz + ox_half), ZERO), last_u) if in_front else ZERO
        v = min(max(np.floor(y * rz + oy_half), ZERO), last_v) if in_front else ZERO
        floats[U + lane] = u
        floats[V + lane] = v
        wide = (abs(x) + ex) * rn - abs(x) * rz
        high = (abs(y) + ey) * rn - abs(y) * rz
        needed = min(max(wide, high), WIDEST_PX) if visible & in_front else ZERO
        reach = max(reach, np.int32(needed * np.float32(1024)))
    # as of a cube inside the image: one that a wider margin moves to its edge must not get smaller windows
    pixels = int(np.ceil(reach / 1024.0 + numbers[c, LATERAL] + 1.5 + 2 * SLOP_PX)) - 1
    _choose_windows(numbers, levels, c, pixels, floats, ints)
    _add_margin(numbers, offset, c, scale, px, py, pz, floats)
    return pixels


@uncounted(cache=True, error_model="numpy")
def look_up(windows, quantum, floats, ints):
    """Least and greatest depth [m] of each lane's window: rows LEAST, GREATEST. No return: infinity."""
    for lane in range(64):
        texel = windows[np.uint32(ints[TEXEL + lane])]
        ints[LOW_LEAST + lane] = np.int32(texel >> np.uint32(16))
        ints[LOW_GREATEST + lane] = np.int32(NO_RETURN) - np.int32(texel & np.uint32(0xFFFF))
    scale = np.float32(quantum)
    for lane in range(64):
        greatest = ints[LOW_GREATEST + lane]
        floats[LEAST + lane] = np.float32(ints[LOW_LEAST + lane]) * scale
        floats[GREATEST + lane] = (
            np.float32(greatest) * scale if greatest < np.int32(NO_RETURN) else np.float32(np.inf)
        )


@njit(cache=True, nogil=True, inline="always")
def bits_of(flag_words, row):
    """Row of sixty-four bytes of 0 or 1 as one word, lane n to bit n; the bytes come as eight words."""
    out = np.uint64(0)
    for n in range(8):
        out |= ((flag_words[8 * row + n] * GATHER) >> np.uint64(56)) << np.uint64(8 * n)
    return out


@uncounted(cache=True)
def decide_inside(floats, flags, flag_words):
    """Words (through, mixed) of 64 boxes that lie wholly inside the image. `flag_words` is a view of `flags`."""
    for lane in range(64):
        front = floats[LEAST + lane] > floats[FAR + lane]
        hidden = floats[GREATEST + lane] < floats[NEAR + lane]
        flags[lane] = front
        flags[64 + lane] = hidden
    through = bits_of(flag_words, 0)
    return through, ~(through | bits_of(flag_words, 1))


@uncounted(cache=True)
def decide_partly(floats, flags, flag_words):
    """The same where row STATE tells: only a box wholly inside is ever through, one outside is never mixed.

    The third word: what can be seen of a box is all seen through, but the box is not all in view; then the camera
    says nothing of it.
    """
    for lane in range(64):
        state = floats[STATE + lane]
        front = floats[LEAST + lane] > floats[FAR + lane]
        hidden = floats[GREATEST + lane] < floats[NEAR + lane]
        flags[lane] = (state == INSIDE) & front
        flags[64 + lane] = (state == CROSSING) | ((state != OUTSIDE) & (not hidden) & (not front))
        flags[128 + lane] = (state == PARTLY) & front
    return bits_of(flag_words, 0), bits_of(flag_words, 1), bits_of(flag_words, 2)
