"""The voxels of zones: those that a zone touches, and those that lie wholly in one."""

import numpy as np
from numpy.typing import NDArray

from elbowroom.geometry import VoxelGrid, bits
from elbowroom.geometry.bits import Words
from elbowroom.geometry.kept import kept
from elbowroom.machine.zone import ROUNDING_M, Zone


@kept
def zone_words(zone: Zone, grid: VoxelGrid, wholly: bool) -> Words:
    """The plane of the voxels of a zone.

    Args:
        zone: the zone.
        grid: the watched box.
        wholly: only those that lie wholly in it; else every one that it may touch: none that it does touch is left out.
    """
    lower, upper = zone.extent_m
    half = grid.voxel_size_m / 2
    first = np.clip(np.floor((lower - grid.lower_m) / grid.voxel_size_m) - 1, 0, grid.shape).astype(int)
    stop = np.clip(np.ceil((upper - grid.lower_m) / grid.voxel_size_m) + 1, 0, grid.shape).astype(int)
    mask = np.zeros(grid.shape, dtype=np.bool_)
    if (stop > first).all():
        axes = [grid.lower_m[n] + (np.arange(first[n], stop[n]) + 0.5) * 2 * half for n in range(3)]
        centres = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1)
        # how far a voxel reaches along the normal of each plane
        reach = half * np.abs(zone.planes[:, :3]).sum(axis=1)
        out = centres @ zone.planes[:, :3].T + zone.planes[:, 3]
        at = tuple(slice(a, b) for a, b in zip(first, stop, strict=True))
        mask[at] = _within(out, reach, wholly) & (wholly | _about(centres, half, lower, upper))
    return bits.pack(mask, grid)


def _within(out: NDArray[np.float64], reach: NDArray[np.float64], wholly: bool) -> NDArray[np.bool_]:
    """Whether voxels lie in all half-spaces, or may.

    Args:
        out: how far their middles lie out of each [m].
        reach: how far they reach along the normal of each [m].
        wholly: whether all of them must.
    """
    limit = ROUNDING_M - reach if wholly else ROUNDING_M + reach
    return np.asarray((out <= limit).all(axis=-1))


def _about(
    centres: NDArray[np.float64], half: float, lower: NDArray[np.float64], upper: NDArray[np.float64]
) -> NDArray[np.bool_]:
    """Whether voxels touch a box.

    Args:
        centres: their middles [m].
        half: half their edge [m].
        lower, upper: corners of the box [m].
    """
    near = half + ROUNDING_M
    return np.asarray(((centres >= lower - near) & (centres <= upper + near)).all(axis=-1))
