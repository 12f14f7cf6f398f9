"""The greatest safe speed of a whole machine: the least of what its motions may."""

from collections.abc import Iterable, Mapping

from elbowroom.errors import InputError
from elbowroom.motion.motion import Motion
from elbowroom.motion.verdict import Verdict

STANDS = 1e-3
"""A joint that is slower than this stands still [m/s or rad/s]."""


def machine_speed(verdicts: Iterable[Verdict], velocities: Mapping[str, float] | None = None) -> float:
    """The greatest share of full speed that is safe for all that moves: the least `Verdict.safe_speed`, 0 to 1.

    Args:
        verdicts: of all motions that may be made; a joint path counts always.
        velocities: of the joints by name, below zero where their value falls [m/s or rad/s]: motions the other way do
            not count, nor those of joints that stand still, unless all do. A joint that is not named may move. None:
            nobody knows, so all motions count.

    Raises:
        InputError: no verdict: without one nothing may move.
    """
    every = list(verdicts)
    if not every:
        raise InputError("machine_speed: no verdicts; without a verdict the machine must stop")
    counted = every if velocities is None else [v for v in every if is_made(v, velocities)]
    return min(verdict.safe_speed for verdict in counted or every)


def is_made(verdict: Verdict, velocities: Mapping[str, float]) -> bool:
    """Whether a motion is being made at these velocities; one that is no number makes it.

    Args:
        verdict: of the motion.
        velocities: by joint [m/s or rad/s].
    """
    motion = verdict.motion
    if not isinstance(motion, Motion) or motion.joint not in velocities:
        return True
    return not velocities[motion.joint] * motion.direction < STANDS
