"""What one camera says of 64 boxes at once: through, nothing, or mixed (docs/architecture.md, "The footprint test").

The 64 boxes are the 4 x 4 x 4 children of a cube, child (i, j, k) in lane 16 i + 4 j + k. Arithmetic, table look-up
and comparison are loops of their own over rows of one scratch record: so LLVM can prove that nothing overlaps, and
vectorises the first and the last. Divisions need numba's "numpy" error model, or each would be a branch.
"""

from typing import Any

import numpy as np
from numba import njit

from elbowroom.geometry.kernels.bits import uncounted
from elbowroom.geometry.kernels.noise import in_float32, margin_at
from elbowroom.geometry.kernels.rigid import moved
from elbowroom.reconstruct.kernels.texels import NO_RETURN

_FLOATS = ("near", "far", "least", "greatest", "state", "u", "v")
_INTS = ("texel", "least_quanta", "greatest_quanta")

_ROWS: Any = {
    "names": [*_FLOATS, *_INTS, "marks", "mark_words"],
    "formats": [("f4", 64)] * 7 + [("i4", 64)] * 3 + [("u1", (3, 64)), ("u8", (3, 8))],
    # the last two are the same bytes
    "offsets": [*range(0, 10 * 256, 256), 2560, 2560],
    "itemsize": 2560 + 192,
}
LANES = np.dtype((np.record, np.dtype(_ROWS)))
"""Scratch memory for 64 boxes, one in each lane.

near, far: bounds of their depth, by the margin wider [m]; least, greatest: depth in their windows [m]; state: where
they lie in the image; u, v: the pixel of their centre. texel: where to look; least_quanta, greatest_quanta: what was
found there. marks: three rows of yes or no, mark_words: the same, eight bytes at a time.
"""
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


@uncounted(cache=True, error_model="numpy")
def place_boxes(camera, boxes):
    """Box 0 in camera axes (x times fx, y times fy, z), and where the cube of all 64 lies.

    The state says it of the whole cube: OUTSIDE nothing of it can be seen, INSIDE all of it, else PARTLY.
    """
    m = camera.camera_from_world
    px, py, pz = moved(m, boxes.x, boxes.y, boxes.z)
    reach = 1.5 * boxes.edge
    mx = px + reach * (m[0, 0] + m[0, 1] + m[0, 2])
    my = py + reach * (m[1, 0] + m[1, 1] + m[1, 2])
    mz = pz + reach * (m[2, 0] + m[2, 1] + m[2, 2])
    half = camera.half_extent
    ex, ey, ez = 4.0 * half[boxes.scale, 0], 4.0 * half[boxes.scale, 1], 4.0 * half[boxes.scale, 2]
    near, far = mz - ez, mz + ez
    state = PARTLY
    if far <= 0.0:
        state = OUTSIDE
    elif near > 2.0 * PLANE_EPS:
        rn, rf = 1.0 / near, 1.0 / far
        widen = camera.lateral_px + 2.0 * SLOP_PX
        u0 = min((mx - ex) * rn, (mx - ex) * rf) * camera.fx + camera.cx - widen
        u1 = max((mx + ex) * rn, (mx + ex) * rf) * camera.fx + camera.cx + widen
        v0 = min((my - ey) * rn, (my - ey) * rf) * camera.fy + camera.cy - widen
        v1 = max((my + ey) * rn, (my + ey) * rf) * camera.fy + camera.cy + widen
        w, h = camera.width, camera.height
        if u1 <= -1.0 or v1 <= -1.0 or u0 >= w or v0 >= h:
            state = OUTSIDE
        elif u0 >= 0.0 and v0 >= 0.0 and u1 <= w - 1.0 and v1 <= h - 1.0:
            state = INSIDE
    return (np.float32(px * camera.fx), np.float32(py * camera.fy), np.float32(pz)), state


@njit(inline="always")
def _half_extents(camera, scale):
    """Half extents of a box in camera axes, x times fx, y times fy, in float32."""
    half, fx, fy = camera.half_extent, np.float32(camera.fx), np.float32(camera.fy)
    return np.float32(half[scale, 0]) * fx, np.float32(half[scale, 1]) * fy, np.float32(half[scale, 2])


@uncounted(cache=True, error_model="numpy")
def _choose_windows(camera, reach, lanes):
    """Points each lane at the window around its centre pixel that reaches at least `reach` pixels to every side.

    At the last level all of the image is one texel.
    """
    level = camera.lowest
    while (2 << level) < reach and level < camera.levels - 1:
        level += 1
    first, stride = np.int32(camera.level_first[level]), np.int32(camera.level_stride[level])
    shift = np.int32(level)
    for lane in range(64):
        u, v = np.int32(lanes.u[lane]), np.int32(lanes.v[lane])
        lanes.texel[lane] = first + (v >> shift) * stride + (u >> shift)


@uncounted(cache=True, error_model="numpy")
def _add_margin(camera, scale, first, lanes):
    """Rows near and far: a lane's depth bounds become what a pixel's depth is compared with."""
    if camera.radial:
        px, py, pz = first
        rfx, rfy = np.float32(1.0 / camera.fx), np.float32(1.0 / camera.fy)
        diagonal = np.float32(camera.half_diagonal[scale])
        for lane in range(64):
            x = (px + camera.offset[scale, 0, lane]) * rfx
            y = (py + camera.offset[scale, 1, lane]) * rfy
            z = pz + camera.offset[scale, 2, lane]
            distance = np.sqrt(x * x + y * y + z * z)
            lanes.near[lane] = distance - diagonal
            lanes.far[lane] = distance + diagonal
    of_depth = in_float32(camera.margin)
    for lane in range(64):
        far = lanes.far[lane]
        margin = margin_at(of_depth, far) + abs(far) * SLOP_REL
        lanes.near[lane] = lanes.near[lane] - margin
        lanes.far[lane] = far + margin


@njit(inline="always")
def _pixels_about(camera, reach):
    """Pixels from floor(u_min - lateral) to ceil(u_max + lateral), seen from the centre pixel."""
    return int(np.ceil(reach / 1024.0 + camera.lateral_px + 1.5 + 2 * SLOP_PX)) - 1


@uncounted(cache=True, error_model="numpy")
def bound_inside(camera, scale, first, lanes):
    """Depth bounds and windows of the 64 children of a cube that lies wholly inside the image.

    Args:
        camera: its record.
        scale: of the children.
        first: child 0, as `place_boxes` gives it.
        lanes: written: near, far, u, v and texel.

    Returns:
        How many pixels a child may reach to every side of its centre pixel.
    """
    px, py, pz = first
    ox, oy = np.float32(camera.cx) + HALF, np.float32(camera.cy) + HALF
    ex, ey, ez = _half_extents(camera, scale)
    reach = np.int32(0)
    for lane in range(64):
        x = px + camera.offset[scale, 0, lane]
        y = py + camera.offset[scale, 1, lane]
        z = pz + camera.offset[scale, 2, lane]
        near = z - ez
        rz, rn = ONE_F / z, ONE_F / near
        lanes.near[lane] = near
        lanes.far[lane] = z + ez
        lanes.u[lane] = np.floor(x * rz + ox)
        lanes.v[lane] = np.floor(y * rz + oy)
        # of both sides of the box the one away from the axis reaches farther from the centre
        wide = (abs(x) + ex) * rn - abs(x) * rz
        high = (abs(y) + ey) * rn - abs(y) * rz
        reach = max(reach, np.int32(max(wide, high) * np.float32(1024)))
    pixels = _pixels_about(camera, reach)
    _choose_windows(camera, pixels, lanes)
    _add_margin(camera, scale, first, lanes)
    return pixels


@uncounted(cache=True, error_model="numpy")
def bound_partly(camera, scale, first, lanes):
    """The same for a cube that the image's edge or the camera's plane cuts; row state says where each child lies."""
    px, py, pz = first
    ox, oy = np.float32(camera.cx), np.float32(camera.cy)
    ox_half, oy_half = ox + HALF, oy + HALF
    ex, ey, ez = _half_extents(camera, scale)
    lateral = np.float32(camera.lateral_px) + SLOP_PX
    last_u, last_v = np.float32(camera.width - 1), np.float32(camera.height - 1)
    reach = np.int32(0)
    for lane in range(64):
        x = px + camera.offset[scale, 0, lane]
        y = py + camera.offset[scale, 1, lane]
        z = pz + camera.offset[scale, 2, lane]
        near, far = z - ez, z + ez
        lanes.near[lane] = near
        lanes.far[lane] = far
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
        lanes.state[lane] = state if in_front else behind
        u = min(max(np.floor(x * rz + ox_half), ZERO), last_u) if in_front else ZERO
        v = min(max(np.floor(y * rz + oy_half), ZERO), last_v) if in_front else ZERO
        lanes.u[lane] = u
        lanes.v[lane] = v
        wide = (abs(x) + ex) * rn - abs(x) * rz
        high = (abs(y) + ey) * rn - abs(y) * rz
        needed = min(max(wide, high), WIDEST_PX) if visible & in_front else ZERO
        reach = max(reach, np.int32(needed * np.float32(1024)))
    # as of a cube inside the image: one that a wider margin moves to its edge must not get smaller windows
    pixels = _pixels_about(camera, reach)
    _choose_windows(camera, pixels, lanes)
    _add_margin(camera, scale, first, lanes)
    return pixels


@uncounted(cache=True, error_model="numpy")
def look_up(windows, quantum, lanes):
    """Least and greatest depth [m] of each lane's window: rows least, greatest. No return: infinity."""
    for lane in range(64):
        texel = windows[np.uint32(lanes.texel[lane])]
        lanes.least_quanta[lane] = np.int32(texel >> np.uint32(16))
        lanes.greatest_quanta[lane] = np.int32(NO_RETURN) - np.int32(texel & np.uint32(0xFFFF))
    scale = np.float32(quantum)
    for lane in range(64):
        greatest = lanes.greatest_quanta[lane]
        lanes.least[lane] = np.float32(lanes.least_quanta[lane]) * scale
        lanes.greatest[lane] = (
            np.float32(greatest) * scale if greatest < np.int32(NO_RETURN) else np.float32(np.inf)
        )


@njit(inline="always")
def bits_of(lanes, row):
    """A row of marks as one word, lane n to bit n."""
    out = np.uint64(0)
    for n in range(8):
        out |= ((lanes.mark_words[row, n] * GATHER) >> np.uint64(56)) << np.uint64(8 * n)
    return out


@uncounted(cache=True)
def decide_inside(lanes):
    """Words (through, mixed) of 64 boxes that lie wholly inside the image."""
    for lane in range(64):
        front = lanes.least[lane] > lanes.far[lane]
        hidden = lanes.greatest[lane] < lanes.near[lane]
        lanes.marks[0, lane] = front
        lanes.marks[1, lane] = hidden
    through = bits_of(lanes, 0)
    return through, ~(through | bits_of(lanes, 1))


@uncounted(cache=True)
def decide_partly(lanes):
    """The same where row state tells: only a box wholly inside is ever through, one outside is never mixed.

    The third word: what can be seen of a box is all seen through, but the box is not all in view; then the camera
    says nothing of it.
    """
    for lane in range(64):
        state = lanes.state[lane]
        front = lanes.least[lane] > lanes.far[lane]
        hidden = lanes.greatest[lane] < lanes.near[lane]
        lanes.marks[0, lane] = (state == INSIDE) & front
        lanes.marks[1, lane] = (state == CROSSING) | ((state != OUTSIDE) & (not hidden) & (not front))
        lanes.marks[2, lane] = (state == PARTLY) & front
    return bits_of(lanes, 0), bits_of(lanes, 1), bits_of(lanes, 2)
