"""A choice of candidates by how many motions it does not stop for nothing, in place of the free space of scenes."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from elbowroom.placement.solver.kernels import motions as kernels
from elbowroom.placement.solver.kernels.scenes import gather
from elbowroom.placement.solver.scene_layout import SceneLayout, SceneModel

FEW = 4.0
"""A motion of whose swept voxels so many are not found is worth half of one that all are found of."""


@dataclass(frozen=True, slots=True, eq=False)
class SweptModel(SceneModel):
    """What each candidate says of the voxels that motions sweep, one motion after the other.

    Args:
        through, disputed, truly, points, place_of, price, kept: as of `SceneModel`; a voxel that several motions sweep
            is there several times.
        start: where the words of each motion begin, and at last where they end, shape (motions + 1,).
        weight: what each is worth, shape (motions,).
    """

    start: NDArray[np.int64] = None  # type: ignore[assignment]
    weight: NDArray[np.float64] = None  # type: ignore[assignment]

    @property
    def share_bound(self) -> float:
        """No layout is worth more: what no candidate sees through is missing whatever is chosen, 0 to 1."""
        seen = np.bitwise_or.reduce(self.through, axis=0)
        state = np.stack([seen, seen, seen, np.zeros_like(seen)])
        worth = kernels.value_of(state, self.truly, self.start, self.weight, FEW)
        return float(worth / self.weight.sum())

    def camera_bound(self, share: float) -> float:
        """No layout of any worth has fewer cameras than one: no closer bound is known."""
        return 1.0

    def empty(self) -> SceneLayout:
        """The layout of those that are kept alone."""
        return SweptLayout.of(self, ())


@dataclass(slots=True, eq=False)
class SweptLayout(SceneLayout):
    """Chosen candidates, and what their motions are worth; the same to the search as a `SceneLayout`.

    Args:
        model: motions and candidates.
        chosen, state: as of `SceneLayout`.
        valid: worth of all motions together.
    """

    model: SweptModel

    def _update(self) -> None:
        chosen = np.array(self.chosen, dtype=np.int64)
        gather(self.model.through, self.model.disputed, chosen, self.state)
        model = self.model
        self.valid = float(kernels.value_of(self.state, model.truly, model.start, model.weight, FEW))

    @property
    def share(self) -> float:
        """Worth of the motions over what they would be worth if nothing were missing, 0 to 1."""
        return self.valid / float(self.model.weight.sum())

    def gains(self) -> NDArray[np.float64]:
        """How much more the motions are worth with each candidate, shape (candidates,); -1 where its place is taken."""
        model = self.model
        values = np.zeros(model.candidates)
        kernels.values_with_each(
            model.through, model.disputed, self.state, model.truly, model.start, model.weight, FEW, values
        )
        gain = values - self.valid
        if self.chosen:
            gain[np.isin(model.place_of, model.place_of[self.chosen])] = -1.0
        return gain
