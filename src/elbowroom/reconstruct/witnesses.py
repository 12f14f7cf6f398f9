"""Which cameras are one witness: those that look from nearly one place err together."""

from collections.abc import Sequence
from dataclasses import replace
from functools import lru_cache, reduce

import numpy as np
from numpy.typing import NDArray

from elbowroom.geometry import DepthCamera, VoxelGrid
from elbowroom.reconstruct.evidence import Evidence, merge
from elbowroom.reconstruct.kernels.planes import THREE, TWO


@lru_cache(maxsize=16)
def witnesses(
    grid: VoxelGrid, cameras: tuple[DepthCamera, ...], angle_deg: float
) -> tuple[tuple[int, ...], ...]:
    """Groups of cameras that are one witness each, those of more than one camera.

    Two cameras are one if the distance between them is less than an angle as seen from the middle of the grid, or from
    half its diagonal where they are nearer than that; and with them all that are one with either. It does not depend
    on frames: a camera that is lost leaves the others' groups as they are.

    Args:
        grid: the watched box.
        cameras: of the room.
        angle_deg: below it two are one [deg]; 0: each camera is a witness of its own.

    Returns:
        Numbers of cameras, rising in each group.
    """
    if angle_deg <= 0 or len(cameras) < 2:
        return ()
    lower, upper = np.array(grid.lower_m), np.array(grid.upper_m)
    places = np.array([camera.centre_in_world for camera in cameras])
    apart = np.linalg.norm(places[:, None] - places[None, :], axis=2)
    away = np.linalg.norm((places[:, None] + places[None, :]) / 2 - (lower + upper) / 2, axis=2)
    seen_from = np.maximum(away, np.linalg.norm(upper - lower) / 2)
    near = apart < np.radians(angle_deg) * seen_from
    members = {tuple(np.flatnonzero(row).tolist()) for row in _reached(near)}
    return tuple(sorted(those for those in members if len(those) > 1))


def _reached(near: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Who is one with whom, also by others between them, bool (N, N); near: who is beside whom, and itself.

    (`scipy.sparse.csgraph` has this, and takes a quarter of the time to the first free space to load.)
    """
    reached = near
    while (farther := reached @ near).sum() > reached.sum():
        reached = farther
    return reached


def as_one(parts: Sequence[Evidence], counted: bool) -> Evidence:
    """What cameras know that are one witness: together they see through what any of them does, and dispute likewise.

    Args:
        parts: evidence of these cameras: of each alone, or of several that were all asked of every voxel.
        counted: whether it keeps how many cameras see through and dispute; then all parts must have counts.
    """
    planes = reduce(np.bitwise_or, (part.planes for part in parts)).copy()
    planes[TWO] = planes[THREE] = 0
    merged, names = merge(parts), frozenset(name for part in parts for name in part.cameras)
    groups = merged.as_one | ({names} if len(names) > 1 else set())
    return replace(merged, planes=planes, counts=merged.counts if counted else None, as_one=groups)


def merged_by_witness(parts: Sequence[Evidence], groups: Sequence[Sequence[int]]) -> Evidence:
    """What all cameras know, each carved alone, as if those of one witness had been carved together.

    Args:
        parts: evidence by camera.
        groups: numbers of those that are one witness each, as of `witnesses`.
    """
    near = [[parts[number] for number in group] for group in groups]
    grouped = {number for group in groups for number in group}
    own = [part for number, part in enumerate(parts) if number not in grouped]
    counted = all(part.counts is not None for part in parts)
    return merge([*own, *(as_one(group, counted) for group in near)])
