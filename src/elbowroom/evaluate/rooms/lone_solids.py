"""A box with corners and a rod, alone before walls: exact depth and the voxels they touch, by closed formulas."""

from collections.abc import Callable, Sequence
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from elbowroom.geometry import DepthCamera, VoxelGrid

Array = NDArray[np.float64]
ROD_LENGTH_M = 0.6
STEP_IN_RADII = 0.28
"""Balls this far apart along a rod leave out at most a hundredth of its radius between them."""


class LoneSolid(Protocol):
    """What a scene holds."""

    def enter(self, eye: Array, rays: Array) -> Array:
        """Depth where rays from an eye enter it, infinite where they miss, shape (h, w) [lengths of the rays].

        Args:
            eye: where the rays begin, shape (3,), world frame [m].
            rays: directions, shape (h, w, 3), world frame.
        """

    def touched(self, grid: VoxelGrid) -> NDArray[np.bool_]:
        """The voxels that it touches, shape of the grid."""


Hang = Callable[[np.random.Generator, Sequence[DepthCamera]], LoneSolid]
"""Makes a solid at a random place, for the cameras that look at it."""


class TurnedBox:
    """A box of 10 to 40 cm, turned at random."""

    def __init__(self, rng: np.random.Generator) -> None:
        self.turn = np.linalg.qr(rng.normal(size=(3, 3)))[0]
        self.half = rng.uniform(0.05, 0.2, 3)
        self.centre = rng.uniform(-0.3, 0.3, 3)

    @classmethod
    def hung(cls, rng: np.random.Generator, cameras: Sequence[DepthCamera]) -> "TurnedBox":
        """At a random place, whoever looks."""
        return cls(rng)

    def enter(self, eye: Array, rays: Array) -> Array:
        """Depth where rays enter it, infinite where they miss."""
        with np.errstate(divide="ignore"):
            away, along = (eye - self.centre) @ self.turn, rays @ self.turn
            one, other = (-self.half - away) / along, (self.half - away) / along
        near, far = np.minimum(one, other).max(axis=-1), np.maximum(one, other).min(axis=-1)
        return np.where((near <= far) & (near > 0), near, np.inf)

    def touched(self, grid: VoxelGrid) -> NDArray[np.bool_]:
        """The voxels that it touches, by separating axes."""
        middle = grid.centre_of(_indices(grid)) - self.centre
        crossed = [np.cross(a, b) for a in np.eye(3) for b in self.turn.T]
        meets = np.ones(grid.shape, dtype=np.bool_)
        for axis in [*np.eye(3), *self.turn.T, *crossed]:
            reach = np.abs(axis).sum() * grid.voxel_size_m / 2 + np.abs(axis @ self.turn) @ self.half
            meets &= np.abs(middle @ axis) < reach
        return meets


class Rod:
    """A rod with round ends.

    Args:
        centre: its middle, shape (3,), world frame [m].
        along: direction of any length, shape (3,).
        radius: half its diameter [m].
    """

    def __init__(self, centre: Array, along: Array, radius: float) -> None:
        self.along = along / np.linalg.norm(along)
        self.start = centre - self.along * ROD_LENGTH_M / 2
        self.radius = radius

    @classmethod
    def of_pixels(cls, diameter_px: float) -> Hang:
        """Of so many pixel pitches at its range, of the camera that sees it most coarsely."""

        def hung(rng: np.random.Generator, cameras: Sequence[DepthCamera]) -> "Rod":
            centre, along = rng.uniform(-0.2, 0.2, 3), rng.normal(size=3)
            pitches = [np.linalg.norm(c.centre_in_world - centre) / c.intrinsics.fx for c in cameras]
            return cls(centre, along, float(diameter_px * max(pitches) / 2))

        return hung

    def enter(self, eye: Array, rays: Array) -> Array:
        """Depth where rays enter it, infinite where they miss."""
        away = eye - self.start
        across_rays = rays - (rays @ self.along)[..., None] * self.along
        across = away - away @ self.along * self.along
        depth = _first_root(across_rays, across, self.radius)
        height = away @ self.along + np.where(np.isfinite(depth), depth, 0) * (rays @ self.along)
        depth = np.where((height >= 0) & (height <= ROD_LENGTH_M), depth, np.inf)
        for end in (self.start, self.start + ROD_LENGTH_M * self.along):
            depth = np.minimum(depth, _first_root(rays, eye - end, self.radius))
        return depth

    def touched(self, grid: VoxelGrid) -> NDArray[np.bool_]:
        """The voxels that balls along it touch."""
        lower = grid.lower_m + _indices(grid) * grid.voxel_size_m
        hit = np.zeros(grid.shape, dtype=np.bool_)
        for place in np.arange(0, ROD_LENGTH_M, STEP_IN_RADII * self.radius):
            at = self.start + place * self.along
            first = np.maximum(grid.index_of(at - self.radius), 0)
            last = grid.index_of(at + self.radius) + 1
            part = tuple(slice(a, b) for a, b in zip(first, last, strict=True))
            nearest = np.clip(at, lower[part], lower[part] + grid.voxel_size_m)
            hit[part] |= np.linalg.norm(nearest - at, axis=-1) < self.radius
        return hit


def _indices(grid: VoxelGrid) -> NDArray[np.int64]:
    """Of all voxels, shape of the grid + (3,)."""
    return np.moveaxis(np.indices(grid.shape), 0, -1)


def _first_root(rays: Array, away: Array, radius: float) -> Array:
    """The lesser t > 0 with |away + t ray| = radius, infinite where there is none."""
    a, b, c = (rays * rays).sum(axis=-1), rays @ away, away @ away - radius**2
    under = b * b - a * c
    t = (-b - np.sqrt(np.maximum(under, 0))) / a
    return np.where((under >= 0) & (t > 0), t, np.inf)
