"""The figures of a site that separation distances are made of, and where each comes from."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from elbowroom.geometry import DepthCamera, VoxelGrid
from elbowroom.machine import Machine
from elbowroom.motion import Motion
from elbowroom.motion.separation import Separation, intrusion_of
from elbowroom.motion.stride import greatest_strides
from elbowroom.site.separation_entry import SeparationEntry
from elbowroom.sources import Room

RESOLVED_PITCHES = 6
"""What is so many pixels wide is never missed: three pitches to each side (promise 1 of docs/safety.md)."""
MOST_LOOK_M = 1.0
"""Where the site does not say how far from the machine to look, it is no farther than this [m]."""


@dataclass(frozen=True, slots=True, eq=False)
class Figures:
    """What a run needs of its site.

    Args:
        separation: the terms that do not change.
        look_m: how far from the machine is looked [m].
        entry: as the site says it.
        capability_m: the smallest thing that is surely noticed anywhere, across [m].
    """

    separation: Separation
    look_m: float
    entry: SeparationEntry
    capability_m: float

    @property
    def command_ms(self) -> float:
        """From the decision to the machine's brakes [ms]; 0 where the site does not say it."""
        return self.entry.command_ms or 0.0

    def reaction_s(self, measured_ms: float | None) -> float | None:
        """T_r: what was measured, or what the site vouches for if that is more, and the command [s]; None: neither.

        Args:
            measured_ms: the worst terms' sum [ms]; None: nothing was measured.
        """
        known = [ms for ms in (measured_ms, self.entry.reaction_ms) if ms is not None]
        return (max(known) + self.command_ms) / 1e3 if known else None


def figures_of(room: Room) -> Figures:
    """The figures of a room whose machine's motions are judged.

    Raises:
        InputError: no machine, or no joint with a speed.
    """
    machine, motions = room.machine_and_motions()
    entry, site = room.site.entry.separation, room.site
    braking = {motion.joint: motion.braking_distance for motion in motions}
    speeds = {name: joint.speed_of(machine.joint(name)) for name, joint in site.entry.joints.items()}
    capability_m = detection_capability(room.grid, room.cameras)
    separation = Separation(
        greatest_strides(machine, speeds, room.grid.voxel_size_m),
        greatest_strides(machine, braking, room.grid.voxel_size_m),
        max(joint.braking_time_s for joint in site.entry.joints.values()),
        entry.walking_m_s,
        entry.reaching_m_s,
        intrusion_of(capability_m) if entry.intrusion_mm is None else entry.intrusion_mm / 1e3,
        (entry.person_uncertainty_mm or 0.0) / 1e3,
        site.explain_tolerance_m
        if entry.machine_uncertainty_mm is None
        else entry.machine_uncertainty_mm / 1e3,
    )
    look_m = entry.look_m or stopping_distance(machine, motions, room.grid.voxel_size_m)
    return Figures(separation, look_m, entry, capability_m)


def stopping_distance(machine: Machine, motions: Sequence[Motion], voxel_size_m: float) -> float:
    """The most that any point moves while one joint brakes from full speed, at most `MOST_LOOK_M` [m].

    Args:
        machine: the machine.
        motions: with the braking distance of each joint.
        voxel_size_m: edge of a voxel [m].
    """
    ways = [
        greatest_strides(machine, {motion.joint: motion.braking_distance}, voxel_size_m)
        for motion in motions
        if motion.direction > 0
    ]
    return min(MOST_LOOK_M, max((max(way.values(), default=0.0) for way in ways), default=MOST_LOOK_M))


def detection_capability(grid: VoxelGrid, cameras: Sequence[DepthCamera]) -> float:
    """d: the smallest thing that every camera resolves anywhere in the grid, across, at least a voxel's diagonal [m].

    It is the worst of the room: nearer to a camera it is less.

    Args:
        grid: the watched box.
        cameras: that look into it.
    """
    corners = np.array(np.meshgrid(*zip(grid.lower_m, grid.upper_m, strict=True))).reshape(3, -1).T
    sizes = [float(np.sqrt(3) * grid.voxel_size_m)]
    for camera in cameras:
        farthest_m = np.linalg.norm(corners - camera.centre_in_world, axis=1).max()
        pitch_m = min(farthest_m, camera.max_depth_m) / min(camera.intrinsics.fx, camera.intrinsics.fy)
        sizes.append(float(RESOLVED_PITCHES * pitch_m))
    return max(sizes)
