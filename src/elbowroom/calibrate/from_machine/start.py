"""Where a camera is, roughly: what moved before it, laid on the surface that the machine shows it."""

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import uniform_filter
from scipy.spatial import cKDTree

from elbowroom.calibrate.from_machine.drawn_machine import DrawnMachine
from elbowroom.calibrate.from_machine.views import MachineViews
from elbowroom.errors import CalibrationError
from elbowroom.extras import package
from elbowroom.geometry.twist import between, moved, sizes
from elbowroom.sensing.planar_images import PlanarImages, thinned

START_WIDTH_PX = 80
"""Points and surface are taken from images thinned to about this."""
WIDER = 0.35
"""The surface is drawn in an image that reaches so much farther on each side: the camera may look elsewhere."""
MOVED_SIGMAS, MOVED_M = 6.0, 0.03
"""What is nearer than the farthest of all poses by so much has moved."""
FEWEST_POINTS = 25
"""Poses with fewer moving points have no say."""
REACH_M = 0.5
"""Points farther from the surface are nobody's at the start [m]."""
GATES_M = (0.3,) * 6 + (0.2,) * 6 + (0.1,) * 8 + (0.05,) * 8
"""Distances from which a point counts a quarter, round by round [m]."""
FARTHEST_M, FARTHEST_RAD = 0.6, 0.45
"""A start that moves the camera farther is no start [m, rad]."""
ALONG_SURFACE = 0.1
"""Weight of what a point is off along the surface: without it nothing pulls from far away."""

Array = NDArray[Any]


class Surface(NamedTuple):
    """What a camera can see of the machine in one pose: points and normals, world frame; zero normal at an edge."""

    points: Array
    normals: Array
    tree: cKDTree


def start(drawn: DrawnMachine, views: MachineViews) -> Array:
    """A first pose of a camera from a rough one.

    Per pose small_gicp lays what moved on the machine's visible surface; the outcome that suits all poses best is
    then mended by an iterative closest point over all of them at once. People who moved as well are outvoted.

    Args:
        drawn: the machine, where its base is.
        views: of the camera; its own pose is the rough one.

    Returns:
        world_from_camera, shape (4, 4).

    Raises:
        CalibrationError: nothing of the machine moved in its view, or no pose suits.
    """
    name, rough = views.camera.name, views.camera.world_from_camera
    usable = _usable(drawn, views)
    if len(usable) < 3:
        raise CalibrationError(
            f"camera {name}: the machine moves in its view in {len(usable)} of {len(views.poses)} poses, at least 3 "
            "are needed; move it where this camera sees it, or look whether the camera's rough pose is right"
        )
    candidates = [rough]
    for seen, surface in usable:
        laid = package("small_gicp").align(
            surface.points,
            seen,
            rough,
            registration_type="GICP",
            downsampling_resolution=0.05,
            max_correspondence_distance=REACH_M,
            max_iterations=40,
        )
        pose = np.array(laid.T_target_source)
        far_m, far_rad = sizes(between(rough, pose))
        if far_m < FARTHEST_M and far_rad < FARTHEST_RAD:
            candidates.append(pose)
    best = min(candidates, key=lambda pose: _misfit(pose, usable))
    for gate_m in GATES_M:
        best = _closer(best, usable, gate_m)
    far_m, far_rad = sizes(between(rough, best))
    if not (far_m < FARTHEST_M and far_rad < FARTHEST_RAD):
        raise CalibrationError(
            f"camera {name}: what moves in its view suits the machine only if it stands {far_m * 100:.0f} cm and "
            f"{np.degrees(far_rad):.0f} degrees from its rough pose; give a rough pose within 10 cm and 5 degrees"
        )
    return best


def _usable(drawn: DrawnMachine, views: MachineViews) -> list[tuple[Array, Surface]]:
    """Per pose that has a say what moved and the machine's surface."""
    small = views.images.coarser(max(1, views.images.thinned.width // START_WIDTH_PX))
    points = moving_points(small, views.images)
    surfaces = [_surface(drawn, small, pose) for pose in views.base_from_links]
    return [
        (p, s)
        for p, s in zip(points, surfaces, strict=True)
        if len(p) >= FEWEST_POINTS and len(s.points) >= FEWEST_POINTS
    ]


def moving_points(small: PlanarImages, images: PlanarImages) -> list[Array]:
    """Per image the points of what is nearer than in some other image, camera frame, shapes (n, 3) [m].

    Args:
        small: the images at the points' density.
        images: the same, dense: depth is the mean of up to 5 x 5 pixels that moved and lie together.
    """
    depth = images.depth_m
    far = depth.max(axis=0)
    sigma = images.camera.noise.sigma(far) if images.camera.noise is not None else 0.0
    step = small.step // images.step
    x, y = np.meshgrid(*small.thinned.intrinsics.normalised(small.thinned.width, small.thinned.height))
    picked, about = (slice(step // 2, None, step),) * 2, min(2 * step - 1, 5)
    found = []
    for image in depth:
        has_moved = (image > 0) & (image < far - (MOVED_SIGMAS * sigma + MOVED_M))
        kept = np.where(has_moved, image, 0.0)
        share, mean, square = (
            uniform_filter(part, about)[picked][: x.shape[0], : x.shape[1]]
            for part in (has_moved.astype(float), kept, kept.astype(float) ** 2)
        )
        mean, square = mean / np.maximum(share, 1e-9), square / np.maximum(share, 1e-9)
        chosen = (share > 0.6) & (square - mean**2 < 0.06**2)
        z = mean[chosen]
        found.append(np.stack([x[chosen] * z, y[chosen] * z, z], axis=-1).astype(float))
    return found


def _surface(drawn: DrawnMachine, small: PlanarImages, base_from_links: Array) -> Surface:
    """The machine's points that a camera with a wider view could see."""
    wide = thinned(small.thinned, 1, WIDER)
    inverse = drawn.image(wide, base_from_links).inverse.astype(float)
    x, y = np.meshgrid(*wide.intrinsics.normalised(wide.width, wide.height))
    down, across = np.gradient(inverse)
    across, down = across * wide.intrinsics.fx, down * wide.intrinsics.fy
    normals = np.stack([across, down, inverse - x * across - y * down], axis=-1)
    bend = sum(
        np.abs(np.roll(inverse, 1, axis) + np.roll(inverse, -1, axis) - 2 * inverse) for axis in (0, 1)
    )
    is_there = inverse > 0
    smooth = is_there & (bend < 0.1 * inverse**2)
    lengths = np.linalg.norm(normals, axis=-1)
    normals = np.where(smooth[..., None], normals / np.where(lengths > 0, lengths, 1)[..., None], 0.0)
    z = 1 / inverse[is_there]
    in_camera = np.stack([x[is_there] * z, y[is_there] * z, z], axis=-1)
    turn, shift = wide.world_from_camera[:3, :3], wide.centre_in_world
    points = in_camera @ turn.T + shift
    return Surface(points, normals[is_there] @ turn.T, cKDTree(points))


def _misfit(world_from_camera: Array, usable: list[tuple[Array, Surface]]) -> float:
    """Mean distance of the moving points from the surface, none counted above 10 cm."""
    turn, shift = world_from_camera[:3, :3], world_from_camera[:3, 3]
    distances = [
        surface.tree.query(seen @ turn.T + shift, distance_upper_bound=0.1)[0] for seen, surface in usable
    ]
    return float(np.minimum(np.concatenate(distances), 0.1).mean())


def _closer(world_from_camera: Array, usable: list[tuple[Array, Surface]], gate_m: float) -> Array:
    """One round of closest points over all poses: point to plane, and a little along it; far points count less."""
    turn, shift = world_from_camera[:3, :3], world_from_camera[:3, 3]
    normal, gradient = 1e-6 * np.eye(6), np.zeros(6)
    for seen, surface in usable:
        distance, nearest = surface.tree.query(seen @ turn.T + shift, distance_upper_bound=3 * gate_m)
        found = np.isfinite(distance)
        points, nearest = seen[found], nearest[found]
        off = (points @ turn.T + shift - surface.points[nearest]) @ turn
        normals = surface.normals[nearest] @ turn
        weight = 1 / (1 + (distance[found] / gate_m) ** 2) ** 2
        along = weight * np.where(np.any(normals, axis=1), ALONG_SURFACE, 1.0)
        by_point = _derivatives(points)
        by_plane = np.einsum("nk,nki->ni", normals, by_point)
        normal += np.einsum("n,nki,nkj->ij", along, by_point, by_point)
        gradient += np.einsum("n,nki,nk->i", along, by_point, off)
        normal += np.einsum("n,ni,nj->ij", weight, by_plane, by_plane)
        gradient += np.einsum("n,ni,n->i", weight, by_plane, (off * normals).sum(axis=1))
    return moved(world_from_camera, -np.linalg.solve(normal, gradient))


def _derivatives(points: Array) -> Array:
    """How points of a frame move with its twist, shape (n, 3, 6): w x p + t."""
    x, y, z = points.T
    result = np.zeros((len(points), 3, 6))
    result[:, 0, 1], result[:, 0, 2] = z, -y
    result[:, 1, 0], result[:, 1, 2] = -z, x
    result[:, 2, 0], result[:, 2, 1] = y, -x
    result[:, :, 3:] = np.eye(3)
    return result
