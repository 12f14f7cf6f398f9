"""A machine that moves one joint at a time, as its verdicts allow; it speeds up no faster than it brakes."""

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from elbowroom.evaluate.lag.moves import Move, Moves
from elbowroom.motion import Level, Motion

SHARES = {Level.STOP: 0.0, Level.DECELERATE: 0.5, Level.INFORM: 1.0, Level.CLEAR: 1.0}
"""Of full speed, by level."""
PATIENCE_S = 1.0
"""After standing still for so long the machine turns back."""
NEAR = 1e-4
"""A joint that is so near has arrived [m or rad]."""


@dataclass(slots=True, eq=False)
class Drive:
    """Where the machine is, and what it is about to do.

    Args:
        moves: that it may choose from.
        motions: by joint and direction, with braking distances.
        speeds: full speeds by joint [m/s or rad/s].
        rng: chooses.
    """

    moves: Moves
    motions: Mapping[tuple[str, int], Motion]
    speeds: Mapping[str, float]
    rng: np.random.Generator
    joints: dict[str, float] = field(init=False)
    share: float = field(default=0.0, init=False)
    _move: Move = field(init=False)
    _stood_s: float = field(default=0.0, init=False)

    def __post_init__(self) -> None:
        self.joints = dict(self.moves.poses[0])
        self._move = self._next(0)

    @property
    def target(self) -> float:
        """Of the joint that moves [m or rad]."""
        return float(self.moves.poses[self._move.end][self._move.joint])

    @property
    def motion(self) -> Motion:
        """What it is about to do."""
        way = 1 if self.target >= self.joints[self._move.joint] else -1
        return self.motions[self._move.joint, way]

    def step(self, level: Level, step_s: float) -> None:
        """Goes on for a while.

        Args:
            level: of the motion, as it was decided.
            step_s: for how long [s].
        """
        joint, full = self._move.joint, self.speeds[self._move.joint]
        braking_time_s = 2 * self.motion.braking_distance / full
        left = abs(self.target - self.joints[joint])
        # what is left is enough to stop in
        allowed = min(SHARES[level], np.sqrt(left / self.motion.braking_distance))
        most = step_s / braking_time_s
        self.share = float(np.clip(allowed, self.share - most, self.share + most))
        way = min(left, self.share * full * step_s)
        self.joints[joint] += self.motion.direction * way
        if left - way <= NEAR:
            self.joints[joint] = self.target
            self.share, self._move = 0.0, self._next(self._move.end)
        self._stood_s = self._stood_s + step_s if self.share == 0.0 else 0.0
        if self._stood_s > PATIENCE_S:
            self._stood_s, self._move = 0.0, Move(self._move.end, self._move.start, joint)

    def _next(self, pose: int) -> Move:
        choices = self.moves.after(pose)
        return choices[int(self.rng.integers(len(choices)))]
