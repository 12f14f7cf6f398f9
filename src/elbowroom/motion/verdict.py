"""What is answered: how far a motion may go, and what ends it.

Levels by the first blocked voxel that the swept body meets, S being the braking distance (thesis 4.1):

    free travel           level        band
    up to and at S        STOP         S
    up to and at 2 S      DECELERATE   M
    up to and at 5 S      INFORM       L
    beyond, or nothing    CLEAR        0

How verdicts combine (`most_cautious`): the lowest level of this table's order wins; within a level a fault goes
before all else, then images too old by now, then input that cannot be right, then what the watch found, then a
verdict that cannot be overridden before one that can; then the one with the least free travel in braking distances;
then the first. No verdict at all is an error, since nothing seen means stop.

| cause              | may be overridden at low speed, while an operator holds on |
|--------------------|------------------------------------------------------------|
| FAULT              | no: nothing is known                                       |
| STALE              | no: what is known is of a while ago                        |
| INPUT              | no: what came in cannot be meant so                        |
| WATCH              | no: what is known comes from a camera that is elsewhere    |
| OFF_PATH           | no: what the machine means to do is not known              |
| SURFACE            | no                                                         |
| MACHINE            | no                                                         |
| KEPT_OUT           | no: a person said so                                       |
| BLIND              | no: losing evidence never makes a block overridable        |
| OUTSIDE_GRID       | no                                                         |
| UNSEEN             | yes                                                        |
"""

from collections.abc import Iterable
from dataclasses import dataclass
from enum import Enum
from typing import Any, Self

from elbowroom.errors import InputError
from elbowroom.motion.braking import safe_share
from elbowroom.motion.motion import JointPath, Motion


class Level(Enum):
    """What to do; the value is the sentence that an operator reads. In order of caution."""

    STOP = "Stop: the way is blocked within the braking distance."
    DECELERATE = "Slow down: the way is blocked within two braking distances."
    INFORM = "Take care: the way is blocked within five braking distances."
    CLEAR = "Clear: nothing in the way within five braking distances."

    @property
    def rank(self) -> int:
        """0 for STOP, rising to 3 for CLEAR: the lower, the more cautious."""
        return list(Level).index(self)

    @property
    def band(self) -> str:
        """The thesis' letter for the distance: "S", "M", "L", or "0" when no collision is found."""
        return "SML0"[self.rank]

    @classmethod
    def at(cls, free_travel: float, braking_distance: float) -> "Level":
        """The level of a way that is blocked after `free_travel` [the same unit as the braking distance]."""
        for level, distances in ((cls.STOP, 1), (cls.DECELERATE, 2), (cls.INFORM, 5)):
            if not free_travel > distances * braking_distance:
                return level
        return cls.CLEAR


class Cause(Enum):
    """What ends the free travel; the value is the phrase that an operator reads."""

    SURFACE = "something seen there"
    BLIND = "a camera that looks there delivers nothing valid"
    OUTSIDE_GRID = "the machine would leave the watched space"
    MACHINE = "another part of the machine"
    UNSEEN = "nobody sees that space"
    KEPT_OUT = "a zone that the machine is kept out of"
    NONE = "nothing"
    FAULT = "this program failed, so nothing is known"
    STALE = "what was seen is too old by now"
    INPUT = "what came in cannot be right"
    WATCH = "a camera or the machine is not where it should be"
    OFF_PATH = "the machine is not where the path that it means to take begins"

    @property
    def rank(self) -> int:
        """0 for a fault, rising to 4 for what was seen: the lower, the more cautious."""
        return {Cause.FAULT: 0, Cause.STALE: 1, Cause.INPUT: 2, Cause.WATCH: 3, Cause.OFF_PATH: 3}.get(
            self, 4
        )


@dataclass(frozen=True, slots=True)
class Creep:
    """How far an operator who holds on may creep into space that nobody sees, by the motion's own unit.

    Args:
        speed: of the joint, at most [per second].
        braking_distance: S at that speed.
        travel: from where the machine stands: to what ends the way beyond the unseen space, less `braking_distance`.
        cause: what ends it there; NONE: nothing within the motion's reach, or a joint limit.
        link, place_in_world: as of `Verdict`.
    """

    speed: float
    braking_distance: float
    travel: float
    cause: Cause
    link: str | None = None
    place_in_world: tuple[float, float, float] | None = None

    def row(self) -> dict[str, Any]:
        """As a row has it."""
        return {
            "speed": self.speed,
            "braking_distance": self.braking_distance,
            "travel": self.travel,
            "cause": self.cause.name.lower(),
            "link": self.link,
            "place_m": self.place_in_world,
        }


@dataclass(frozen=True, slots=True)
class Verdict:
    """The answer for one motion.

    Args:
        motion: what was asked.
        level: what to do.
        free_travel: how far the motion may go, at most its reach, never more than the truth
            [free_travel_unit].
        free_travel_unit: "m", "rad", or "m or rad" for a path whose joints are of both kinds.
        link: the link that meets the block; None: none does.
        place_in_world: centre of the blocked voxel, the link's point that leaves the grid, or where two links meet [m];
            None: no block.
        cause: what the block is. NONE also where a joint limit, not a block, ends the travel. FAULT, STALE, INPUT
            and WATCH are no blocks: whatever the space is, nothing may move.
        other_link: the link of the machine that `link` meets, where that ends the travel; None: it is none.
        escapes: the motion leads out of blocked space that its links reach into where they stand, or along it.
        zone: the zone that `link` is kept out of, where that ends the travel; None: it is none.
        creep: of a stop by unseen space, how far an operator may creep (`with_creep`); None: not at all, or not asked.
    """

    motion: Motion | JointPath
    level: Level
    free_travel: float
    free_travel_unit: str
    link: str | None
    place_in_world: tuple[float, float, float] | None
    cause: Cause
    other_link: str | None = None
    escapes: bool = False
    zone: str | None = None
    creep: Creep | None = None

    @classmethod
    def stop(cls, motion: Motion | JointPath, free_travel_unit: str, cause: Cause) -> Self:
        """Stop where it stands, for a reason that lies nowhere in the space.

        Args:
            motion: what was asked.
            free_travel_unit: "m", "rad", or "m or rad".
            cause: why.
        """
        return cls(motion, Level.STOP, 0.0, free_travel_unit, None, None, cause)

    @property
    def band(self) -> str:
        """The thesis' letter: "S", "M", "L", or "0"."""
        return self.level.band

    @property
    def safe_speed(self) -> float:
        """The greatest share of full speed, 0 to 1, whose stopping travel fits into the free travel (`safe_share`).

        The stopping travel, reaction and braking, has to fit into the free travel less the motion's clearance. A
        joint limit holds nothing back: whoever drives the joint stops it there. Where nothing is met within a reach
        that is shorter than the stopping travel, the reach counts as blocked. It does not change the level: a stop may
        have a safe speed above 0, at which the machine would still rest before the block.
        """
        motion = self.motion
        reaction, clearance, looked_at = 0.0, 0.0, motion.reach
        if isinstance(motion, Motion):
            reaction, clearance, looked_at = motion.reaction_distance, motion.clearance, motion.looked_at
        if self.cause is Cause.NONE and (looked_at is None or self.free_travel < looked_at):
            return 1.0
        return safe_share(self.free_travel - clearance, reaction + motion.braking_distance)

    @property
    def overridable(self) -> bool:
        """Whether an operator who holds on may drive on at low speed: only into space that nobody sees."""
        return self.cause is Cause.UNSEEN

    def row(self) -> dict[str, Any]:
        """As a row of results; `free_travel` and `braking_distance` are in `free_travel_unit`."""
        motion = self.motion
        joint, direction = (
            (motion.name, None)
            if isinstance(motion, JointPath)
            else (motion.joint, "-+"[motion.direction > 0])
        )
        return {
            "joint": joint,
            "direction": direction,
            "level": self.level.name.lower(),
            "band": self.band,
            "free_travel": self.free_travel,
            "free_travel_unit": self.free_travel_unit,
            "braking_distance": motion.braking_distance,
            "safe_speed": self.safe_speed,
            "cause": self.cause.name.lower(),
            "overridable": self.overridable,
            "link": self.link,
            "place_m": self.place_in_world,
            "other_link": self.other_link,
            "escapes": self.escapes,
            "zone": self.zone,
            "creep": None if self.creep is None else self.creep.row(),
        }


def most_cautious(verdicts: Iterable[Verdict]) -> Verdict:
    """The verdict that wins over the others, by the table above.

    Raises:
        InputError: no verdict.
    """
    every = list(verdicts)
    if not every:
        raise InputError("most_cautious: no verdicts; without a verdict the machine must stop")
    return min(
        every,
        key=lambda v: (v.level.rank, v.cause.rank, v.overridable, v.free_travel / v.motion.braking_distance),
    )
