"""How far may the machine go? Free space and motions in, verdicts out."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Self

import numpy as np
from numpy.typing import NDArray

from elbowroom.errors import MachineError
from elbowroom.geometry import parallel
from elbowroom.machine import Machine
from elbowroom.motion.braking import braking_distance
from elbowroom.motion.course import Way, way_of
from elbowroom.motion.ground import grounds_of, zone_of
from elbowroom.motion.inside import blocks_inside
from elbowroom.motion.kernels.mover import Skin
from elbowroom.motion.meeting import Meeting
from elbowroom.motion.motion import JointPath, Motion
from elbowroom.motion.shared import NOT_LOOKED, Ends, Start
from elbowroom.motion.skin import skin_of
from elbowroom.motion.sweep import Block, cluster_speeds
from elbowroom.motion.verdict import Cause, Level, Verdict
from elbowroom.reconstruct.free_space import FreeSpace, Index

CAUSES = (Cause.SURFACE, Cause.OUTSIDE_GRID, Cause.BLIND, Cause.UNSEEN)
"""Of a block, by the numbers that the kernel gives them."""
MOST_LOOKS = 32
"""Of so many voxels in the way of one motion it is asked which parts are free."""


def check_motion(
    space: FreeSpace, machine: Machine, joints: Mapping[str, float], motion: Motion | JointPath
) -> Verdict:
    """How far a motion may go until the swept body meets what is not free.

    The swept body is that of the checked links which the motion moves. The machine's own voxels should have
    been taken out of the space (`reconstruct` does it; `FreeSpace.without`). Of a blocked voxel that a link reaches
    into where it stands, what the body does not cover there blocks it (`motion.shared`), so what leads away goes; about
    a blocked voxel that lies in it a link has a free travel of 0. What lies outside the grid is blocked. Where a link
    would meet another one that must not (`Machine.allowed_contacts`), that ends the travel as well. Joint limits cap
    the free travel, not the level. A voxel in the way is looked at again in parts if the space still has what it was
    made of (`FreeSpace.free_parts`): what is free of it does not end the travel.

    Args:
        space: the free space.
        machine: the machine.
        joints: where it is now, by name [m or rad].
        motion: a joint and its direction, or a joint path.

    Returns:
        The verdict; its free travel is never more than the truth in this space.

    Raises:
        MachineError: an unknown joint, a position that is missing, not finite, or out of the joint's limits.
    """
    return check_motions(space, machine, joints, [motion])[0]


def check_motions(
    space: FreeSpace,
    machine: Machine,
    joints: Mapping[str, float],
    motions: Sequence[Motion | JointPath],
    threads: int | None = None,
) -> list[Verdict]:
    """The same for many motions from one place, in their order.

    Args:
        space, machine, joints: as for `check_motion`.
        motions: what to check.
        threads: how many to use; None: one for each core. The result does not depend on it.

    Raises:
        MachineError: as for `check_motion`.
    """
    start = machine.positions(joints)
    ways = [way_of(machine, start, motion) for motion in motions]
    with parallel.threads(threads):
        return Scene.of(space, machine, start).verdicts(motions, ways)


def joint_motions(
    machine: Machine, speeds: Mapping[str, float], braking_times: float | Mapping[str, float]
) -> list[Motion]:
    """Every joint in both directions, + first, in the machine's order of joints; of a floating joint, as it has speeds.

    Args:
        machine: the machine.
        speeds: full speed of each joint by name [m/s or rad/s].
        braking_times: from full speed to rest [s], one for all joints or by name.

    Raises:
        MachineError: an unknown joint, or one without a speed or a braking time.
        InputError: a speed or a time that is not a finite number above 0.
    """
    times = (
        braking_times
        if isinstance(braking_times, Mapping)
        else dict.fromkeys(machine.joint_names, braking_times)
    )
    for what, given in (("speed", speeds), ("braking time", times)):
        for name in given:
            machine.joint(name)
        for name in machine.joint_names:
            if name not in given and not machine.joint(name).is_posed:
                raise MachineError(
                    f"machine {machine.name}: joint {name!r} has no {what}; all joints need one"
                )
    return [
        Motion(name, direction, braking_distance(speeds[name], times[name]))
        for name in machine.joint_names
        if name in speeds
        for direction in (1, -1)
    ]


@dataclass(frozen=True, slots=True, eq=False)
class Scene:
    """What the motions of one check share."""

    space: FreeSpace
    starts: tuple[Start, ...]
    machine: Machine
    skin: Skin
    meeting: Meeting
    inside: Mapping[int, Block]
    world_from_link: NDArray[np.float64]
    looked_at: dict[Index, np.uint64] = field(default_factory=dict)

    @classmethod
    def of(cls, space: FreeSpace, machine: Machine, start: NDArray[np.float64]) -> Self:
        """What does not depend on the motion.

        Args:
            space, machine: as of `check_motions`.
            start: where its joints are, of `machine.positions`, shape (n_joints,).
        """
        voxel_size_m = space.grid.voxel_size_m
        placed = machine.world_from_link_array(start[None])[0]
        starts = tuple(Start.of(machine, ground, placed) for ground in grounds_of(space, machine))
        return cls(
            space,
            starts,
            machine,
            skin_of(machine, voxel_size_m),
            Meeting.of(machine, placed),
            blocks_inside(machine, tuple(start.ground for start in starts), placed),
            placed,
        )

    def verdicts(self, motions: Sequence[Motion | JointPath], ways: Sequence[Way]) -> list[Verdict]:
        """The answers for several motions, in their order.

        Args:
            motions: what is asked.
            ways: of each where it leads.
        """
        return parallel.spread(lambda pair: self.verdict(*pair), list(zip(motions, ways, strict=True)))

    def verdict(self, motion: Motion | JointPath, way: Way) -> Verdict:
        """The answer for one motion, in the unit of its way."""
        speeds = cluster_speeds(self.machine, self.skin, self.world_from_link, way)
        block, leads_out = self._first_block(speeds, way)
        met = self.meeting.first(way, way.length if block is None else block.travel)
        if met is not None:
            return Verdict(
                motion,
                Level.at(met.travel, motion.braking_distance),
                met.travel,
                way.unit,
                met.link,
                tuple(met.place_in_world.tolist()),
                Cause.MACHINE if met.other in self.machine.link_names else Cause.SURFACE,
                met.other,
                escapes=leads_out and met.travel > 0,
            )
        if block is None:
            return Verdict(
                motion, Level.CLEAR, way.length, way.unit, None, None, Cause.NONE, escapes=leads_out
            )
        zone = zone_of(block, self.space, self.machine)
        return Verdict(
            motion,
            Level.at(block.travel, motion.braking_distance),
            block.travel,
            way.unit,
            self.machine.link_names[self.skin.link[block.cluster]],
            tuple(block.place_in_world.tolist()),
            CAUSES[block.kind] if zone is None else Cause.KEPT_OUT,
            escapes=leads_out and block.travel > 0,
            zone=zone,
        )

    def _first_block(self, speeds: NDArray[np.float64], way: Way) -> tuple[Block | None, bool]:
        """The first block on a way, of what is about the links or in them; and whether the way leads out of blocked
        space: links reach into some at the start, and that does not end the way."""
        grounds = [self._ends_on(start, speeds, way) for start in self.starts]
        found = [ends.first for ends, _ in grounds]
        if way.length > 0 and self.inside:
            for row in np.unique(self.skin.link[speeds > 0]):
                if row in self.inside:
                    cluster = int(np.searchsorted(self.skin.link, row))
                    found.append(self.inside[row]._replace(cluster=cluster))
        blocks = [block for block in found if block is not None]
        first = min(blocks, key=lambda block: (block.travel, block.kind), default=None)
        ends_within = first is not None and any(first is ends.within for ends, _ in grounds)
        return first, way.length > 0 and not ends_within and any(reaches for _, reaches in grounds)

    def _ends_on(self, start: Start, speeds: NDArray[np.float64], way: Way) -> tuple[Ends, bool]:
        """The first blocks of a ground's links in parts of voxels, or the last of those that are looked at; and whether
        these links reach into blocked space at the start."""
        ends, left = NOT_LOOKED, MOST_LOOKS
        while True:
            ends = start.ends(self.machine, self.skin, speeds, way, ends)
            block = ends.first
            if block is None or left == 0 or CAUSES[block.kind] is Cause.OUTSIDE_GRID:
                break
            index = _index_of(block, self.space)
            if start.is_known(index) or not self._free_parts(start.ground.space, index):
                break
            more = [other for other in start.unknown_of(block) if other != index][: left - 1]
            left -= 1 + len(more)
            free = {one: self._free_parts(start.ground.space, one) for one in (index, *more)}
            start = start.with_parts(free)
        return ends, start.holds(self.skin, np.where(start.ground.links[self.skin.link], speeds, 0.0))

    def _free_parts(self, space: FreeSpace, index: Index) -> np.uint64:
        """Which parts of a voxel are free."""
        if index not in self.looked_at:
            self.looked_at[index] = space.free_parts(index)
        return self.looked_at[index]


def _index_of(block: Block, space: FreeSpace) -> Index:
    i, j, k = (int(n) for n in space.grid.index_of(block.place_in_world))
    return i, j, k
