"""Slow and obvious twins of the machine's kernels, rays through embreex, and small machines."""

import embreex.rtcore_scene
import numpy as np
from embreex.mesh_construction import TriangleMesh
from scipy.linalg import expm

from elbowroom.geometry import DepthCamera, Intrinsics

ARM = """<robot name="arm">
<link name="foot"><collision><geometry><box size="0.4 0.4 0.1"/></geometry></collision></link>
<link name="flange"/>
<link name="upper"><collision><origin xyz="0 0 0.3" rpy="0.1 0.2 0"/>
  <geometry><cylinder radius="0.08" length="0.6"/></geometry></collision></link>
<link name="fore"><collision><origin xyz="0.25 0 0"/><geometry><box size="0.5 0.06
0.1"/></geometry></collision>
  <collision><origin xyz="0.5 0 0"/><geometry><sphere radius="0.09"/></geometry></collision></link>
<link name="left"><collision><geometry><box size="0.1 0.02 0.05"/></geometry></collision></link>
<link name="right"><visual><geometry><box size="0.1 0.02 0.05"/></geometry></visual></link>
<joint name="slide" type="prismatic"><parent link="foot"/><child link="flange"/><origin xyz="0 0 0.05"/>
  <axis xyz="2 0 0"/><limit lower="-0.5" upper="0.5" effort="0" velocity="1"/></joint>
<joint name="bolt" type="fixed"><parent link="flange"/><child link="upper"/><origin rpy="0 0 0.4"/></joint>
<joint name="elbow" type="revolute"><parent link="upper"/><child link="fore"/><origin xyz="0 0 0.6" rpy="0 0.3
0"/>
  <axis xyz="0 1 1"/><limit lower="-2" upper="2" effort="0" velocity="1"/></joint>
<joint name="grip" type="prismatic"><parent link="fore"/><child link="left"/><origin xyz="0.6 0 0"/>
  <axis xyz="0 1 0"/><limit lower="0" upper="0.04" effort="0" velocity="1"/></joint>
<joint name="follow" type="prismatic"><parent link="fore"/><child link="right"/><origin xyz="0.6 0 0"/>
  <axis xyz="0 1 0"/><limit lower="-0.05" upper="0.05" effort="0" velocity="1"/>
  <mimic joint="grip" multiplier="-1" offset="-0.01"/></joint>
</robot>"""
"""A slide, a turn about a slanted axis, a gripper whose second finger follows; box, cylinder, sphere."""


def world_from_links(machine, joints):
    """Forward kinematics link by link with the matrix exponential of each joint's twist."""
    rows = {}
    for row, link in enumerate(machine.links):
        parent = machine.tree.parent[row]
        if parent < 0:
            rows[link.name] = machine.world_from_base
            continue
        placed = rows[machine.links[parent].name] @ machine.tree.parent_from_joint[row]
        joint = next((j for j in machine.joints if j.child == link.name), None)
        if joint is not None:
            position = joints[joint.name] if joint.mimic is None else None
            if joint.mimic is not None:
                position = joint.mimic.multiplier * joints[joint.mimic.joint] + joint.mimic.offset
            x, y, z = joint.axis_in_joint
            twist = np.zeros((4, 4))
            if joint.kind == "prismatic":
                twist[:3, 3] = x, y, z
            else:
                twist[:3, :3] = [[0, -z, y], [z, 0, -x], [-y, x, 0]]
            placed = placed @ expm(position * twist)
        rows[link.name] = placed
    return rows


def triangles_in_world(machine, joints, names=None):
    """Corners of all triangles of some links (None: all), shape (m, 3, 3)."""
    placed = machine.world_from_links(joints)
    return np.concatenate(
        [
            link.triangles @ placed[link.name][:3, :3].T + placed[link.name][:3, 3]
            for link in machine.links
            if link.has_geometry and (names is None or link.name in names)
        ]
    )


def body(samples, placed, grid, growth_m):
    """Voxels whose box lies within growth of a surface sample, or that hold an interior one."""
    covered = np.zeros(grid.shape, dtype=bool)
    every = np.stack(np.indices(grid.shape), axis=-1)
    lower = grid.lower_m + every * grid.voxel_size_m
    for point, link in zip(samples.points, samples.point_link, strict=True):
        here = placed[link][:3, :3] @ point.astype(float) + placed[link][:3, 3]
        away = np.maximum(np.maximum(lower - here, here - lower - grid.voxel_size_m), 0)
        covered |= (away**2).sum(axis=-1) <= growth_m**2
    for point, link in zip(samples.interior, samples.interior_link, strict=True):
        here = placed[link][:3, :3] @ point.astype(float) + placed[link][:3, 3]
        if grid.contains(here):
            covered[tuple(grid.index_of(here))] = True
    return covered


def distance_to_triangle(point, corners):
    """Exact distance of a point from a triangle (Ericson, Real-Time Collision Detection, 5.1.5)."""
    a, b, c = corners
    normal = np.cross(b - a, c - a)
    best = min(_to_segment(point, p, q) for p, q in ((a, b), (b, c), (c, a)))
    size = np.linalg.norm(normal)
    if size > 1e-15:
        sides = [np.dot(np.cross(q - p, point - p), normal) for p, q in ((a, b), (b, c), (c, a))]
        if min(sides) >= 0:
            best = min(best, abs(np.dot(point - a, normal)) / size)
    return best


def _to_segment(point, p, q):
    length = np.dot(q - p, q - p)
    t = 0.0 if length == 0 else np.clip(np.dot(point - p, q - p) / length, 0, 1)
    return np.linalg.norm(point - p - t * (q - p))


def camera_at(centre, target, name="north", width=160, height=120, focal=90.0, **more):
    """A camera that looks from a point at another one, upright."""
    centre, target = np.array(centre, dtype=float), np.array(target, dtype=float)
    z = (target - centre) / np.linalg.norm(target - centre)
    x = np.cross(z, [0, 0.05, 1.0])
    x /= np.linalg.norm(x)
    pose = np.eye(4)
    pose[:3, :3] = np.stack([x, np.cross(z, x), z], axis=1)
    pose[:3, 3] = centre
    intrinsics = Intrinsics(focal, focal * 1.05, width / 2 - 0.7, height / 2 + 0.4)
    return DepthCamera(
        name=name, width=width, height=height, world_from_camera=pose, intrinsics=intrinsics, **more
    )


def ray_cast(triangles, camera):
    """Depth in the camera's kind, infinity for nothing, and the triangle hit, -1 for none, by embreex."""
    scene = embreex.rtcore_scene.EmbreeScene()
    faces = np.arange(3 * len(triangles), dtype=np.int32).reshape(-1, 3)
    TriangleMesh(scene, np.ascontiguousarray(triangles.reshape(-1, 3), dtype=np.float32), faces)
    x, y = camera.intrinsics.normalised(camera.width, camera.height)
    in_camera = np.stack(np.broadcast_arrays(x[None, :], y[:, None], 1.0), axis=-1).reshape(-1, 3)
    directions = (in_camera @ camera.world_from_camera[:3, :3].T).astype(np.float32)
    origins = np.tile(camera.centre_in_world.astype(np.float32), (len(directions), 1))
    hits = scene.run(origins, directions, output=True)
    shape = (camera.height, camera.width)
    triangle = hits["primID"].reshape(shape)
    depth = np.where(triangle >= 0, hits["tfar"].reshape(shape), np.inf).astype(np.float64)
    return (depth * camera.radial_over_planar if camera.depth_kind == "radial" else depth), triangle


def explain(model, depth, camera, tolerance_m, sigmas):
    """Where the measured depth fits the model in 3 x 3 pixels: its depth, nearest about if not drawn; else 0."""
    explained = np.zeros(depth.shape)
    for v in range(camera.height):
        for u in range(camera.width):
            about = model[max(0, v - 1) : v + 2, max(0, u - 1) : u + 2]
            about = about[np.isfinite(about)]
            d = depth[v, u]
            if (
                not (np.isfinite(d) and d > 0 and camera.min_depth_m <= d < camera.max_depth_m)
                or not about.size
            ):
                continue
            sigma = 0.0 if camera.noise is None else float(camera.noise.sigma(d))
            slack = tolerance_m + sigmas * sigma
            if about.min() - slack <= d <= about.max() + slack:
                explained[v, u] = model[v, u] if np.isfinite(model[v, u]) else about.min()
    return explained if not camera.flying_pixels else with_mixed_pixels(model, depth, camera, explained)


def is_return(camera, d):
    return np.isfinite(d) and d > 0 and camera.min_depth_m <= d < camera.max_depth_m


def has_support(depth, camera, explained, v, u):
    """Whether enough of a pixel's eight neighbours are lost, or unexplained and about as deep."""
    k, d, support = camera.intrinsics, depth[v, u], 0
    sigma = 0.0 if camera.noise is None else float(camera.noise.sigma(d))
    slack = 4.5 * sigma + d / min(k.fx, k.fy)
    for nv in (v - 1, v, v + 1):
        for nu in (u - 1, u, u + 1):
            if (nv, nu) == (v, u):
                continue
            beyond = not (0 <= nv < camera.height and 0 <= nu < camera.width)
            lost = beyond or not is_return(camera, depth[nv, nu])
            if lost or (explained[nv, nu] <= 0 and abs(depth[nv, nu] - d) <= slack):
                support += 1
    return support >= (4 if camera.flying_pixels else 1)


def with_mixed_pixels(model, depth, camera, explained):
    """What flying pixels add, where the model is about a pixel without fitting.

    Returns behind the machine's edge with fewer than four neighbours like them: infinity. Else specks, which all about
    them, or about them and one neighbour, is explained or farther than the model in them: minus that depth. Else
    minus a millionth.
    """
    settled = explained.copy()
    candidates = []
    for v, u in np.ndindex(depth.shape):
        about = model[max(0, v - 1) : v + 2, max(0, u - 1) : u + 2]
        if explained[v, u] or not np.isfinite(about).any():
            continue
        free_to = model[v, u] if np.isfinite(model[v, u]) else about.min()
        candidates.append((v, u, free_to))
        past = is_return(camera, depth[v, u]) and depth[v, u] > free_to
        if past and not has_support(depth, camera, explained, v, u):
            settled[v, u] = np.inf
    base = settled.copy()
    for v, u, free_to in candidates:
        if base[v, u] == 0:
            speck = any(
                surrounded(base, depth, camera, {(v, u), (v + dv, u + du)}, free_to)
                for dv, du in np.ndindex(3, 3)
                for dv, du in [(dv - 1, du - 1)]
            )
            settled[v, u] = -free_to if speck else -1e-6
    return settled


def surrounded(explained, depth, camera, pixels, free_to):
    """Whether all eight neighbours of all these pixels lie in the image and are explained or farther."""
    if any(not (0 < v < camera.height - 1 and 0 < u < camera.width - 1) for v, u in pixels):
        return False
    about = {(v + dv - 1, u + du - 1) for v, u in pixels for dv, du in np.ndindex(3, 3)} - pixels
    return all(explained[p] > 0 or (is_return(camera, depth[p]) and depth[p] > free_to) for p in about)


def unexplained_voxels(camera, depth, explained, grid):
    """Voxels that hold the measured point of a pixel that is not explained and has support; shape of the grid."""
    valid = np.isfinite(depth) & (depth > 0) & (explained <= 0) & (explained >= -1e-5)
    valid &= (depth >= camera.min_depth_m) & (depth < camera.max_depth_m)
    for v, u in np.argwhere(valid):
        valid[v, u] = has_support(depth, camera, explained, v, u)
    points = camera.points_in_world(np.where(valid, depth, 1.0))[valid]
    held = np.zeros(grid.shape, dtype=bool)
    inside = points[grid.contains(points)]
    held[tuple(grid.index_of(inside).T)] = True
    return held


def touches_box(corners, lower, upper):
    """Whether a triangle meets a closed box: what is left of it after cutting it at the box's six planes."""
    polygon = [np.asarray(corner, dtype=float) for corner in corners]
    for axis in range(3):
        for sign, limit in ((1.0, lower[axis]), (-1.0, -upper[axis])):
            kept = []
            for p, q in zip(polygon, polygon[1:] + polygon[:1], strict=True):
                before, after = sign * p[axis] - limit, sign * q[axis] - limit
                if before >= 0:
                    kept.append(p)
                if (before < 0) != (after < 0):
                    kept.append(p + (q - p) * (before / (before - after)))
            polygon = kept
            if not polygon:
                return False
    return True


def fan_rise(ring, place, rng, count):
    """The greatest difference in height, at many places, of a ring closed from its middle, and from a place.

    `ring`: (k, 3), x, y and height over its middle, which lies at 0. Most places are on the lines from there.
    """
    k = len(ring)
    middle = [np.array([np.zeros(3), ring[n], ring[(n + 1) % k]]) for n in range(k)]
    fan = [ring[[place, (place + n) % k, (place + n + 1) % k]] for n in range(1, k - 1)]
    points = [rng.dirichlet((0.4, 0.4, 0.4), count // 4) @ triangle for triangle in middle]
    points += [np.linspace(0, 1, count)[:, None] * corner for corner in ring]
    found = 0.0
    for x, y, height in np.concatenate(points):
        others = [h for h in (_height(corners, x, y) for corners in fan) if h is not None]
        found = max(found, min((abs(height - other) for other in others), default=0.0))
    return found


def _height(corners, x, y):
    """Height of a triangle over a place; None beside it."""
    (a, b, c), (d, e, f), (g, h, i) = corners
    area = (d - a) * (h - b) - (g - a) * (e - b)
    second, third = (
        ((x - a) * (h - b) - (g - a) * (y - b)) / area,
        ((d - a) * (y - b) - (x - a) * (e - b)) / area,
    )
    inside = min(second, third, 1 - second - third) >= -1e-9
    return c + second * (f - c) + third * (i - c) if inside else None
