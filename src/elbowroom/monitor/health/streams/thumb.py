"""A depth image made small, so that a look at it takes a tenth of a millisecond."""

from dataclasses import dataclass
from functools import cached_property, lru_cache

import numpy as np
from numpy.typing import NDArray

ACROSS = 160
"""About so many pixels of a row are taken."""
TILES_ACROSS = 16
LEAST_TILE = 4
"""A tile has so many pixels of the small image along its side at least."""


@dataclass(frozen=True, eq=False)
class Thumb:
    """Every n-th pixel of an image, whole tiles of it.

    Args:
        depth_m: float32, shape (rows, columns) [m]; what is not a finite number above zero is no return.
        step: every how many pixels one is taken.
    """

    depth_m: NDArray[np.float32]
    step: int

    @classmethod
    def of(cls, depth_m: NDArray[np.float32]) -> "Thumb":
        """Of an image, shape (height, width) [m]."""
        step = max(1, depth_m.shape[1] // ACROSS)
        return cls(np.ascontiguousarray(depth_m[::step, ::step]), step)

    @cached_property
    def returned(self) -> NDArray[np.bool_]:
        """Where there is a return, shape as of `depth_m`."""
        found: NDArray[np.bool_] = (self.depth_m > 0) & (self.depth_m < np.inf)
        return found

    @cached_property
    def share(self) -> float:
        """Of pixels that have a return, from 0 to 1."""
        return np.count_nonzero(self.returned) / self.returned.size

    @cached_property
    def smooth(self) -> float:
        """Of neighbours in a row that both have a return, the share of those within a twentieth of each other."""
        left, right = self.depth_m[:, :-1], self.depth_m[:, 1:]
        both = self.returned[:, :-1] & self.returned[:, 1:]
        with np.errstate(invalid="ignore"):  # of pixels without a return, which do not count
            near = np.abs(right - left) < 0.05 * np.abs(left)
        many = int(both.sum())
        return float((near & both).sum() / many) if many else 0.0

    def per_tile(self, pixels: NDArray[np.bool_]) -> NDArray[np.float32]:
        """How many pixels of each tile are so, shape (tile rows, tile columns).

        Args:
            pixels: shape as of `depth_m`.
        """
        down, across = _sums(*self.depth_m.shape)
        # of whole numbers below 2^24, so exact in float32; a product of small matrices is the quickest sum
        found: NDArray[np.float32] = (down @ pixels.astype(np.float32)) @ across
        return found

    @cached_property
    def returned_per_tile(self) -> NDArray[np.float32]:
        """How many pixels of each tile have a return, shape (tile rows, tile columns)."""
        return self.per_tile(self.returned)

    @property
    def tile_sizes(self) -> NDArray[np.float32]:
        """How many pixels each tile has, shape (tile rows, tile columns)."""
        return _sizes(*self.depth_m.shape)


@lru_cache(maxsize=64)
def _sizes(rows: int, columns: int) -> NDArray[np.float32]:
    """As `Thumb.tile_sizes`, read-only.

    Args:
        rows, columns: of the small image.
    """
    down, across = _sums(rows, columns)
    sizes: NDArray[np.float32] = down.sum(axis=1)[:, None] * across.sum(axis=0)[None, :]
    sizes.setflags(write=False)
    return sizes


@lru_cache(maxsize=64)
def _sums(rows: int, columns: int) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    """What sums a small image tile by tile: from the left, shape (tile rows, rows), and from the right, shape
    (columns, tile columns); read-only.

    Args:
        rows, columns: of the small image.
    """
    side = max(LEAST_TILE, -(-columns // TILES_ACROSS))
    found = []
    for many in (rows, columns):
        tile = np.arange(many) // side
        sums = (tile[None, :] == np.arange(tile[-1] + 1)[:, None]).astype(np.float32)
        sums.setflags(write=False)
        found.append(sums)
    return found[0], np.ascontiguousarray(found[1].T)
