"""Watches whether the machine is where its joints say."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from elbowroom.geometry import DepthCamera
from elbowroom.geometry.parallel import spread
from elbowroom.machine import Machine
from elbowroom.monitor.health.drift.body_view import BodySpots, BodyView
from elbowroom.monitor.health.drift.kernels.watch import fit_motion
from elbowroom.monitor.health.drift.reference import MOVE_PRIOR_M, TURN_PRIOR_RAD
from elbowroom.monitor.health.drift.sequential import Tally
from elbowroom.monitor.health.health import LinkHealth
from elbowroom.sensing import DepthFrame

ROUND = 20
"""Passes in which every camera has looked at the machine once, and every link was judged."""
ROUNDS = 2
"""So many more rounds must say that a link is off than say, counted twice, that it is not."""
TOLERANCE_M = 0.015
SHOWN_M = 0.004
"""Motions that are known no better than this are left out."""
LEAST_SPOTS = 8
"""A camera sees a link with so many spots, at least."""
FOR_OVER_AGAINST, LEAST_FOR, LEAST_FIT = 5.0, 20.0, 0.5
AGREE = 0.6
"""So many of the cameras that see a link must say the same, at least two."""


@dataclass(slots=True, eq=False)
class BodyWatch:
    """Looks through some cameras at each pass, and judges some of the machine's links by what all showed last.

    Args:
        machine: the machine.
        cameras: of the room.
        threads: None: all cores.
    """

    machine: Machine
    cameras: Sequence[DepthCamera]
    threads: int | None = None
    stop: str | None = field(default=None, init=False)
    """Why nothing may move, once it was found; it stays."""
    _links: dict[str, LinkHealth] = field(default_factory=dict, init=False)
    _views: dict[str, BodyView] = field(init=False)
    _seen: dict[str, BodySpots] = field(default_factory=dict, init=False)
    _tallies: list[Tally] = field(init=False)
    _turn: int = field(default=0, init=False)

    def __post_init__(self) -> None:
        self._views = {camera.name: BodyView(camera, self.machine) for camera in self.cameras}
        self._tallies = [Tally(ROUNDS) for _ in self.machine.links]

    def hear(
        self, frames: Mapping[str, DepthFrame], joints_of: Mapping[str, Mapping[str, float]], still: set[str]
    ) -> None:
        """Looks through the cameras whose turn it is.

        Args:
            frames: by camera.
            joints_of: joint positions at each frame's time, by camera [m or rad].
            still: names of the cameras that stand where they were commissioned; others are not believed.

        Raises:
            MachineError: joints that are not possible.
        """
        names = [camera.name for camera in self.cameras][self._turn :: ROUND]
        looking = [name for name in names if name in frames and name in still]
        for name in names:
            self._seen.pop(name, None)
        if looking:
            positions = np.array([self.machine.positions(joints_of[name]) for name in looking])
            placed = self.machine.world_from_link_array(positions)

            def look(number: int) -> BodySpots:
                name = looking[number]
                return self._views[name].look(frames[name].depth_m, placed[number])

            looked = spread(look, range(len(looking)), self.threads)
            self._seen.update(zip(looking, looked, strict=True))
        for number in range(self._turn, len(self._tallies), ROUND):
            self._judge(number, still)
        self._turn = (self._turn + 1) % ROUND

    @property
    def links(self) -> tuple[LinkHealth, ...]:
        """What was said last of the links that some camera sees, from the base on."""
        return tuple(self._links[link.name] for link in self.machine.links if link.name in self._links)

    def _judge(self, number: int, still: set[str]) -> None:
        name = self.machine.links[number].name
        self._links.pop(name, None)
        seen = {camera: spots for camera, spots in self._seen.items() if camera in still}
        health = self._judge_link(number, seen)
        if health is not None:
            self._links[name] = health
        decided = self._tallies[number].add(None if health is None else health.is_off)
        if decided and self.stop is None:
            self.stop = self._reason()

    def _reason(self) -> str:
        """Names the link nearest to the base that is off: those behind it are carried along."""
        suspects = [
            self._links[link.name]
            for link, tally in zip(self.machine.links, self._tallies, strict=True)
            if tally.score > 0 and link.name in self._links and self._links[link.name].is_off
        ]
        first = suspects[0]
        return (
            f"the machine is not where its joints say: {first.link} is off by {first.off_m * 1e3:.0f} mm, "
            f"as {len(first.cameras)} cameras see it"
        )

    def _judge_link(self, number: int, seen: Mapping[str, BodySpots]) -> LinkHealth | None:
        """What one round says of a link; None: no camera sees it."""
        parts = {}
        for name, spots in seen.items():
            mine = np.flatnonzero(spots.link == number)
            if len(mine) >= LEAST_SPOTS:
                parts[name] = spots, mine
        if not parts:
            return None
        point = np.concatenate([spots.point_in_link[mine] for spots, mine in parts.values()])
        normal = np.concatenate([spots.normal_in_link[mine] for spots, mine in parts.values()])
        offset = np.concatenate([spots.offset_m[mine] for spots, mine in parts.values()])
        sigma = np.concatenate([spots.sigma_m[mine] for spots, mine in parts.values()])
        arm = point - point.mean(axis=0)
        jacobian = np.hstack([np.cross(arm, normal), normal])
        fit = fit_motion(jacobian, offset, sigma, np.arange(len(offset)), TURN_PRIOR_RAD, MOVE_PRIOR_M)
        arm_m = float(np.sqrt((arm**2).sum(axis=1).mean()))
        motion = _what_is_shown(fit.motion, fit.covariance, arm_m)
        shifted = np.cross(motion[:3], arm) + motion[3:]
        off_m = float(np.sqrt((shifted**2).sum(axis=1).mean()))
        shown_m = float(np.sqrt(((jacobian @ motion) ** 2).mean()))
        ends = np.cumsum([len(mine) for _, mine in parts.values()])
        agree = tuple(
            name
            for name, part in zip(parts, np.split(np.arange(len(offset)), ends[:-1]), strict=True)
            if _says_off(jacobian[part], offset[part], sigma[part], motion)
        )
        # what is not seen along any normal is not known to be off
        is_off = (
            off_m > TOLERANCE_M
            and shown_m > TOLERANCE_M / 3
            and fit.speaks_for > max(FOR_OVER_AGAINST * fit.against, LEAST_FOR)
            and fit.fits_moved >= LEAST_FIT
            and len(agree) >= max(2, AGREE * len(parts))
        )
        if not is_off and len(parts) < 2:
            return LinkHealth(self.machine.links[number].name, off_m, tuple(parts), None)
        return LinkHealth(
            self.machine.links[number].name, off_m, agree if is_off else tuple(parts), bool(is_off)
        )


def _what_is_shown(
    motion: NDArray[np.float64], covariance: NDArray[np.float64], arm_m: float
) -> NDArray[np.float64]:
    """The motion without what the surfaces do not show: a cylinder's turn about its own axis, a slide along it.

    Args:
        motion: shape (6,) [rad, m].
        covariance: of it, shape (6, 6).
        arm_m: how far the link's spots are from their middle, by which turns are made lengths [m].
    """
    scale = np.array([arm_m] * 3 + [1.0] * 3)
    variances, directions = np.linalg.eigh(covariance * np.outer(scale, scale))
    shown = directions[:, variances < SHOWN_M**2]
    projected: NDArray[np.float64] = (shown @ (shown.T @ (motion * scale))) / scale
    return projected


def _says_off(
    jacobian: NDArray[np.float64],
    offset: NDArray[np.float64],
    sigma: NDArray[np.float64],
    motion: NDArray[np.float64],
) -> bool:
    """Whether one camera's own spots fit the motion better than standing still; capped, so that strays count little."""
    still = np.minimum((offset / sigma) ** 2, 9.0).sum()
    moved = np.minimum(((offset - jacobian @ motion) / sigma) ** 2, 9.0).sum()
    return bool(still - moved > 9.0)
