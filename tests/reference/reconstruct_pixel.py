"""Naive twins of the pixel test and of the thesis' point test: one voxel against all pixels of an image."""

from dataclasses import dataclass
from itertools import combinations, product

import numpy as np

from reference.reconstruct_pyramid import NO_RETURN

THROUGH, DISPUTES, SURFACE, BLIND = 1, 2, 4, 8
SIGNS = np.array(list(product((-1, 1), repeat=3)))
NEUTRAL = (0xFFFF, 0)
"""Least and greatest of a pixel that says nothing: explained."""


@dataclass
class Image:
    """What one camera knows: bounds in quanta by pixel, of all pixels (trust) and of unexplained ones (doubt)."""

    camera: object
    polynomial: np.ndarray
    lateral_px: float
    quantum: float
    trust: tuple
    doubt: tuple
    lowest: int = 0
    split: bool = False
    blank: bool = False

    def margin(self, depth):
        """k sigma + bias + range errors at a depth [m]."""
        constant, linear, quadratic, beyond, offset = self.polynomial
        return constant + linear * depth + quadratic * depth**2 + beyond * max(depth - offset, 0.0) ** 2


def say_of_voxel(image, centre, edge):
    """The sum of what the camera says of a voxel, by the definitions."""
    camera, lens = image.camera, image.camera.intrinsics
    wide = 0.5 + image.lateral_px
    corners = centre + SIGNS * edge / 2
    rotation = camera.camera_from_world[:3, :3]
    in_camera = corners @ rotation.T + camera.camera_from_world[:3, 3]
    near, far = in_camera[:, 2].min(), in_camera[:, 2].max()
    if far <= 0:
        return 0
    if near <= 1e-3:
        return DISPUTES
    seen_at = np.stack([lens.fx * in_camera[:, 0], lens.fy * in_camera[:, 1]], axis=1) / in_camera[:, 2:]
    seen_at += (lens.cx, lens.cy)
    size = np.array([camera.width, camera.height])
    whole = (np.floor(seen_at.min(axis=0) - image.lateral_px) >= 0).all() and (
        np.ceil(seen_at.max(axis=0) + image.lateral_px) <= size - 1
    ).all()
    v, u = np.indices((camera.height, camera.width))
    meets = squares_meeting(seen_at, u, v, wide)
    if not meets.any():
        return 0
    u, v = u[meets], v[meets]

    # directions (x, y, 1) at the corners of each pixel's widened square, along the world's axes
    cone = []
    for du, dv in product((-wide, wide), repeat=2):
        x, y = (u + du - lens.cx) / lens.fx, (v + dv - lens.cy) / lens.fy
        cone.append(np.stack([x, y, np.ones_like(x)], axis=1) @ rotation)
    least_d, greatest_d = np.min(cone, axis=0), np.max(cone, axis=0)
    low, high = centre - edge / 2 - camera.centre_in_world, centre + edge / 2 - camera.centre_in_world
    steep_near, steep_far = np.ones(len(u)), np.ones(len(u))
    if camera.depth_kind == "radial":
        distance = np.linalg.norm(in_camera.mean(axis=0))
        near, far = distance - 0.8660255 * edge, distance + 0.8660255 * edge
        from_axis = np.stack([np.abs(u - lens.cx), np.abs(v - lens.cy)], axis=1)
        steep_far = np.sqrt(1 + (((from_axis + wide) / (lens.fx, lens.fy)) ** 2).sum(axis=1))
        steep_near = np.sqrt(1 + ((np.maximum(from_axis - wide, 0) / (lens.fx, lens.fy)) ** 2).sum(axis=1))
    margin, quantum = image.margin(far), image.quantum

    def is_past(depths):
        """Beyond the whole voxel, or where all of the cone has left it through a face."""
        t = ((depths * quantum - margin) / steep_far)[:, None]
        left = ((least_d >= 0) & (t * least_d > high)) | ((greatest_d <= 0) & (t * greatest_d < low))
        return (depths >= np.floor((far + margin) / quantum + 2)) | left.any(axis=1)

    def is_before(depths):
        """Short of the whole voxel, or where no part of the cone has come to it yet."""
        t = ((depths * quantum + margin) / steep_near)[:, None]
        short = (np.maximum(t * greatest_d, 0) < low) | (np.minimum(t * least_d, 0) > high)
        return (depths <= np.floor(max((near - margin) / quantum - 2, 0))) | short.any(axis=1)

    trusted = image.trust[0][meets]
    least, greatest = (bound[meets] for bound in image.doubt)
    blocked = ~is_past(trusted)
    if not blocked.any():
        return THROUGH if whole else 0
    speaks = ~((least == NEUTRAL[0]) & (greatest == NEUTRAL[1]))
    blind = blocked & speaks & (greatest == NO_RETURN)
    hidden = blocked & speaks & ~blind & is_before(greatest)
    measured_here = blocked & speaks & ~blind & ~hidden & ~is_past(least)
    if camera.flying_pixels:
        short, beyond = (
            np.floor(max((near - margin) / quantum - 2, 0)),
            np.floor((far + margin) / quantum + 2),
        )
        silent = (image.doubt[0] >= beyond) | (image.doubt[1] <= short)
        alone = np.array([is_alone(silent, row, column) for row, column in zip(v, u, strict=True)])
        blind &= ~alone
        measured_here &= ~alone
    if measured_here.any():
        return DISPUTES | SURFACE
    return DISPUTES | BLIND if blind.any() else 0


def is_alone(silent, row, column):
    """Whether all eight pixels about one say nothing of a voxel; never at the image's edge."""
    about = silent[max(row - 1, 0) : row + 2, max(column - 1, 0) : column + 2]
    return about.shape == (3, 3) and bool(about.sum() - silent[row, column] == 8)


def squares_meeting(points, u, v, wide):
    """Which squares of half side `wide` around (u, v) meet the convex hull of points, by separating lines."""
    (u_low, v_low), (u_high, v_high) = points.min(axis=0), points.max(axis=0)
    meets = (u + wide >= u_low) & (u - wide <= u_high) & (v + wide >= v_low) & (v - wide <= v_high)
    for a, b in combinations(points, 2):
        along = b - a
        length = np.linalg.norm(along)
        if length < 1e-9:
            continue
        normal = np.array([-along[1], along[0]]) / length
        sides = (points - a) @ normal
        if sides.max() > 1e-9 and sides.min() < -1e-9:
            continue  # no edge of the hull
        if sides.max() > 1e-9:
            normal = -normal
        nearest = (u - a[0]) * normal[0] + (v - a[1]) * normal[1] - wide * np.abs(normal).sum()
        meets &= nearest <= 0
    return meets


def say_of_centre(image, centre, edge):
    """The thesis' depth test: the voxel's centre against the pixel that it falls into."""
    camera, lens = image.camera, image.camera.intrinsics
    x, y, z = camera.camera_from_world[:3, :3] @ centre + camera.camera_from_world[:3, 3]
    if z <= 1e-3:
        return 0
    u, v = np.floor(lens.fx * x / z + lens.cx + 0.5), np.floor(lens.fy * y / z + lens.cy + 0.5)
    if not (0 <= u < camera.width and 0 <= v < camera.height):
        return 0
    least, greatest = (bound[int(v), int(u)] for bound in image.doubt)
    if (least, greatest) == NEUTRAL:
        return 0
    if greatest == NO_RETURN:
        return DISPUTES | BLIND
    at = np.sqrt(x * x + y * y + z * z) if camera.depth_kind == "radial" else z
    margin, measured = image.margin(at), (greatest - 1) * image.quantum
    if measured > at + margin and (least + 4) * image.quantum > at + margin:
        return THROUGH
    return DISPUTES | SURFACE if measured + margin >= at - edge / 2 else 0
