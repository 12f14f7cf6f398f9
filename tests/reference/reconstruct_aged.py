"""Naive twins of the aged test: a voxel grown by a ball, against all pixels of an image."""

from itertools import product

import numpy as np

from reference.reconstruct_pixel import SIGNS


def sees_through_grown(image, centre, edge, far_m):
    """Whether a camera sees through a voxel grown by a ball, by the definition: face by face, edge by edge."""
    camera, lens = image.camera, image.camera.intrinsics
    wide = 0.5 + image.lateral_px
    rotation = camera.camera_from_world[:3, :3]
    in_camera = (centre + SIGNS * edge / 2) @ rotation.T + camera.camera_from_world[:3, 3]
    near, far = in_camera[:, 2].min() - far_m, in_camera[:, 2].max() + far_m
    if near <= 1e-3:
        return False
    slopes = in_camera[:, :2] / in_camera[:, 2:]
    focal, middle = np.array([lens.fx, lens.fy]), np.array([lens.cx, lens.cy])
    low, high = slopes.min(axis=0), slopes.max(axis=0)
    low = (low - far_m / near * np.sqrt(1 + low**2)) * focal + middle
    high = (high + far_m / near * np.sqrt(1 + high**2)) * focal + middle
    size = np.array([camera.width, camera.height])
    if (np.floor(low - image.lateral_px) < 0).any() or (np.ceil(high + image.lateral_px) > size - 1).any():
        return False
    v, u = np.indices((camera.height, camera.width))
    meets = (u >= low[0] - wide) & (u <= high[0] + wide) & (v >= low[1] - wide) & (v <= high[1] + wide)
    meets &= within_rims(in_camera, (u, v), wide, (far_m / near, lens))
    u, v = u[meets], v[meets]
    cone = []
    for du, dv in product((-wide, wide), repeat=2):
        x, y = (u + du - lens.cx) / lens.fx, (v + dv - lens.cy) / lens.fy
        cone.append(np.stack([x, y, np.ones_like(x)], axis=1) @ rotation)
    least_d, greatest_d = np.min(cone, axis=0), np.max(cone, axis=0)
    from_eye = centre - camera.centre_in_world
    steep = np.ones(len(u))
    if camera.depth_kind == "radial":
        far = np.linalg.norm(in_camera.mean(axis=0)) + 0.8660255 * edge + far_m
        from_axis = np.stack([np.abs(u - lens.cx), np.abs(v - lens.cy)], axis=1)
        steep = np.sqrt(1 + (((from_axis + wide) / focal) ** 2).sum(axis=1))
    margin, quantum = image.margin(far), image.quantum
    depths = image.trust[0][meets]
    t = ((depths * quantum - margin) / steep)[:, None]
    reach = edge / 2 + far_m
    left = ((least_d >= 0) & (t * least_d > from_eye + reach)) | (
        (greatest_d <= 0) & (t * greatest_d < from_eye - reach)
    )
    return bool(((depths >= np.floor((far + margin) / quantum + 2)) | left.any(axis=1)).all())


def within_rims(in_camera, pixels, wide, grown):
    """Which pixels, widened, are within all planes through the camera and an edge that bounds the voxel."""
    (u, v), (wide_m, lens) = pixels, grown
    meets = np.ones(u.shape, dtype=bool)
    x, y = (u - lens.cx) / lens.fx, (v - lens.cy) / lens.fy
    for a, b in product(range(8), repeat=2):
        if a >= b or bin(a ^ b).count("1") != 1:
            continue
        normal = np.cross(in_camera[a], in_camera[b])
        sides = in_camera @ normal
        tolerance = 1e-9 * np.linalg.norm(normal)
        if sides.max() > tolerance and sides.min() < -tolerance:
            continue  # it runs across the voxel's picture
        inwards = normal if sides.max() > tolerance else -normal
        half = (abs(inwards[0]) / lens.fx + abs(inwards[1]) / lens.fy) * wide
        reach = wide_m * np.linalg.norm(inwards) + half
        meets &= x * inwards[0] + y * inwards[1] + inwards[2] >= -reach
    return meets


def is_clear_by_points(image, centre, edge, far_m, many=400):
    """Whether all of many points of a voxel grown by a ball lie before what their pixel measured; none out of view.

    Args:
        image: of one camera, as `reconstruct_views.images_of` gives it.
        centre, edge: of the voxel [m].
        far_m: the ball's radius [m].
        many: points about each corner of the voxel.
    """
    camera, lens = image.camera, image.camera.intrinsics
    rng = np.random.default_rng(0)
    away = rng.normal(size=(many, 3))
    away /= np.linalg.norm(away, axis=1, keepdims=True)
    points = (centre + SIGNS[:, None] * edge / 2 + away * far_m).reshape(-1, 3)
    x, y, z = camera.camera_from_world[:3, :3] @ points.T + camera.camera_from_world[:3, 3:]
    if (z <= 1e-3).any():
        return False
    u, v = np.rint(lens.fx * x / z + lens.cx), np.rint(lens.fy * y / z + lens.cy)
    if (u < 0).any() or (v < 0).any() or (u >= camera.width).any() or (v >= camera.height).any():
        return False
    at = np.sqrt(x * x + y * y + z * z) if camera.depth_kind == "radial" else z
    return bool((image.trust[0][v.astype(int), u.astype(int)] * image.quantum > at).all())
