"""Which parts of a camera's view give returns: as commissioned, or as in its first good moments."""

from dataclasses import dataclass, replace
from typing import Self

import numpy as np
from numpy.typing import NDArray

from elbowroom.monitor.health.streams.thumb import Thumb

MOMENTS = 10
"""Where nothing was commissioned, so many images say what a camera sees."""
USUAL = 0.5
"""A tile counts where so many of its pixels usually return."""
LOST = 0.3
"""It is lost where fewer than this part of them do."""
COVERED, PARTLY = 0.8, 0.1
"""A camera is covered where so many of its tiles are lost, and partly from the lesser share on."""
LEAST_TILES, LEAST_SPOTS = 4, 5
NOTHING = 0.02
"""An image with fewer returns than this is none."""


@dataclass(frozen=True, slots=True, eq=False)
class Cover:
    """What share of each tile returns as a rule.

    Args:
        usual: shape (tile rows, tile columns), 0 where it is not known.
        counted: which pixels of the small image count, shape (rows, columns).
        many: how many of each tile do, shape as of `usual`.
        fixed: which tiles were commissioned, shape as of `usual`.
        moments: how many images said what the others do; at `MOMENTS` it is settled.
    """

    usual: NDArray[np.float32]
    counted: NDArray[np.bool_]
    many: NDArray[np.float32]
    fixed: NDArray[np.bool_]
    moments: int = 0

    @classmethod
    def commissioned(cls, spots: Thumb) -> "Cover":
        """By spots of surfaces that stood still, all of which return; a tile with few of them is learnt.

        Args:
            spots: depth where there is a spot, 0 elsewhere.
        """
        fixed = _in_blocks(spots.returned_per_tile) >= LEAST_SPOTS
        side = -(-len(spots.depth_m) // len(fixed)), -(-spots.depth_m.shape[1] // fixed.shape[1])
        within = np.kron(fixed, np.ones(side, dtype=np.bool_))[tuple(map(slice, spots.depth_m.shape))]
        counted = spots.returned | ~within
        return cls(fixed.astype(np.float32), counted, _shared(spots.per_tile(counted), fixed), fixed)

    @classmethod
    def unknown(cls, thumb: Thumb) -> "Cover":
        """Before any image of this size was seen."""
        nothing = np.zeros_like(thumb.tile_sizes)
        every = np.ones(thumb.depth_m.shape, dtype=np.bool_)
        return cls(nothing, every, thumb.tile_sizes, nothing > 0)

    @property
    def is_settled(self) -> bool:
        """Whether it is known what the camera sees."""
        return self.moments >= MOMENTS

    def learning(self, thumb: Thumb) -> Self:
        """The same once one more image was seen; a settled one stays."""
        if self.is_settled:
            return self
        mean = (self.usual * self.moments + self._shares(thumb)) / (self.moments + 1)
        return replace(self, usual=np.where(self.fixed, self.usual, mean), moments=self.moments + 1)

    def lost(self, thumb: Thumb) -> float | None:
        """Of tiles that return as a rule, the share that does not; None: too few do to tell."""
        known = self.usual >= USUAL
        if np.count_nonzero(known) < LEAST_TILES:
            return None
        return float((self._shares(thumb)[known] < LOST * self.usual[known]).mean())

    def _shares(self, thumb: Thumb) -> NDArray[np.float32]:
        """Of the pixels that count, the share of each tile that returns."""
        found: NDArray[np.float32] = (
            _shared(thumb.per_tile(thumb.returned & self.counted), self.fixed) / self.many
        )
        return found


def _shared(counts: NDArray[np.float32], fixed: NDArray[np.bool_]) -> NDArray[np.float32]:
    """Counts of tiles; of those that were commissioned, where there are few spots, those of their block."""
    return np.where(fixed, _in_blocks(counts), counts) if fixed.any() else counts


def _in_blocks(counts: NDArray[np.float32]) -> NDArray[np.float32]:
    """The sum over the block of two by two tiles that each tile is in, shape as of the counts."""
    rows, columns = counts.shape
    padded = np.zeros((rows + rows % 2, columns + columns % 2), np.float32)
    padded[:rows, :columns] = counts
    sums = padded[::2] + padded[1::2]
    padded[::2] = padded[1::2] = (sums[:, ::2] + sums[:, 1::2]).repeat(2, axis=1)
    return padded[:rows, :columns]
