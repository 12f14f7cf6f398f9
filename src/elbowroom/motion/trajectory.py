"""What a machine means to do: joint positions over time, and where it is at one moment with how fast."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Self

import numpy as np
from numpy.typing import ArrayLike, NDArray

from elbowroom.errors import JointsError

STRAIGHT = 1e-5
"""A curve between two points is cut into straight lines that are no farther from it than this [m or rad]."""
MOST_PIECES = 4096
"""Into no more lines than so many between two points."""
Values = NDArray[np.float64]


@dataclass(frozen=True, slots=True, eq=False)
class Trajectory:
    """Joint positions at rising times. Before the first one the machine stands there.

    Between two points each joint goes straight at a steady speed; with velocities along the cubic curve that has them
    (Hermite's, as `joint_trajectory_controller` of ros2_control follows it).

    Args:
        joint_names: each once.
        times_s: of the points, strictly rising, shape (n,), n at least 1 [s].
        positions: at these times, shape (n, joints) [m or rad].
        velocities: likewise [m/s or rad/s]; None: nothing is said of them.

    Raises:
        JointsError: shapes that do not fit, times that do not rise, numbers that are not finite, points so far apart
            that the curve between them is no path.
    """

    joint_names: tuple[str, ...]
    times_s: Values
    positions: Values
    velocities: Values | None

    def __init__(
        self,
        joint_names: Sequence[str],
        times_s: ArrayLike,
        positions: ArrayLike,
        velocities: ArrayLike | None = None,
    ) -> None:
        names = tuple(joint_names)
        if not names or len(set(names)) != len(names):
            raise JointsError(f"path: joint names are {list(names)}, must be at least one, each once")
        times = _finite(times_s, "times_s", (None,))
        if not len(times):
            raise JointsError("path: no points, at least one is needed")
        backward = np.flatnonzero(np.diff(times) <= 0)
        if len(backward):
            n = int(backward[0]) + 1
            raise JointsError(
                f"path: point {n} is at {times[n]:g} s after one at {times[n - 1]:g} s; times must strictly rise"
            )
        shape = (len(times), len(names))
        object.__setattr__(self, "joint_names", names)
        object.__setattr__(self, "times_s", times)
        object.__setattr__(self, "positions", _finite(positions, "positions", shape))
        given = None if velocities is None else _finite(velocities, "velocities", shape)
        object.__setattr__(self, "velocities", given)

    @property
    def begin_s(self) -> float:
        """Time of the first point [s]."""
        return float(self.times_s[0])

    @property
    def end_s(self) -> float:
        """Time of the last point [s]."""
        return float(self.times_s[-1])

    @property
    def end_velocities(self) -> Values:
        """How fast joints still are at the last point, shape (joints,) [m/s or rad/s]."""
        if self.velocities is not None:
            return self.velocities[-1]
        if len(self.times_s) == 1:
            return np.zeros(len(self.joint_names))
        speeds: Values = (self.positions[-1] - self.positions[-2]) / (self.times_s[-1] - self.times_s[-2])
        return speeds

    def straightened(self) -> Self:
        """The same in straight lines, none farther than `STRAIGHT` from the curve; itself without velocities.

        Raises:
            JointsError: two points are too far apart for the speeds that they have.
        """
        if self.velocities is None:
            return self
        times, rows = [self.times_s[:1]], [self.positions[:1]]
        for n in range(len(self.times_s) - 1):
            shares = np.linspace(0.0, 1.0, self._pieces(n) + 1)[1:]
            times.append(self.times_s[n] + shares * (self.times_s[n + 1] - self.times_s[n]))
            rows.append(self._curve(n, shares))
            times[-1][-1], rows[-1][-1] = self.times_s[n + 1], self.positions[n + 1]
        return type(self)(self.joint_names, np.concatenate(times), np.concatenate(rows))

    def _curve(self, n: int, shares: Values) -> Values:
        """Positions between two points, shape (shares, joints): cubic Hermite."""
        assert self.velocities is not None
        s, step = shares[:, None], self.times_s[n + 1] - self.times_s[n]
        found: Values = (
            (2 * s**3 - 3 * s**2 + 1) * self.positions[n]
            + (s**3 - 2 * s**2 + s) * step * self.velocities[n]
            + (3 * s**2 - 2 * s**3) * self.positions[n + 1]
            + (s**3 - s**2) * step * self.velocities[n + 1]
        )
        return found

    def _pieces(self, n: int) -> int:
        """Into how many lines the curve after a point is cut: a line is off by an eighth of what the curve bends."""
        assert self.velocities is not None
        step, way = self.times_s[n + 1] - self.times_s[n], self.positions[n + 1] - self.positions[n]
        before, after = step * self.velocities[n], step * self.velocities[n + 1]
        # the second derivative is straight: it is greatest at an end
        bend = max(
            np.abs(6 * way - 4 * before - 2 * after).max(), np.abs(6 * way - 2 * before - 4 * after).max()
        )
        pieces = int(np.ceil(np.sqrt(bend / (8 * STRAIGHT)))) if bend > 0 else 1
        if pieces > MOST_PIECES:
            raise JointsError(
                f"path: from {self.times_s[n]:g} to {self.times_s[n + 1]:g} s joints would go far off at the "
                "velocities that are given; are these per second, and in the unit of the positions?"
            )
        return max(1, pieces)

    def at(self, time_s: float) -> dict[str, float]:
        """Joint positions at a time; before the first point and after the last one as there [m or rad].

        Args:
            time_s: of the path [s].
        """
        straight = self.straightened()
        return {
            name: float(np.interp(time_s, straight.times_s, column))
            for name, column in zip(self.joint_names, straight.positions.T, strict=True)
        }

    def between(self, begin_s: float, end_s: float) -> Self:
        """The part of the path between two times, in straight lines; the machine is asked to stand at its end.

        Args:
            begin_s, end_s: of the path; beyond its ends there is nothing [s].

        Raises:
            JointsError: nothing of the path lies there.
        """
        straight = self.straightened()
        begin_s, end_s = max(begin_s, self.begin_s), min(end_s, self.end_s)
        if end_s < begin_s:
            raise JointsError(f"path: nothing of it lies between {begin_s:g} and {end_s:g} s")
        inside = (straight.times_s > begin_s) & (straight.times_s < end_s)
        times = np.unique(np.concatenate([[begin_s], straight.times_s[inside], [end_s]]))
        columns = [np.interp(times, straight.times_s, column) for column in straight.positions.T]
        return type(self)(self.joint_names, times, np.stack(columns, axis=1))


@dataclass(frozen=True, slots=True, eq=False)
class MachineState:
    """Where a machine is and how fast, as a controller says it each cycle.

    Args:
        positions: of all its joints by name [m or rad].
        velocities: likewise [m/s or rad/s]; a joint that is not named stands still.

    Raises:
        JointsError: a number that is not finite, a velocity of a joint without a position.
    """

    positions: Mapping[str, float]
    velocities: Mapping[str, float]

    def __post_init__(self) -> None:
        for what, of in (("position", self.positions), ("velocity", self.velocities)):
            for name, value in of.items():
                if not np.isfinite(value):
                    raise JointsError(f"machine's state: {what} of {name} is {value}, must be finite")
        unknown = sorted(set(self.velocities) - set(self.positions))
        if unknown:
            raise JointsError(f"machine's state: {unknown[0]} has a velocity and no position")


def _finite(given: ArrayLike, what: str, shape: tuple[int | None, ...]) -> Values:
    """As a read-only array of a shape, of which None is any."""
    try:
        values = np.array(given, dtype=np.float64)
    except (TypeError, ValueError, OverflowError):
        raise JointsError(f"path: {what} are no table of numbers") from None
    if values.ndim != len(shape) or any(n not in (m, None) for m, n in zip(values.shape, shape, strict=True)):
        raise JointsError(f"path: {what} have shape {values.shape}, must have {shape}")
    if not np.isfinite(values).all():
        row = int(np.argwhere(~np.isfinite(values))[0][0])
        raise JointsError(f"path: {what} of point {row} are not all finite numbers")
    values = np.ascontiguousarray(values)
    values.setflags(write=False)
    return values
