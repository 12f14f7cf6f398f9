"""The watched box of cubic voxels."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from elbowroom.errors import GridError

MAX_VOXELS = 2_000_000_000
"""More voxels than this are refused: at one bit a voxel and plane and some ten planes that is 2.5 GB."""


@dataclass(frozen=True, slots=True)
class VoxelGrid:
    """An axis-aligned box of cubic voxels in the world frame.

    Voxel (i, j, k) is the box [origin + h (i, j, k), origin + h (i+1, j+1, k+1)], with index order x, y, z.

    Args:
        origin_m: the box's least corner, world frame [m].
        shape: number of voxels along x, y, z.
        voxel_size_m: edge h of a voxel [m].

    Raises:
        GridError: an edge or a count that is not above zero, a number that is not finite, or too many voxels.
    """

    origin_m: tuple[float, float, float]
    shape: tuple[int, int, int]
    voxel_size_m: float

    def __post_init__(self) -> None:
        origin = tuple(float(x) for x in self.origin_m)
        shape = tuple(int(n) for n in self.shape)
        if len(origin) != 3 or not np.isfinite(origin).all():
            raise GridError(f"grid: origin_m is {self.origin_m}, must be three finite numbers [m]")
        if len(shape) != 3 or any(n < 1 for n in shape) or shape != tuple(self.shape):
            raise GridError(f"grid: shape is {self.shape}, must be three whole numbers of at least 1")
        if not (np.isfinite(self.voxel_size_m) and self.voxel_size_m > 0):
            raise GridError(f"grid: voxel_size_m is {self.voxel_size_m}, must be above 0 [m]")
        if np.prod([float(n) for n in shape]) > MAX_VOXELS:
            raise GridError(
                f"grid: {' x '.join(map(str, shape))} voxels are more than {MAX_VOXELS:,}; "
                "choose larger voxels or a smaller box"
            )
        object.__setattr__(self, "origin_m", origin)
        object.__setattr__(self, "shape", shape)
        object.__setattr__(self, "voxel_size_m", float(self.voxel_size_m))

    @classmethod
    def covering(cls, lower_m: ArrayLike, upper_m: ArrayLike, voxel_size_m: float) -> "VoxelGrid":
        """The smallest grid of a voxel size that starts at one corner and reaches at least the other.

        Args:
            lower_m, upper_m: least and greatest corner, shape (3,), world frame [m].
            voxel_size_m: edge of a voxel [m].

        Raises:
            GridError: corners or an edge that are no such, an empty box, or too many voxels.
        """
        lower, upper = np.asarray(lower_m, dtype=float), np.asarray(upper_m, dtype=float)
        if lower.shape != (3,) or upper.shape != (3,) or not np.isfinite([lower, upper]).all():
            raise GridError(
                f"grid: corners must be three finite numbers each, got {lower_m!r} and {upper_m!r}"
            )
        if not (np.isfinite(voxel_size_m) and voxel_size_m > 0):
            raise GridError(f"grid: voxel_size_m is {voxel_size_m}, must be above 0 [m]")
        if (upper <= lower).any():
            raise GridError(f"grid: empty, upper corner {upper.tolist()} is not above {lower.tolist()}")
        counts = np.ceil((upper - lower) / voxel_size_m - 1e-9)
        if not (counts < MAX_VOXELS).all():
            raise GridError("grid: too many voxels; choose larger voxels or a smaller box")
        x, y, z = (int(n) for n in counts)
        return cls(origin_m=(lower[0], lower[1], lower[2]), shape=(x, y, z), voxel_size_m=voxel_size_m)

    @property
    def lower_m(self) -> NDArray[np.float64]:
        """Least corner of the box, shape (3,), world frame [m]."""
        return np.array(self.origin_m)

    @property
    def upper_m(self) -> NDArray[np.float64]:
        """Greatest corner of the box, shape (3,), world frame [m]."""
        return self.lower_m + np.array(self.shape) * self.voxel_size_m

    @property
    def size(self) -> int:
        """Number of voxels."""
        return self.shape[0] * self.shape[1] * self.shape[2]

    def centre_of(self, index: ArrayLike) -> NDArray[np.float64]:
        """Centres of voxels, world frame [m].

        Args:
            index: voxel indices, shape (..., 3).

        Returns:
            origin + h (index + 1/2), shape (..., 3).
        """
        return self.lower_m + (np.asarray(index) + 0.5) * self.voxel_size_m

    def index_of(self, points_in_world: ArrayLike) -> NDArray[np.int64]:
        """The voxels that hold points; outside the grid the index lies below 0 or at or above `shape`.

        Args:
            points_in_world: shape (..., 3), world frame [m]; must be finite.

        Returns:
            floor((point - origin) / h), shape (..., 3).
        """
        points = np.asarray(points_in_world, dtype=float)
        if not np.isfinite(points).all():
            raise GridError("index_of: points must be finite")
        return np.floor((points - self.lower_m) / self.voxel_size_m).astype(np.int64)

    def contains(self, points_in_world: ArrayLike) -> NDArray[np.bool_]:
        """Whether points lie in the box, shape (...,)."""
        index = self.index_of(points_in_world)
        return np.asarray(((index >= 0) & (index < self.shape)).all(axis=-1))
