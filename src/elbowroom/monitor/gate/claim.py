"""What a verdict asks of the gate: a level, a speed, and whether a person who holds on may creep."""

import math
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from typing import Self

from elbowroom.errors import InputError
from elbowroom.guard.reason import Reason
from elbowroom.monitor.health.streams.cause import HealthCause, Sick
from elbowroom.motion import Level, Verdict


@dataclass(frozen=True, slots=True)
class Claim:
    """The most that one motion may be allowed at one moment.

    Args:
        motion: its name, such as "larm +".
        level: of the verdict.
        speed: the greatest share of full speed, 0 to 1; 0 where the level is stop.
        reason: what holds it back.
        overridable: only unseen space ends the travel, so that a person who holds on may creep into it.
        escapes: the motion leads out of what the machine stands in, or beside.
        creep_speed: at which that person may creep at most, a share of full speed.

    Raises:
        InputError: a speed that is no number from 0 to 1, or one above 0 at level stop.
    """

    motion: str
    level: Level
    speed: float
    reason: Reason
    overridable: bool = False
    escapes: bool = False
    creep_speed: float = 1.0

    def __post_init__(self) -> None:
        if not (isinstance(self.level, Level) and isinstance(self.reason, Reason)):
            raise InputError(f"claim of {self.motion}: level {self.level!r} and reason {self.reason!r}")
        most = 0.0 if self.level is Level.STOP else 1.0
        if not 0.0 <= self.speed <= most:
            raise InputError(
                f"claim of {self.motion}: speed is {self.speed}, must be 0 to {most:g} at {self.level.name}"
            )

    @classmethod
    def of(cls, verdict: Verdict, low_speed: float) -> Self:
        """What a verdict claims.

        Args:
            verdict: of one motion.
            low_speed: at which one creeps out of contact, a share of full speed.

        Raises:
            InputError: its free travel is no number of at least 0.
        """
        motion, creep = verdict.motion, verdict.creep
        reason = Reason[verdict.cause.name]
        # braking shrinks as speed does, and no faster: `braking_time_s` may hold a reaction time
        has_room = verdict.free_travel > low_speed * motion.braking_distance
        overridable = verdict.overridable and verdict.level is Level.STOP
        return cls(
            motion.name,
            verdict.level,
            speed_of(verdict),
            reason,
            overridable and creep is not None and creep.travel > 0,
            verdict.escapes and has_room and not reason.is_fault,
            0.0 if creep is None else min(1.0, creep.braking_distance / motion.braking_distance),
        )


def speed_of(verdict: Verdict) -> float:
    """The greatest share of full speed from which the machine surely rests one braking distance before the block.

    S may hold a reaction time, whose way shrinks as the speed does: from a share f of full speed it rests within f S.
    So at a free travel d between S and 2 S it is (d - S) / S. 0 at and within S, full speed from 2 S on.

    Args:
        verdict: of one motion.

    Raises:
        InputError: its free travel is no number of at least 0.
    """
    travel, braking = verdict.free_travel, verdict.motion.braking_distance
    if not (math.isfinite(travel) and travel >= 0):
        raise InputError(f"verdict of {verdict.motion.name}: free travel is {travel}")
    if verdict.level is Level.STOP:
        return 0.0
    if verdict.level is Level.DECELERATE:
        return min(1.0, max(travel - braking, 0.0) / braking)
    return 1.0


def claims_of(verdicts: Sequence[Verdict], low_speed: float) -> tuple[Claim, ...]:
    """What the verdicts of a pass claim, in their order; one that says no usable travel claims nothing.

    Args:
        verdicts: of a pass.
        low_speed: at which one creeps out of contact, a share of full speed.
    """
    claims = []
    for verdict in verdicts:
        with suppress(InputError):
            claims.append(Claim.of(verdict, low_speed))
    return tuple(claims)


def held_back(claims: Sequence[Claim], sick: Sequence[Sick]) -> tuple[Claim, ...]:
    """The same, or stop: while a camera is awaited, and while one may be elsewhere, nothing moves and nothing latches.

    What leads out of what the machine stands in is judged without a camera in doubt, and stays.

    Args:
        claims: of a pass.
        sick: what is wrong with which source.
    """
    causes = {each.cause for each in sick}
    if HealthCause.CAMERA_STARTING in causes:
        return tuple(Claim(each.motion, Level.STOP, 0.0, Reason.STARTING) for each in claims)
    if HealthCause.CAMERA_DOUBTED not in causes:
        return tuple(claims)
    return tuple(
        replace(each, level=Level.STOP, speed=0.0, reason=Reason.CAMERA_DOUBTED, overridable=False)
        for each in claims
    )
