"""A choice of candidates and how good it is at the model's points."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from elbowroom.placement.requirement import TIE_RAD
from elbowroom.placement.solver.kernels import search as kernels
from elbowroom.placement.solver.model import Model

STEEPNESS = 4
"""A point with a of k views apart is worth (a / k) to this power: nearly valid points count a little."""


@dataclass(slots=True, eq=False)
class Layout:
    """Chosen candidates, and views apart at each point.

    Args:
        model: points and candidates.
        chosen: indices of candidates, one a place; those that are kept come first.
        apart: uint8, shape (points,).
    """

    model: Model
    chosen: list[int]
    apart: NDArray[np.uint8]

    @classmethod
    def of(cls, model: Model, chosen: Sequence[int]) -> "Layout":
        """The layout of these candidates, and of those that are kept."""
        members = list(dict.fromkeys((*model.kept, *chosen)))
        layout = cls(model, members, np.zeros(model.points, dtype=np.uint8))
        layout.update()
        return layout

    @property
    def worth(self) -> NDArray[np.float64]:
        """Value of a point by its views apart, shape (views + 1,); 1 if it is valid."""
        views = self.model.requirement.views
        return (np.arange(views + 1) / views) ** STEEPNESS

    @property
    def valid(self) -> int:
        """Number of valid points."""
        return int((self.apart >= self.model.requirement.views).sum())

    @property
    def share(self) -> float:
        """Share of valid points, 0 to 1."""
        return self.valid / self.model.points

    @property
    def value(self) -> float:
        """Mean worth of the points, 0 to 1."""
        counts = np.bincount(self.apart, minlength=len(self.worth))
        return float(counts @ self.worth) / self.model.points

    @property
    def price(self) -> float:
        """Of all that is chosen and not there already."""
        return float(sum(self.model.price[c] for c in self.chosen if c not in self.model.kept))

    @property
    def _chosen(self) -> NDArray[np.int64]:
        return np.array(self.chosen, dtype=np.int64)

    @property
    def _sights(self) -> kernels.Sights:
        return kernels.Sights(self.model.sees, self.model.azimuth, self.model.place_of)

    @property
    def _rule(self) -> kernels.Apart:
        requirement = self.model.requirement
        return kernels.Apart(math.radians(requirement.angle_deg), TIE_RAD, requirement.views)

    def update(self, points: NDArray[np.int64] | None = None) -> None:
        """Counts again, at some points or all."""
        asked = np.arange(self.model.points) if points is None else points
        kernels.apart_of_points(self._sights, self._chosen, self._rule, asked, self.apart)

    def without(self, members: Sequence[int]) -> "Layout":
        """The layout without some of its candidates."""
        kept = [c for c in self.chosen if c not in members]
        layout = Layout(self.model, kept, self.apart.copy())
        touched = (self.model.sees[list(members)].any(axis=0)) & (self.apart > 0)
        layout.update(np.flatnonzero(touched))
        return layout

    def add(self, candidate: int) -> None:
        """Takes a candidate in."""
        self.chosen.append(candidate)
        open_ = (self.model.sees[candidate] > 0) & (self.apart < self.model.requirement.views)
        self.update(np.flatnonzero(open_))

    def gains(self) -> NDArray[np.float64]:
        """What each candidate would add to the sum of worths, shape (candidates,); -1 where its place is taken."""
        model = self.model
        gain = np.zeros(model.candidates)
        asked = np.flatnonzero(self.apart < model.requirement.views)
        kernels.gains(self._sights, self._chosen, self._rule, asked, self.apart, self.worth, gain)
        if self.chosen:
            gain[np.isin(model.place_of, model.place_of[self.chosen])] = -1.0
        return gain

    def losses(self) -> NDArray[np.float64]:
        """What the sum of worths would lose without each member, shape (len(chosen),)."""
        loss = np.zeros(len(self.chosen))
        kernels.losses(self._sights, self._chosen, self._rule, self.apart, self.worth, loss)
        return loss
