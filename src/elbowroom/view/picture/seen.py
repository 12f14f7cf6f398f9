"""What cameras and checks come to as layers: frusta, blocked space near the machine, swept volumes by level."""

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import distance_transform_edt

from elbowroom.geometry import DepthCamera, VoxelGrid
from elbowroom.machine import Machine
from elbowroom.motion import Cause, Level, Motion, Verdict
from elbowroom.motion.course import way_of
from elbowroom.reconstruct.free_space import FreeSpace
from elbowroom.simulate.shapes import box
from elbowroom.view.draw.palette import CAMERA_INK, IN_3D, LEVEL_COLOURS, Label, labels
from elbowroom.view.draw.site import frustum_in_world
from elbowroom.view.picture.layer import Layer, Lines, Word, linear

Array = NDArray[np.float64]
BODY_M, BODY_SHARE = 0.045, 0.008
"""Half edge of the box that stands for a camera [m], and the most that it is of the extent of what is shown."""
UNSEEN_OPACITY, SWEEP_OPACITY = 0.34, 0.42
STEP_M = 0.015
"""Between two poses of a swept volume no corner of a link moves much farther [m]."""
MOST_POSES, MOST_TRIANGLES = 160, 1_500_000
CONTACT_M = 0.05
"""Half length of the cross that marks where a way ends [m]."""
FACES = np.array([(0, 0), (1, 0), (1, 1), (0, 0), (1, 1), (0, 1)], dtype=float)


def camera_bodies(cameras: Sequence[DepthCamera], extent_m: float) -> Layer:
    """A small box for each camera, behind its centre.

    Args:
        cameras: where they hang.
        extent_m: of all that is shown, corner to corner [m].
    """
    half = min(BODY_M, BODY_SHARE * extent_m)
    vertices, faces = box((-half, -half * 0.6, -2 * half), (half, half * 0.6, -0.02 * half))
    shape = vertices[faces]
    parts = [shape @ one.world_from_camera[:3, :3].T + one.centre_in_world for one in cameras]
    things = np.repeat(np.arange(len(parts), dtype=np.int32), len(shape))
    triangles = np.concatenate([np.zeros((0, 3, 3)), *parts])
    return Layer(triangles, np.tile(np.array(linear(CAMERA_INK)), (len(triangles), 1)), things)


def frusta(cameras: Sequence[DepthCamera], reach_m: float) -> tuple[Lines, tuple[Word, ...]]:
    """The edges of fields of view, and the cameras' names.

    Args:
        cameras: where they hang.
        reach_m: so far fields of view are drawn, or to the sensor's range [m].
    """
    edges = [(0, 1), (0, 2), (0, 3), (0, 4), (1, 2), (2, 3), (3, 4), (4, 1)]
    segments = [np.zeros((0, 2, 3))]
    for camera in cameras:
        corners = frustum_in_world(camera, min(reach_m, camera.max_depth_m))
        segments.append(corners[np.array(edges)])
    names = tuple(Word(c.name, tuple(c.centre_in_world.tolist()), CAMERA_INK) for c in cameras)
    return Lines(np.concatenate(segments), CAMERA_INK, 1.3), names


def blocked_layers(space: FreeSpace, machine_triangles: Array | None, near_m: float) -> tuple[Layer, ...]:
    """Voxels that are not free: surfaces opaque, unseen and blind ones so that what is in them shines through.

    Args:
        space: what was found.
        machine_triangles: only what is near them is shown, shape (n, 3, 3) [m]; None: all of the grid.
        near_m: how near [m].
    """
    grid, volume = space.grid, labels(space)
    if machine_triangles is not None:
        volume = np.where(_near(grid, machine_triangles, near_m), volume, np.uint8(Label.FREE))
    layers = []
    for label in (Label.SURFACE, Label.UNSEEN, Label.BLIND):
        triangles = voxel_faces(volume == label, grid)
        opacity = 1.0 if label is Label.SURFACE else UNSEEN_OPACITY
        layers.append(Layer.plain(triangles, linear(IN_3D[label]), opacity))
    return tuple(layers)


def _near(grid: VoxelGrid, triangles: Array, near_m: float) -> NDArray[np.bool_]:
    """Voxels whose centre is about so near to corners or middles of triangles, shape of the grid."""
    points = np.concatenate([triangles.reshape(-1, 3), triangles.mean(axis=1), *_between(triangles)])
    index = np.floor((points - grid.lower_m) / grid.voxel_size_m).astype(np.int64)
    index = index[((index >= 0) & (index < grid.shape)).all(axis=1)]
    away = np.ones(grid.shape, dtype=bool)
    away[tuple(index.T)] = False
    if away.all():
        return ~away
    return np.asarray(distance_transform_edt(away) * grid.voxel_size_m <= near_m)


def _between(triangles: Array, step_m: float = 0.05, most: int = 400) -> list[Array]:
    """Points on the edges of large triangles, no farther apart than a step."""
    found = []
    for a, b in ((0, 1), (1, 2), (2, 0)):
        ends = triangles[:, [a, b]]
        length = np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1)
        count = np.clip(np.ceil(length / step_m), 1, most).astype(int)
        row = np.repeat(np.arange(len(ends)), count)
        share = (np.arange(len(row)) - np.repeat(np.cumsum(count) - count, count)) / count[row]
        found.append(ends[row, 0] + share[:, None] * (ends[row, 1] - ends[row, 0]))
    return found


def voxel_faces(which: NDArray[np.bool_], grid: VoxelGrid) -> Array:
    """Faces between chosen voxels and others, two triangles each, shape (n, 3, 3), world frame [m].

    Args:
        which: bool, shape of the grid.
        grid: where they are.
    """
    padded = np.pad(which, 1)
    triangles = [np.zeros((0, 3, 3))]
    for axis in range(3):
        for side in (0, 1):
            bare = padded & ~np.roll(padded, 1 - 2 * side, axis=axis)
            index = np.argwhere(bare[1:-1, 1:-1, 1:-1])
            corner = np.zeros((6, 3))
            corner[:, [(axis + 1) % 3, (axis + 2) % 3]] = FACES
            corner[:, axis] = side
            places = grid.lower_m + (index[:, None, :] + corner) * grid.voxel_size_m
            triangles.append(places.reshape(-1, 3, 3))
    return np.concatenate(triangles)


def sweep_layers(
    machine: Machine, joints: Mapping[str, float], verdicts: Sequence[Verdict]
) -> tuple[tuple[Layer, ...], Lines]:
    """The volume that each motion sweeps, in its level's colour, and crosses where ways end.

    As far as it is free, and never less than the braking distance: of a stop, the way that it would need.

    Args:
        machine: what moves.
        joints: where it stands, by name [m or rad].
        verdicts: of its motions; those of paths are left out.
    """
    layers, crosses = [], [np.zeros((0, 2, 3))]
    for level in reversed(Level):
        of_level = [v for v in verdicts if v.level is level and isinstance(v.motion, Motion)]
        parts = [_swept(machine, joints, verdict) for verdict in of_level]
        if parts:
            colour = linear(LEVEL_COLOURS[level])
            layers.append(Layer.plain(np.concatenate(parts), colour, SWEEP_OPACITY))
    for verdict in verdicts:
        if verdict.place_in_world is not None and verdict.cause is not Cause.NONE:
            arms = np.eye(3)[:, None] * np.array([[-CONTACT_M], [CONTACT_M]])
            crosses.append(np.array(verdict.place_in_world) + arms)
    return tuple(layers), Lines(np.concatenate(crosses), (0, 0, 0), 2.6)


def _swept(machine: Machine, joints: Mapping[str, float], verdict: Verdict) -> Array:
    """Triangles of all moved links at poses along a way, shape (n, 3, 3), world frame [m]."""
    motion = verdict.motion
    if not isinstance(motion, Motion):
        return np.zeros((0, 3, 3))
    way = way_of(machine, machine.positions(joints), motion)
    length = min(way.length, max(verdict.free_travel, motion.braking_distance))
    moved = set(machine.moved_links(motion.joint))
    rows = [n for n, link in enumerate(machine.links) if link.name in moved and link.has_geometry]
    if not rows or length <= 0:
        return np.zeros((0, 3, 3))
    ends = machine.world_from_link_array(
        np.stack([way.course.positions[0], _at(way.course.travel, way.course.positions, length)])
    )
    far = max(
        float(np.linalg.norm(_placed(machine, row, ends[1]) - _placed(machine, row, ends[0]), axis=2).max())
        for row in rows
    )
    each = sum(len(machine.links[row].triangles) for row in rows)
    count = int(np.clip(np.ceil(far / STEP_M), 2, max(2, min(MOST_POSES, MOST_TRIANGLES // each))))
    travels = np.linspace(0, length, count + 1)[1:]
    poses = machine.world_from_link_array(
        np.stack([_at(way.course.travel, way.course.positions, float(t)) for t in travels])
    )
    return np.concatenate([_placed(machine, row, pose) for pose in poses for row in rows])


def _at(travel: Array, positions: Array, at: float) -> Array:
    return np.array([np.interp(at, travel, column) for column in positions.T])


def _placed(machine: Machine, row: int, world_from_links: Array) -> Array:
    pose = world_from_links[row]
    return np.asarray(machine.links[row].triangles @ pose[:3, :3].T + pose[:3, 3])
