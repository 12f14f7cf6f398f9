"""The decision per voxel: free, surface, or unseen. Everything but free is blocked."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

from elbowroom.errors import EvidenceError, GridError
from elbowroom.geometry import VoxelGrid, bits
from elbowroom.geometry.bits import Words
from elbowroom.machine import Machine, body_words
from elbowroom.reconstruct.point_report import PointReport

Index = tuple[int, int, int]
"""Of a voxel, (i, j, k)."""
NO_PARTS = np.uint64(0)


class Source(Protocol):
    """What a free space was made of, where that can be asked again: images here, or somebody who has them."""

    def report(self, space: "FreeSpace", index: Index) -> PointReport:
        """What each camera saw at a voxel of the space made of it."""

    def free_parts(self, space: "FreeSpace", index: Index) -> np.uint64:
        """Which of 64 parts of a voxel of the space are free, though all of it is not: a word."""


@dataclass(frozen=True, slots=True, eq=False)
class FreeSpace:
    """Which voxels were seen to be free, and why the others were not.

    The planes hold one bit a voxel (`geometry.bits`); bits beyond the grid are zero. `free`, `surface` and `unseen`
    share the grid out among them. `blind` marks blocked voxels that are disputed for want of valid pixels or frames.

    Args:
        grid: the watched box.
        free_words: declared free.
        surface_words: blocked, and some camera measured a surface there.
        blind_words: blocked, disputed by a camera that delivered nothing valid there.
        disputed_words: blocked, and a camera that looks there could not say "through", for whatever reason.
        body_words: made free because the machine's own grown body covers it.
        declared: for each of the machine's contacts, what is free for the links that may be near its thing; none: the
            space was not made of images.
        looked_at: blocks of 4 voxels that cameras were asked of, bool, in the planes' order; None: all.
        source: what it was made of, for `explain` and for looking again; None: it comes from elsewhere, or was let go
            of.
    """

    grid: VoxelGrid
    free_words: Words
    surface_words: Words
    blind_words: Words
    disputed_words: Words
    body_words: Words = field(default_factory=lambda: np.zeros(0, dtype=np.uint64))
    source: Source | None = None
    looked_at: NDArray[np.bool_] | None = None
    declared: tuple[Words, ...] = ()

    def __post_init__(self) -> None:
        for name in ("free_words", "surface_words", "blind_words", "disputed_words", "body_words"):
            words = getattr(self, name)
            if words.size == 0:
                words = bits.empty(self.grid)
            words = words.view()
            words.setflags(write=False)
            object.__setattr__(self, name, words)

    @classmethod
    def from_occupied(cls, grid: VoxelGrid, occupied: NDArray[np.bool_]) -> "FreeSpace":
        """A volume that comes from elsewhere, such as ground truth: occupied is surface, all else is free.

        Args:
            grid: the watched box.
            occupied: bool, shape of the grid, index order x, y, z.

        Raises:
            GridError: the array has another shape or is not boolean.
        """
        surface = bits.pack(occupied, grid)
        nothing = bits.empty(grid)
        return cls(grid, ~surface & bits.inside(grid), surface, nothing, surface)

    def without(self, machine: Machine, joints: Mapping[str, float]) -> "FreeSpace":
        """The same space with the voxels that the machine's grown body covers made free.

        Args:
            machine: whose body to take out.
            joints: its joint positions by name [m or rad].
        """
        body = body_words(machine, joints, self.grid)
        keep = ~body
        return FreeSpace(
            self.grid,
            self.free_words | body,
            self.surface_words & keep,
            self.blind_words & keep,
            self.disputed_words & keep,
            self.body_words | body,
            self.source,
            self.looked_at,
            self.declared,
        )

    @property
    def blocked_words(self) -> Words:
        """Every voxel of the grid that is not free."""
        return ~self.free_words & bits.inside(self.grid)

    @property
    def free(self) -> NDArray[np.bool_]:
        """Declared free, shape of the grid, index order x, y, z."""
        return bits.unpack(self.free_words, self.grid)

    @property
    def surface(self) -> NDArray[np.bool_]:
        """Blocked by something that a camera measured there, shape of the grid."""
        return bits.unpack(self.surface_words, self.grid)

    @property
    def unseen(self) -> NDArray[np.bool_]:
        """Blocked, without a surface: nobody could say that it is free. Shape of the grid."""
        return bits.unpack(self.blocked_words & ~self.surface_words, self.grid)

    def released(self) -> "FreeSpace":
        """The same space without what it was made of: it keeps no images; nothing is explained or looked at again."""
        return replace(self, source=None)

    def free_parts(self, index: Index) -> np.uint64:
        """Which of 64 parts of a blocked voxel are free, by what the space was made of.

        Args:
            index: of the voxel.

        Returns:
            A word: bit (16 i + 4 j + k) is of the part i, j, k steps from the voxel's least corner.
        """
        return NO_PARTS if self.source is None else self.source.free_parts(self, index)

    def explain(self, point_in_world: ArrayLike) -> PointReport:
        """What each camera saw at one point's voxel, and which camera could settle it.

        Args:
            point_in_world: shape (3,), world frame [m].

        Raises:
            GridError: the point lies outside the grid.
            EvidenceError: there are no frames at hand, as for a volume that comes from elsewhere.
        """
        if self.source is None:
            raise EvidenceError("explain: no frames at hand, this space was not made from frames of cameras")
        point = np.asarray(point_in_world, dtype=float)
        if point.shape != (3,) or not np.isfinite(point).all():
            raise GridError(f"explain: point is {point.tolist()}, must be three finite numbers [m]")
        if not self.grid.contains(point):
            raise GridError(
                f"explain: point {point.tolist()} lies outside the grid from {self.grid.lower_m.tolist()} "
                f"to {self.grid.upper_m.tolist()}"
            )
        i, j, k = (int(n) for n in self.grid.index_of(point))
        return self.source.report(self, (i, j, k))

    def state_of(self, index: Index) -> str:
        """What a voxel is: "free", "surface", "unseen", or "the machine itself"."""
        word, bit = bits.place_of(index, self.grid)
        if self.body_words[word] & bit:
            return "the machine itself"
        if self.free_words[word] & bit:
            return "free"
        return "surface" if self.surface_words[word] & bit else "unseen"
