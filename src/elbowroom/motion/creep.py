"""How far an operator who holds on may creep into space that nobody sees (the override of thesis 6.1.3)."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from elbowroom.errors import InputError
from elbowroom.machine import Machine
from elbowroom.motion.check import check_motions
from elbowroom.motion.course import way_of
from elbowroom.motion.motion import Motion
from elbowroom.motion.skin import skin_of
from elbowroom.motion.sweep import cluster_speeds
from elbowroom.motion.verdict import Creep, Level, Verdict
from elbowroom.reconstruct.free_space import FreeSpace

REDUCED_SPEED_M_S = 0.25
"""Reduced speed of manual control (ISO 10218-1): of no point of the machine more [m/s]."""
SHARE_OF_FULL_SPEED = 0.25
"""Where full speed is slow itself, creeping is at most this share of it."""


@dataclass(frozen=True, slots=True)
class Override:
    """How fast an operator who holds on may drive where nobody sees.

    Args:
        max_speed_m_s: of the fastest point of what moves [m/s].
        share_of_full_speed: of the joint's full speed, 0 to 1; the lesser of the two holds.
        speeds: full speeds of the joints by name [m/s or rad/s]; a joint that is not named may not creep.

    Raises:
        InputError: a speed that is not above 0, or a share that is not above 0 and at most 1.
    """

    max_speed_m_s: float = REDUCED_SPEED_M_S
    share_of_full_speed: float = SHARE_OF_FULL_SPEED
    speeds: Mapping[str, float] = field(default_factory=dict)

    def __post_init__(self) -> None:
        if not (np.isfinite(self.max_speed_m_s) and self.max_speed_m_s > 0):
            raise InputError(f"override: max_speed_m_s is {self.max_speed_m_s}, must be a number above 0")
        if not 0 < self.share_of_full_speed <= 1:
            raise InputError(
                f"override: share_of_full_speed is {self.share_of_full_speed}, must be above 0 and at most 1"
            )

    def speed_of(self, motion: Motion, lever: float) -> float:
        """The greatest speed of a creeping joint [m/s or rad/s].

        Args:
            motion: of a joint that has a full speed.
            lever: the most that any point moves per unit of travel [m per m or rad].
        """
        share = self.share_of_full_speed * self.speeds[motion.joint]
        return float(min(share, self.max_speed_m_s / lever if lever > 0 else share))


def with_creep(
    space: FreeSpace,
    machine: Machine,
    joints: Mapping[str, float],
    verdicts: Sequence[Verdict],
    override: Override,
) -> list[Verdict]:
    """The verdicts, each stop by space that nobody sees with how far an operator may creep; all others as they are.

    What nobody sees is driven into; everything else that blocks, what was seen, what is disputed, what a blind camera
    looks at, the grid's end and the machine itself, ends the way as before. The braking distance shrinks as the speed
    does, and no faster: `braking_time_s` may hold a reaction time, which does not shrink.

    Args:
        space: that they were checked in.
        machine, joints: as they were checked.
        verdicts: in any order.
        override: how fast.

    Raises:
        MachineError: as `check_motions`.
    """
    asked = [verdict.motion for verdict in verdicts if _may_creep(verdict, override)]
    if not asked:
        return list(verdicts)
    beyond = check_motions(_as_if_seen(space), machine, joints, asked)
    start = machine.positions(joints)
    placed = machine.world_from_link_array(start[None])[0]
    skin = skin_of(machine, space.grid.voxel_size_m)
    found = {}
    for next_block in beyond:
        motion = next_block.motion
        assert isinstance(motion, Motion)
        way = way_of(machine, start, motion)
        lever = float(cluster_speeds(machine, skin, placed, way).max(initial=0.0))
        found[motion] = _creep(next_block, override.speed_of(motion, lever), override.speeds[motion.joint])
    return [
        replace(verdict, creep=found[verdict.motion]) if verdict.motion in found else verdict
        for verdict in verdicts
    ]


def _may_creep(verdict: Verdict, override: Override) -> bool:
    """Whether it is a stop by unseen space, of one joint that has a speed."""
    motion = verdict.motion
    stopped = verdict.level is Level.STOP and verdict.overridable
    return stopped and isinstance(motion, Motion) and motion.joint in override.speeds


def _creep(next_block: Verdict, speed: float, full_speed: float) -> Creep:
    """Up to what ends the way beyond, less the braking distance at that speed."""
    braking = next_block.motion.braking_distance * speed / full_speed
    return Creep(
        speed=speed,
        braking_distance=braking,
        travel=max(0.0, next_block.free_travel - braking),
        cause=next_block.cause,
        link=next_block.link,
        place_in_world=next_block.place_in_world,
    )


def _as_if_seen(space: FreeSpace) -> FreeSpace:
    """The space with everything free that nobody sees, nobody disputes and nobody is blind to."""
    said: NDArray[np.uint64] = space.surface_words | space.blind_words | space.disputed_words
    return replace(space, free_words=space.free_words | (space.blocked_words & ~said), source=None)
