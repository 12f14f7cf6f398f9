"""Draws of cameras that are not where they are said to be, and what is found with a margin for that or without."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from elbowroom.choices import Detail
from elbowroom.evaluate.rooms.room import Tally
from elbowroom.evaluate.rooms.scene import DECIMALS, room_grid
from elbowroom.evaluate.shares.task import Outcome
from elbowroom.evaluate.thesis.thesis import HEIGHTS_M, c_arm
from elbowroom.geometry import DepthCamera, VoxelGrid, bits
from elbowroom.reconstruct import FreeSpace, reconstruct
from elbowroom.sensing import DepthFrame, Margin
from elbowroom.simulate import Moment, Truth, render, setup, true_occupancy, wall_cameras
from elbowroom.view.report.blocks import mean

MARGIN = 0.75
"""The declared margin, as a share of the greatest error about each axis."""
NEAR_M = 2.5
"""A shift across the ray is as many pixels as it is at this depth [m]."""
MEASURES = ("occupied_pct", "found_pct", "free_pct")
THIRD = 3


@dataclass(frozen=True, slots=True)
class Errors:
    """How far cameras are off, and what is looked at.

    Args:
        curve: that the draws belong to.
        size: of the images.
        rotation_deg, translation_m: greatest error about and along each axis.
        shares: of it that margins declare.
        whole: whether all of the room is looked at, or a fixed third.
        detail: of the carve.
    """

    curve: str
    size: str
    rotation_deg: float
    translation_m: float
    shares: Sequence[float]
    whole: bool = False
    detail: Detail = "pixel"

    @property
    def are_none(self) -> bool:
        """Whether the cameras are where they are said to be."""
        return self.rotation_deg == self.translation_m == 0


class _Scene(NamedTuple):
    """What all draws of a sensor share; `seen`: the voxels whose centre an exact camera sees."""

    moment: Moment
    grid: VoxelGrid
    truth: Truth
    views: tuple[DepthCamera, ...]
    frames: list[DepthFrame]
    seen: NDArray[np.bool_]


def judge_draws(
    errors: Mapping[str, Any], number: int, voxel_size_m: float, cameras: int, first: int, draws: int
) -> Outcome:
    """Some draws of one size of error, with each margin.

    Args:
        errors: values of `Errors`.
        number: of the setup.
        voxel_size_m: edge of a voxel [m].
        cameras: how many.
        first, draws: number of the first draw, and how many.
    """
    size, scene = Errors(**errors), _exact_scene(number, voxel_size_m, errors["size"], cameras)
    focus = None if size.whole else third_of(scene.grid)
    found: dict[float, list[dict[str, Any]]] = {share: [] for share in size.shares}
    for draw in range(first, first + draws):
        rng = np.random.default_rng([draw, 612])
        said = disturbed(scene.views, size.rotation_deg, size.translation_m, rng)
        for share in size.shares:
            space = _space(scene, said, size, share, focus)
            found[share].append(_tallied(scene, space, focus))
    case = {
        "kind": "draws",
        "curve": size.curve,
        "setup": number,
        "sensor": f"{scene.views[0].width}x{scene.views[0].height}",
        "noise": False,
        "voxel_size_m": voxel_size_m,
        "rule": "three",
        "detail": size.detail,
        "rotation_deg": size.rotation_deg,
        "translation_m": size.translation_m,
        "first": first,
    }
    return Outcome([{**case, "margin_share": share, **_of_draws(found[share])} for share in size.shares])


def _space(
    scene: _Scene,
    said: Sequence[DepthCamera],
    errors: Errors,
    share: float,
    focus: NDArray[np.bool_] | None,
) -> FreeSpace:
    return reconstruct(
        scene.grid,
        said,
        scene.frames,
        machine=c_arm(),
        joints=scene.moment.joints,
        detail=errors.detail,
        margin=margin_for(errors.rotation_deg, errors.translation_m, share, scene.views[0].intrinsics.fx),
        focus=focus,
        looks=False,
    )


def _tallied(scene: _Scene, space: FreeSpace, focus: NDArray[np.bool_] | None) -> dict[str, Any]:
    """Shares of what is looked at."""
    looked_at = np.ones(scene.grid.shape, dtype=np.bool_) if focus is None else _voxels_of(focus, scene.grid)
    tally, truth = Tally(), scene.truth
    tally.add(space.free, truth.occupied & looked_at, truth.machine | ~looked_at, scene.seen & looked_at)
    return tally.row()


@lru_cache(maxsize=2)
def _exact_scene(number: int, voxel_size_m: float, size: str, cameras: int) -> _Scene:
    grid, moment = room_grid(voxel_size_m), setup(number).at(c_arm())
    views = wall_cameras(cameras, HEIGHTS_M, size=size)
    frames = render(views, moment, noise=False)
    seen = reconstruct(grid, views, frames, rule="any", detail="point", looks=False).free
    return _Scene(moment, grid, true_occupancy(grid, moment), views, frames, seen)


def _of_draws(tallies: Sequence[Mapping[str, Any]]) -> dict[str, Any]:
    """Means over some draws, and each draw's own figures in their order."""
    each = {key: [round(tally[key], DECIMALS) for tally in tallies] for key in MEASURES}
    return {**{key: mean(values) for key, values in each.items()}, "each": each}


def margin_for(rotation_deg: float, translation_m: float, share: float, focal_px: float) -> Margin:
    """The margin declared for errors of so much about each axis, or a share of it.

    Args:
        rotation_deg, translation_m: greatest error about and along each axis.
        share: of it that is declared.
        focal_px: of the cameras.
    """
    angle, length = share * np.radians(rotation_deg), share * translation_m
    return Margin(lateral_px=0.5 + focal_px * (angle + length / NEAR_M), bias_m=length, range_linear=angle)


def disturbed(
    cameras: Sequence[DepthCamera], rotation_deg: float, translation_m: float, rng: np.random.Generator
) -> tuple[DepthCamera, ...]:
    """The cameras as a calibration that is off would say them.

    Args:
        cameras: where they are.
        rotation_deg, translation_m: greatest error about and along each axis.
        rng: draws the errors.
    """
    said = []
    for camera in cameras:
        pose = np.array(camera.world_from_camera)
        turn = Rotation.from_euler("xyz", rng.uniform(-rotation_deg, rotation_deg, 3), degrees=True)
        pose[:3, :3] = pose[:3, :3] @ turn.as_matrix()
        pose[:3, 3] += rng.uniform(-translation_m, translation_m, 3)
        said.append(replace(camera, world_from_camera=pose))
    return tuple(said)


def third_of(grid: VoxelGrid) -> NDArray[np.bool_]:
    """A fixed random third of the blocks of 4 voxels, for `reconstruct(focus=...)`."""
    return np.random.default_rng(1).random(bits.empty(grid).shape) < 1 / THIRD


def _voxels_of(focus: NDArray[np.bool_], grid: VoxelGrid) -> NDArray[np.bool_]:
    words = np.where(focus, np.uint64(0xFFFFFFFFFFFFFFFF), np.uint64(0)).astype(np.uint64)
    return bits.unpack(words & bits.inside(grid), grid)
