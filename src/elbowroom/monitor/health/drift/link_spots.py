"""What all cameras see of one link, and whether it is where the joints say."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Self

import numpy as np
from numpy.typing import NDArray

from elbowroom.monitor.health.drift.body_view import BodySpots
from elbowroom.monitor.health.drift.fit import MOVE_PRIOR_M, TURN_PRIOR_RAD, convinces
from elbowroom.monitor.health.drift.kernels.watch import Fit, fit_motion
from elbowroom.monitor.health.health import LinkHealth

TOLERANCE_M = 0.015
SHOWN_M = 0.004
"""Motions that are known no better than this are left out."""
LEAST_SPOTS = 8
"""A camera sees a link with so many spots, at least."""
AGREE = 0.6
"""So many of the cameras that see a link must say the same, at least two."""


@dataclass(frozen=True, slots=True, eq=False)
class LinkSpots:
    """Spots of several cameras on one link, one camera after the other, n in all.

    Args:
        parts: which spots are whose, by camera: indices.
        arm: from the middle of the spots to each, shape (n, 3) [m], the link's frame.
        jacobian: offset along the normal per turn about that middle [m/rad] and per move, shape (n, 6).
        offset: how much nearer the surface is seen, along the normal, shape (n,) [m].
        sigma: of one return, along the normal, shape (n,) [m].
    """

    parts: Mapping[str, NDArray[np.int64]]
    arm: NDArray[np.float64]
    jacobian: NDArray[np.float64]
    offset: NDArray[np.float64]
    sigma: NDArray[np.float64]

    @classmethod
    def of(cls, number: int, seen: Mapping[str, BodySpots]) -> Self | None:
        """The spots of a link in what some cameras saw of the machine; None: no camera sees it.

        Args:
            number: of the link.
            seen: by camera.
        """
        mine = {name: np.flatnonzero(spots.link == number) for name, spots in seen.items()}
        mine = {name: rows for name, rows in mine.items() if len(rows) >= LEAST_SPOTS}
        if not mine:
            return None

        def together(column: str) -> NDArray[np.float64]:
            return np.concatenate([getattr(seen[name], column)[rows] for name, rows in mine.items()])

        point, normal = together("point_in_link"), together("normal_in_link")
        ends = np.cumsum([len(rows) for rows in mine.values()])
        parts = dict(zip(mine, np.split(np.arange(ends[-1]), ends[:-1]), strict=True))
        arm = point - point.mean(axis=0)
        jacobian = np.hstack([np.cross(arm, normal), normal])
        return cls(parts, arm, jacobian, together("offset_m"), together("sigma_m"))

    def health(self, link: str) -> LinkHealth:
        """Whether the link is where the joints say; only what is seen along a normal is known to be off.

        Args:
            link: its name.
        """
        every = np.arange(len(self.offset))
        fit = fit_motion(self.jacobian, self.offset, self.sigma, every, TURN_PRIOR_RAD, MOVE_PRIOR_M)
        motion = self._shown(fit)
        shifted = np.cross(motion[:3], self.arm) + motion[3:]
        off_m = float(np.sqrt((shifted**2).sum(axis=1).mean()))
        shown_m = float(np.sqrt(((self.jacobian @ motion) ** 2).mean()))
        agree = tuple(name for name, rows in self.parts.items() if self._says_off(rows, motion))
        is_off = (
            off_m > TOLERANCE_M
            and shown_m > TOLERANCE_M / 3
            and convinces(fit)
            and len(agree) >= max(2, AGREE * len(self.parts))
        )
        if not is_off and len(self.parts) < 2:
            return LinkHealth(link, off_m, tuple(self.parts), None)
        return LinkHealth(link, off_m, agree if is_off else tuple(self.parts), is_off)

    def _shown(self, fit: Fit) -> NDArray[np.float64]:
        """The motion without what the surfaces do not show: a cylinder's turn about its own axis, a slide along it."""
        # by how far the spots are from their middle, turns are made lengths
        arm_m = float(np.sqrt((self.arm**2).sum(axis=1).mean()))
        scale = np.array([arm_m] * 3 + [1.0] * 3)
        variances, directions = np.linalg.eigh(fit.covariance * np.outer(scale, scale))
        shown = directions[:, variances < SHOWN_M**2]
        projected: NDArray[np.float64] = (shown @ (shown.T @ (fit.motion * scale))) / scale
        return projected

    def _says_off(self, rows: NDArray[np.int64], motion: NDArray[np.float64]) -> bool:
        """Whether some spots fit the motion better than standing still; capped, so that strays count little."""
        offset, sigma = self.offset[rows], self.sigma[rows]
        still = np.minimum((offset / sigma) ** 2, 9.0).sum()
        moved = np.minimum(((offset - self.jacobian[rows] @ motion) / sigma) ** 2, 9.0).sum()
        return bool(still - moved > 9.0)
