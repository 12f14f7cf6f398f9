"""People who walk rounds: along straight lines at walking speed, slower through the corners, as people do."""

from dataclasses import dataclass
from functools import cache, cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from elbowroom.errors import InputError
from elbowroom.simulate.person import STRIDE_M, Person, Stance

STEP_M = 0.01
"""Rounds are followed in steps of this length [m]."""
SIDEWAYS_M_S2 = 2.5
"""What people bear sideways in a corner [m/s^2]."""
ALONG_M_S2 = 2.0
"""How fast they speed up and slow down [m/s^2]."""


class _Course(NamedTuple):
    """A round: length walked [m], when [s], where (n, 2) [m], direction [rad]; closed, so the last is the first."""

    walked_m: NDArray[np.float64]
    time_s: NDArray[np.float64]
    place: NDArray[np.float64]
    heading_rad: NDArray[np.float64]


@dataclass(frozen=True)
class Rounds:
    """A closed path of straight lines with rounded corners, walked round and round.

    Args:
        corners_m: (x, y) of each, in the order in which they are passed, world frame [m].
        speed_m_s: on the lines, where they are long enough to reach it.
        radius_m: of the corners; less where lines are short.
        start: which share of a round is walked at time 0.

    Raises:
        InputError: fewer than three corners, or a speed or radius that is not above 0.
    """

    corners_m: tuple[tuple[float, float], ...]
    speed_m_s: float = 1.4
    radius_m: float = 0.3
    start: float = 0.0

    def __post_init__(self) -> None:
        if len(self.corners_m) < 3:
            raise InputError(f"rounds: {len(self.corners_m)} corners, at least 3 are needed")
        if not (self.speed_m_s > 0 and self.radius_m > 0):
            raise InputError("rounds: speed and radius must be above 0")

    @property
    def period_s(self) -> float:
        """Time of one round [s]."""
        return float(self._course.time_s[-1])

    def at(self, time_s: float) -> Stance:
        """Where the walker is at a time [s]."""
        course = self._course
        rounds, rest = divmod(time_s / self.period_s + self.start, 1.0)
        walked = float(np.interp(rest * self.period_s, course.time_s, course.walked_m))
        x, y = (float(np.interp(walked, course.walked_m, course.place[:, axis])) for axis in (0, 1))
        heading = float(np.interp(walked, course.walked_m, course.heading_rad))
        whole = rounds * float(course.walked_m[-1])
        return Stance(x, y, heading, float(2 * np.pi * (whole + walked) / STRIDE_M))

    @cached_property
    def _course(self) -> _Course:
        place, curvature = _outline(self.corners_m, self.radius_m)
        steps = np.roll(place, -1, axis=0) - place
        lengths = np.linalg.norm(steps, axis=1)
        heading = np.unwrap(np.arctan2(steps[:, 1], steps[:, 0]))
        most = np.minimum(self.speed_m_s, np.sqrt(SIDEWAYS_M_S2 / np.maximum(curvature, 1e-9)))
        speed = _reached(most, lengths)
        between = (speed + np.roll(speed, -1)) / 2
        turn = heading[0] - heading[-1]
        last = heading[-1] + (turn + np.pi) % (2 * np.pi) - np.pi
        return _Course(
            np.append(0.0, np.cumsum(lengths)),
            np.append(0.0, np.cumsum(lengths / between)),
            np.vstack([place, place[:1]]),
            np.append(heading, last),
        )


def _outline(corners_m: tuple[tuple[float, float], ...], radius_m: float) -> tuple[NDArray[np.float64], ...]:
    """Points along a closed path with rounded corners, (n, 2) [m], and how much it curves there, (n,) [1/m]."""
    corners = np.array(corners_m, dtype=float)
    points, curvatures = list[NDArray[np.float64]](), list[float]()
    for before, corner, after in zip(
        np.roll(corners, 1, axis=0), corners, np.roll(corners, -1, axis=0), strict=True
    ):
        back, on = before - corner, after - corner
        half = np.arccos(np.clip(back @ on / np.linalg.norm(back) / np.linalg.norm(on), -1, 1)) / 2
        off = min(radius_m / np.tan(half), 0.5 * np.linalg.norm(back), 0.5 * np.linalg.norm(on))
        radius = off * np.tan(half)
        first, last = (corner + off * way / np.linalg.norm(way) for way in (back, on))
        middle = corner + (back / np.linalg.norm(back) + on / np.linalg.norm(on)) * off / (
            2 * np.cos(half) ** 2
        )
        a, b = first - middle, last - middle
        turn = np.arctan2(a[0] * b[1] - a[1] * b[0], a @ b)
        if points:
            _line(points, curvatures, first)
        for share in np.linspace(0, 1, max(2, int(abs(turn) * radius / STEP_M)), endpoint=False):
            c, s = np.cos(share * turn), np.sin(share * turn)
            points.append(middle + np.array([c * a[0] - s * a[1], s * a[0] + c * a[1]]))
            curvatures.append(1 / radius)
        points.append(last)
        curvatures.append(0.0)
    _line(points, curvatures, points[0])
    return np.array(points), np.array(curvatures)


def _line(points: list[NDArray[np.float64]], curvatures: list[float], to: NDArray[np.float64]) -> None:
    """Goes on straight to a point, which is left out."""
    since = points[-1]
    for share in np.linspace(0, 1, max(2, int(np.linalg.norm(to - since) / STEP_M)), endpoint=False)[1:]:
        points.append(since + share * (to - since))
        curvatures.append(0.0)


def _reached(most: NDArray[np.float64], lengths: NDArray[np.float64]) -> NDArray[np.float64]:
    """Speeds at points of a closed path that nobody has to speed up or slow down too hard for [m/s].

    Args:
        most: that is allowed at each point [m/s].
        lengths: from each point to the next [m].
    """
    speed, n = most.copy(), len(most)
    for _ in range(2):  # round twice: the first round does not know of its own end
        for i in range(n):
            j = (i + 1) % n
            speed[j] = min(speed[j], np.sqrt(speed[i] ** 2 + 2 * ALONG_M_S2 * lengths[i]))
        for j in range(n - 1, -1, -1):
            i = (j + 1) % n
            speed[j] = min(speed[j], np.sqrt(speed[i] ** 2 + 2 * ALONG_M_S2 * lengths[j]))
    return speed


@cache
def walking_staff() -> tuple[Person, ...]:
    """The staff of the intervention room on their feet: they walk at 1.2 to 1.6 m/s beside the machine's course."""
    upper = ((-1.2, 0.97), (0.62, 0.97), (0.62, 1.63), (-1.2, 1.63))
    lower = ((1.5, -0.95), (-0.5, -0.95), (-0.5, -1.3), (1.5, -1.3))
    return (
        Person("doctor", Rounds(upper, 1.6, 0.33), 1.80, phases=PHASES),
        Person("nurse 1", Rounds(lower, 1.3, 0.175), 1.68, phases=PHASES),
        Person("nurse 2", Rounds(upper, 1.6, 0.33, start=0.5), 1.72, phases=PHASES),
    )


PHASES = 48
"""A stride of people on their feet has so many shapes, so that hands and feet move by less than a palm from one to the
next."""
