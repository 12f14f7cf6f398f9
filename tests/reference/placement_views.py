"""Views far enough apart, by trying every set of cameras."""

import itertools
import math


def directions(point, eyes):
    """Direction from a point to each camera in the horizontal plane [rad]; None straight above or below."""
    found = []
    for eye in eyes:
        dx, dy = eye[0] - point[0], eye[1] - point[1]
        found.append(math.atan2(dy, dx) if math.hypot(dx, dy) > 1e-9 else None)
    return found


def between(a, b):
    """Angle between two directions, 0 to pi."""
    turn = abs(a - b) % (2 * math.pi)
    return min(turn, 2 * math.pi - turn)


def largest_set(angles, least_rad, tie=1e-9):
    """Size of the largest set of directions that are pairwise at least an angle apart."""
    for size in range(len(angles), 0, -1):
        for some in itertools.combinations(angles, size):
            if all(between(a, b) >= least_rad - tie for a, b in itertools.combinations(some, 2)):
                return size
    return 0


def any_triple(angles, least_rad, tie=1e-9):
    """Whether some three directions are pairwise at least an angle apart (thesis 3.3)."""
    return any(
        all(between(a, b) >= least_rad - tie for a, b in itertools.combinations(three, 2))
        for three in itertools.combinations(angles, 3)
    )


def in_view(camera, point):
    """Whether a point falls on the image of a pinhole camera and within its range, by its definition."""
    rotation, centre = camera.world_from_camera[:3, :3], camera.world_from_camera[:3, 3]
    x, y, z = (sum(rotation[k][axis] * (point[k] - centre[k]) for k in range(3)) for axis in range(3))
    if z <= 0:
        return False
    k = camera.intrinsics
    u, v = k.fx * x / z + k.cx, k.fy * y / z + k.cy
    depth = z if camera.depth_kind == "planar" else math.sqrt(x * x + y * y + z * z)
    on_image = -0.5 <= u < camera.width - 0.5 and -0.5 <= v < camera.height - 0.5
    return on_image and camera.min_depth_m <= depth < camera.max_depth_m


def blocked_by_box(eye, point, lower, upper):
    """Whether the way between two points passes through a box, by the way's stretch within each pair of faces."""
    first, last = 0.0, 1.0
    for axis in range(3):
        way = point[axis] - eye[axis]
        if abs(way) < 1e-12:
            if not lower[axis] < eye[axis] < upper[axis]:
                return False
            continue
        ends = sorted(((lower[axis] - eye[axis]) / way, (upper[axis] - eye[axis]) / way))
        first, last = max(first, ends[0]), min(last, ends[1])
    return first < last
