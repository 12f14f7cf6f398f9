"""The truth of a path: when the machine's meshes first touch something on it, and which stops from it do.

Shares no code with what it checks but the machine's kinematics: curves are SciPy's, distances coal's.
"""

import heapq
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicHermiteSpline, interp1d

from elbowroom.evaluate.paths.scenes import PathScene
from elbowroom.evaluate.rooms.exact import NEAR_M, Nearest
from elbowroom.machine import Machine
from elbowroom.machine.kernels.body import FIXED, SLIDES
from elbowroom.motion import Trajectory

LEAST_STEP_M = 2e-5
"""No step along a path is shorter than what moves the fastest point by this [m]."""
LOOKS = 3
"""At so many moments before what is said to be safe stops are tried."""
STOPS, BETTER = 16, 8
"""So many stops are tried at one moment, and so many more about the one that comes nearest."""
NEAR_ENOUGH_M = 0.1
"""What stays farther away than this is not looked at closer [m]."""
WINDOW = 64
"""At so many moments of a braking time the speeds of joints are looked at."""


class ExactPath:
    """A path's curve, and what it touches.

    Args:
        scene: the path, and the room.
    """

    def __init__(self, scene: PathScene) -> None:
        self.scene, path = scene, scene.path
        self._curve = _curve(path)
        self._rates = _rates(path)

    def joints(self, time_s: float, beside: NDArray[np.float64] | float = 0.0) -> dict[str, float]:
        """Where the joints are, or a little beside that.

        Args:
            time_s: of the path; after its end it stands [s].
            beside: of each joint of the path [m or rad].
        """
        row = self._curve(min(time_s, self.scene.path.end_s)) + beside
        return self.scene.joints | dict(zip(self.scene.path.joint_names, row.tolist(), strict=True))

    def _fastest(self, link: str, other: str) -> float:
        """More than a link moves against another one, or against a solid [m/s]."""
        machine = self.scene.machine
        one = machine.link_names.index(link)
        if other not in machine.link_names:
            return _speed_of(machine, self._rates, one, set())
        two = machine.link_names.index(other)
        both = set(_chain(machine, one)) & set(_chain(machine, two))
        return sum(_speed_of(machine, self._rates, row, both) for row in (one, two))

    def first_contact(self) -> tuple[float, Nearest] | None:
        """When something is first touched on the path, and what; None: nothing is.

        A pair is looked at again when it can have met at the earliest (conservative advancement).
        """
        truth, end_s = self.scene.truth, self.scene.path.end_s
        pairs = [*truth.touchable, *self.scene.own]
        fastest = [self._fastest(*pair) for pair in pairs]
        queue = [(self.scene.path.begin_s, n) for n in range(len(pairs)) if fastest[n] > 0]
        while queue:
            time_s, n = heapq.heappop(queue)
            if time_s >= end_s:
                break
            near = truth.apart(self.joints(time_s), *pairs[n], fastest[n] * (end_s - time_s) + NEAR_M)
            if near.distance_m < NEAR_M:
                return time_s, near
            heapq.heappush(queue, (time_s + max(near.distance_m, LEAST_STEP_M) / fastest[n], n))
        return None

    def moved(self, near: Nearest, before: dict[str, float], after: dict[str, float]) -> float:
        """How far the point that touches is from where it was [m].

        Args:
            near: what touches.
            before, after: joint positions by name [m or rad].
        """
        assert near.link is not None and near.point_in_link is not None
        one, other = (self.scene.machine.world_from_links(at)[near.link] for at in (before, after))
        difference = (one - other)[:3]
        return float(np.linalg.norm(difference[:, :3] @ near.point_in_link + difference[:, 3]))

    def way(self, near: Nearest, begin_s: float, end_s: float) -> float:
        """How far the point that touches comes between two times [m].

        Args:
            near: what touches.
            begin_s, end_s: of the path [s].
        """
        places = [self.joints(time_s) for time_s in np.linspace(begin_s, end_s, 33)]
        return sum(self.moved(near, a, b) for a, b in pairwise(places))

    def speed_at(self, time_s: float) -> float:
        """How fast the fastest corner of the machine moves at a time, above 0 [m/s].

        Args:
            time_s: of the path [s].
        """
        step_s = 1e-3
        machine, most = self.scene.machine, 1e-3
        one, other = (machine.world_from_links(self.joints(time_s + n * step_s)) for n in (0, 1))
        for link in machine.links:
            if link.has_geometry:
                change = (other[link.name] - one[link.name])[:3]
                moved = link.vertices @ change[:, :3].T + change[:, 3]
                most = max(most, float(np.linalg.norm(moved, axis=1).max()) / step_s)
        return most

    def colliding_stop(
        self, time_s: float, rng: np.random.Generator
    ) -> tuple[Nearest, NDArray[np.float64]] | None:
        """A stop commanded at a time in which each joint brakes by itself and something is touched; None: none.

        Corners of the box of joint positions and places in it are tried, and then about the one that comes nearest.

        Args:
            time_s: of the path [s].
            rng: of what is tried.

        Returns:
            What touches, and how far joints are beside the path.
        """
        back, forth = self._braking_ways(time_s)
        after_s = time_s + self.scene.braking.reaction_time_s
        best, best_m, share_of_best = None, NEAR_ENOUGH_M, np.zeros(len(back))
        for n in range(STOPS + BETTER):
            share = rng.uniform(-1, 1, len(back))
            if n < STOPS // 2:
                share = np.sign(share)
            elif n >= STOPS:
                share = np.clip(share_of_best + share / (n - STOPS + 3), -1, 1)
            beside = np.where(share < 0, -share * back, share * forth)
            near = self.scene.truth.nearest(self.joints(after_s, beside), self.scene.own, best_m)
            if near.link is not None:
                best, best_m, share_of_best = (near, beside), near.distance_m, share
            if best_m < NEAR_M:
                return best
        return None

    def _braking_ways(self, time_s: float) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """How far each joint may go on after the reaction time, back (below zero) and forth, within its limits."""
        scene, names = self.scene, self.scene.path.joint_names
        begin_s = time_s + scene.braking.reaction_time_s
        half = np.array([scene.braking.times_s[name] / 2 for name in names])
        here = self._curve(min(begin_s, scene.path.end_s))
        back, forth = np.zeros(len(names)), np.zeros(len(names))
        for column, lasts_s in enumerate(half):
            times = np.minimum(begin_s + np.linspace(0, lasts_s, WINDOW), scene.path.end_s)
            ways, steps = np.diff(self._curve(times)[:, column]), np.diff(times)
            speeds = ways[steps > 0] / steps[steps > 0]
            back[column] = speeds.min(initial=0.0) * lasts_s
            forth[column] = speeds.max(initial=0.0) * lasts_s
        joints = [scene.machine.joint(name) for name in names]
        low, high = np.array([j.lower for j in joints]) - here, np.array([j.upper for j in joints]) - here
        return np.maximum(back, np.minimum(low, 0.0)), np.minimum(forth, np.maximum(high, 0.0))


def _curve(path: Trajectory) -> CubicHermiteSpline | interp1d:
    if path.velocities is not None:
        return CubicHermiteSpline(path.times_s, path.positions, path.velocities)
    return interp1d(path.times_s, path.positions, axis=0)


def _rates(path: Trajectory) -> dict[str, float]:
    """More than each joint ever moves by [m/s or rad/s]."""
    times = np.linspace(path.begin_s, path.end_s, 20 * len(path.times_s))
    rates = 1.05 * np.abs(np.diff(_curve(path)(times), axis=0)).max(axis=0) / (times[1] - times[0])
    return dict(zip(path.joint_names, rates.tolist(), strict=True))


def _chain(machine: Machine, row: int) -> list[int]:
    """A link and those above it."""
    rows = [row]
    while machine.tree.parent[rows[-1]] >= 0:
        rows.append(int(machine.tree.parent[rows[-1]]))
    return rows


def _speed_of(machine: Machine, rates: dict[str, float], row: int, still: set[int]) -> float:
    """More than any point of a link ever moves, against what links stand still [m/s]."""
    link = machine.links[row]
    arm = float(np.linalg.norm(link.vertices, axis=1).max())
    total = 0.0
    for at in _chain(machine, row):
        if at in still:
            break
        name = machine.joint_names[machine.tree.column[at]] if machine.tree.kind[at] != FIXED else ""
        slides = machine.tree.kind[at] == SLIDES
        total += rates.get(name, 0.0) * (1.0 if slides else arm)
        arm += float(np.linalg.norm(machine.tree.parent_from_joint[at, :3, 3]))
        if slides:
            arm += max(abs(machine.joint(name).lower), abs(machine.joint(name).upper))
    return total
