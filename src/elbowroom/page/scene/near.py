"""Blocked space near the machine, as places that a person can look at: its outermost voxels."""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from elbowroom.geometry import VoxelGrid, bits
from elbowroom.geometry.bits import Words

NEAR_M = 0.5
"""Blocked space is drawn so near to the machine [m]."""
MOST_PLACES = 16_000
"""So many voxels are drawn; of more, every so many-th: 6 bytes each, 10 times a second, is under 1 MB/s."""


class Planes(NamedTuple):
    """Of a free space, what is drawn; in the planes' order.

    Args:
        free: declared free.
        surface: blocked, since something was measured there.
        blind: blocked, for want of valid pixels.
        looked_at: words that cameras were asked of, bool; empty: all.
    """

    free: Words
    surface: Words
    blind: Words
    looked_at: NDArray[np.bool_]


@dataclass(frozen=True, slots=True, eq=False)
class Near:
    """Blocked space near the machine.

    Args:
        surface, unseen, blind: indices of voxels, shape (n, 3); each voxel is in one of them.
        thinned: how many there are, where not all are here; None: all are.
    """

    surface: NDArray[np.int32]
    unseen: NDArray[np.int32]
    blind: NDArray[np.int32]
    thinned: int | None = None

    @property
    def count(self) -> int:
        """Of voxels."""
        return len(self.surface) + len(self.unseen) + len(self.blind)


def near_of(
    grid: VoxelGrid, planes: Planes, machine_in_world: NDArray[np.float64], near_m: float = NEAR_M
) -> Near:
    """The outermost voxels of blocked space that are near the machine and were looked at.

    Args:
        grid: of the space.
        planes: what is known of it.
        machine_in_world: points on the machine, shape (n, 3), world frame [m]; none: all of the grid is near.
        near_m: how near [m].
    """
    lower, upper = _box(grid, machine_in_world, near_m)
    if (upper <= lower).any():
        nothing = np.zeros((0, 3), dtype=np.int32)
        return Near(nothing, nothing, nothing)
    outermost = _outermost(~_cropped(planes.free, grid, lower, upper))
    # as `argwhere`, several times as fast
    flat = np.flatnonzero(outermost)
    index = np.stack(np.unravel_index(flat, outermost.shape), axis=1) + lower
    if planes.looked_at.size:
        index = index[planes.looked_at[_places(index, grid)[0]]]
    if len(machine_in_world):
        far, _ = cKDTree(machine_in_world).query(grid.centre_of(index), distance_upper_bound=near_m)
        index = index[np.isfinite(far)]
    every = len(index)
    if every > MOST_PLACES:
        index = index[np.arange(MOST_PLACES) * every // MOST_PLACES]
    word, bit = _places(index, grid)
    surface = planes.surface[word] & bit != 0
    blind = (planes.blind[word] & bit != 0) & ~surface
    small = index.astype(np.int32)
    thinned = every if every > MOST_PLACES else None
    return Near(small[surface], small[~surface & ~blind], small[blind], thinned)


def _places(index: NDArray[np.int64], grid: VoxelGrid) -> tuple[NDArray[np.int64], Words]:
    """Words and bits of voxels."""
    return bits.places_of(index[:, 0], index[:, 1], index[:, 2], grid)


def _box(
    grid: VoxelGrid, machine: NDArray[np.float64], near_m: float
) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Of whole cubes of 16 voxels, the least and the one beyond the last that are near, in voxels."""
    shape = np.array(grid.shape)
    if not len(machine):
        return np.zeros(3, dtype=np.int64), shape
    # and one voxel more, which may be the free one beside
    lower = grid.index_of(machine.min(axis=0) - near_m) - 1
    upper = grid.index_of(machine.max(axis=0) + near_m) + 2
    return np.clip(lower // 16 * 16, 0, shape), np.clip(-(-upper // 16) * 16, 0, shape)


def _cubes(
    grid: VoxelGrid, lower: NDArray[np.int64], upper: NDArray[np.int64]
) -> tuple[tuple[slice, ...], tuple[int, ...]]:
    """Which cubes of 16 voxels a box has, and how many."""
    first, last = lower // 16, -(-upper // 16)
    return tuple(slice(int(a), int(b)) for a, b in zip(first, last, strict=True)), tuple(
        int(n) for n in last - first
    )


def _cropped(
    words: Words, grid: VoxelGrid, lower: NDArray[np.int64], upper: NDArray[np.int64]
) -> NDArray[np.bool_]:
    """A plane's bits within a box that begins with whole cubes."""
    cells = bits.lattice(grid)
    some, count = _cubes(grid, lower, upper)
    cubes = words.reshape(cells.cubes_x, cells.cubes_y, cells.cubes_z, 64)[some]
    box = VoxelGrid(grid.origin_m, (16 * count[0], 16 * count[1], 16 * count[2]), grid.voxel_size_m)
    whole = bits.unpack(np.ascontiguousarray(cubes).reshape(-1), box)
    size = upper - lower
    return np.asarray(whole[: size[0], : size[1], : size[2]])


def _outermost(blocked: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Blocked voxels that have a free one beside them; beyond the box nothing is free."""
    inner = blocked.copy()
    for axis in range(3):
        for step in (1, -1):
            here: list[slice] = [slice(None)] * 3
            there: list[slice] = [slice(None)] * 3
            here[axis], there[axis] = (
                (slice(1, None), slice(None, -1)) if step > 0 else (slice(None, -1), slice(1, None))
            )
            inner[tuple(here)] &= blocked[tuple(there)]
    return blocked & ~inner
