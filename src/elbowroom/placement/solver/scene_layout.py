"""A choice of candidates by what it finds in random scenes, in place of the rule of the empty room."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Self

import numpy as np
from numpy.typing import NDArray

from elbowroom.placement.solver.kernels import scenes as kernels


@dataclass(frozen=True, slots=True, eq=False)
class SceneModel:
    """What each candidate says of each voxel of all scenes, one after the other.

    Args:
        through: planes of voxels that the candidate sees through, uint64, shape (candidates, words).
        disputed: planes of those that it disputes.
        truly: plane of the truly free voxels, uint64, shape (words,).
        points: number of truly free voxels.
        place_of, price, kept: as of `Model`.
    """

    through: NDArray[np.uint64]
    disputed: NDArray[np.uint64]
    truly: NDArray[np.uint64]
    points: int
    place_of: NDArray[np.int64]
    price: NDArray[np.float64]
    kept: tuple[int, ...] = ()

    @property
    def candidates(self) -> int:
        """Number of candidates."""
        return len(self.through)

    @property
    def share_bound(self) -> float:
        """No layout finds more than this: what any candidate sees through, as a share of the truly free, 0 to 1."""
        seen = np.bitwise_or.reduce(self.through, axis=0) & self.truly
        return float(np.unpackbits(seen.view(np.uint8)).sum()) / self.points

    def camera_bound(self, share: float) -> float:
        """No layout with this share has fewer cameras: each frees no more than what it sees through."""
        alone = np.sort([np.unpackbits((t & self.truly).view(np.uint8)).sum() for t in self.through])[::-1]
        enough = np.cumsum(alone) >= share * self.points - 1e-6
        return float(np.argmax(enough) + 1) if enough.any() else np.inf

    def empty(self) -> "SceneLayout":
        """The layout of those that are kept alone."""
        return SceneLayout.of(self, ())


@dataclass(slots=True, eq=False)
class SceneLayout:
    """Chosen candidates and what they find together; the same to the search as a `Layout`.

    Args:
        model: scenes and candidates.
        chosen: indices of candidates, one a place; those that are kept come first.
        state: seen through by at least one, two, three, and disputed, uint64, shape (4, words).
        valid: number of truly free voxels that are found.
    """

    model: SceneModel
    chosen: list[int]
    state: NDArray[np.uint64]
    valid: float

    @classmethod
    def of(cls, model: SceneModel, chosen: Sequence[int]) -> Self:
        """The layout of these candidates, and of those that are kept."""
        layout = cls(
            model, list(dict.fromkeys((*model.kept, *chosen))), np.zeros((4, len(model.truly)), np.uint64), 0
        )
        layout._update()
        return layout

    def _update(self) -> None:
        kernels.gather(
            self.model.through, self.model.disputed, np.array(self.chosen, dtype=np.int64), self.state
        )
        self.valid = int(kernels.count_free(self.state, self.model.truly))

    @property
    def share(self) -> float:
        """Share of truly free voxels that is found, 0 to 1."""
        return self.valid / self.model.points

    @property
    def value(self) -> float:
        """The same: what the search compares."""
        return self.share

    @property
    def price(self) -> float:
        """Of all that is chosen and not there already."""
        return float(sum(self.model.price[c] for c in self.chosen if c not in self.model.kept))

    def without(self, members: Sequence[int]) -> Self:
        """The layout without some of its candidates."""
        rest = [c for c in self.chosen if c not in members]
        return type(self).of(self.model, rest)

    def add(self, candidate: int) -> None:
        """Takes a candidate in."""
        self.chosen.append(candidate)
        self._update()

    def gains(self) -> NDArray[np.float64]:
        """How many voxels more each candidate would find, shape (candidates,); -1 where its place is taken."""
        counts = np.zeros(self.model.candidates, dtype=np.uint64)
        kernels.count_with_each(self.model.through, self.model.disputed, self.state, self.model.truly, counts)
        gain = counts.astype(np.float64) - self.valid
        if self.chosen:
            gain[np.isin(self.model.place_of, self.model.place_of[self.chosen])] = -1.0
        return gain

    def losses(self) -> NDArray[np.float64]:
        """How many voxels would be lost without each member, shape (len(chosen),)."""
        return np.array([self.valid - self.without([c]).valid for c in self.chosen], dtype=np.float64)
