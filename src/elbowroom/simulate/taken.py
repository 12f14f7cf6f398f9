"""What stands in what: solids that share space, told from solids that stand on one another."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import binary_dilation, binary_erosion

from elbowroom.geometry import VoxelGrid
from elbowroom.simulate.kernels.touch import touch_surface
from elbowroom.simulate.solid import Solid
from elbowroom.simulate.truth import SHRINK_M, Touched, touched_by

FINEST_M = 0.02
"""Two solids that share less than about this are said to touch [m]."""
MOST_VOXELS = 4_000_000


def fine_grid(lower_m: NDArray[np.float64], upper_m: NDArray[np.float64]) -> VoxelGrid:
    """A grid over a box [m], as fine as `FINEST_M` unless the box is large."""
    edge = max(FINEST_M, float(np.prod(upper_m - lower_m) / MOST_VOXELS) ** (1 / 3))
    return VoxelGrid.covering(lower_m, upper_m, edge)


@dataclass(frozen=True, slots=True, eq=False)
class Taken:
    """The space that solids take, by the middles of voxels: what stands on a solid has none in common with it.

    Args:
        grid: the voxels; what lies outside is not looked at.
        solids: closed ones.
        surfaces: meshes without an inside; what they cross is taken.
        inside: voxels whose middle is in a solid, shape of the grid.
        crossed: voxels that a surface crosses, shape of the grid.
    """

    grid: VoxelGrid
    solids: tuple[Solid, ...]
    surfaces: tuple[Solid, ...]
    inside: NDArray[np.bool_]
    crossed: NDArray[np.bool_]

    @classmethod
    def of(cls, grid: VoxelGrid, solids: Sequence[Solid], surfaces: Sequence[Solid] = ()) -> "Taken":
        """The space that solids take in a grid.

        Args:
            grid: the voxels.
            solids: closed ones.
            surfaces: meshes without an inside.
        """
        inside, crossed = np.zeros(grid.shape, dtype=bool), np.zeros(grid.shape, dtype=bool)
        for solid in solids:
            first, touched = touched_by(grid, solid, surface=False)
            inside[_span(first, touched)] |= touched
        for solid in surfaces:
            triangles = solid.vertices_in_world[solid.mesh.faces]
            touch_surface(triangles, grid.lower_m, grid.voxel_size_m, SHRINK_M, crossed)
        return cls(grid, tuple(solids), tuple(surfaces), inside, crossed)

    def with_more(self, more: "Taken") -> "Taken":
        """What both take, in the same grid."""
        return Taken(
            self.grid,
            self.solids + more.solids,
            self.surfaces + more.surfaces,
            self.inside | more.inside,
            self.crossed | more.crossed,
        )

    def grown(self, by_m: float) -> "Taken":
        """The same with so much space about what is taken [m]."""
        steps = max(1, round(by_m / self.grid.voxel_size_m))
        inside = binary_dilation(self.inside, iterations=steps)
        return Taken(self.grid, self.solids, self.surfaces, inside, self.crossed)

    def meets(self, solid: Solid) -> bool:
        """Whether a closed solid stands in what is taken."""
        first, touched = touched_by(self.grid, solid, surface=False)
        span = _span(first, touched)
        if (self.inside[span] & touched).any():
            return True
        crossed = self.crossed[span]
        # a surface has no side: what stands on it reaches into the voxels that it crosses, but not to their far side
        return bool(crossed.any() and touched.size and (crossed & binary_erosion(touched)).any())

    def what_meets(self, solid: Solid) -> tuple[str, ...]:
        """Names of what a closed solid stands in."""
        one = Taken.of(self.grid, [solid])
        closed = [other.name for other in self.solids if one.meets(other)]
        open_ = [s.name for s in self.surfaces if Taken.of(self.grid, (), [s]).meets(solid)]
        return tuple(dict.fromkeys(closed + open_))


def share_space(one: Touched, other: Touched) -> bool:
    """Whether two parts of a grid, as of `touched_by`, have a voxel in common.

    Args:
        one, other: first index and voxels of each.
    """
    lower = np.maximum(one[0], other[0])
    upper = np.minimum(one[0] + one[1].shape, other[0] + other[1].shape)
    if (lower >= upper).any():
        return False
    parts = [part[_span(lower - first, upper - lower)] for first, part in (one, other)]
    return bool((parts[0] & parts[1]).any())


def _span(first: NDArray[np.int64], part: NDArray[np.bool_] | NDArray[np.int64]) -> tuple[slice, ...]:
    """Slices from a first index on, as long as a part of the grid, or of so many voxels."""
    counts = part.shape if part.ndim == 3 else part.tolist()
    return tuple(slice(int(c), int(c) + int(n)) for c, n in zip(first, counts, strict=True))
