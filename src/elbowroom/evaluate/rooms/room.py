"""The simulated room against its exact truth: occupied voxels kept, free voxels found."""

import itertools
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from elbowroom.choices import Detail, Rule
from elbowroom.evaluate.due import FULL_ROOM, Due, where
from elbowroom.geometry import DepthCamera, VoxelGrid
from elbowroom.reconstruct import reconstruct
from elbowroom.sensing import NOISE_PRESETS, DepthFrame
from elbowroom.simulate import InterventionRoom, Moment, render, true_occupancy, wall_cameras

ROOM_LOWER_M, ROOM_UPPER_M = (-2.0, -2.0, 0.0), (2.0, 2.0, 2.5)
MOMENTS_S = (0.0, 7.0, 19.0)
"""Times of the room's course at which it is judged [s]."""
OURS = {**FULL_ROOM, "rule": "three"}
"""Of which figures are due."""
DUE = (
    Due("occupied_pct", "≥", 100.0, where(**OURS, detail="footprint", noise=False), "kept by footprint"),
    Due("occupied_pct", "≥", 99.99, where(**OURS, detail="pixel", noise=False), "by pixel"),
    Due(
        "occupied_pct",
        "≥",
        99.99,
        where(**OURS, detail="pixel", noise=True, voxel_size_m=0.02),
        "and with noise at 2 cm",
    ),
    Due(
        "found_pct",
        "≥",
        97.0,
        where(**OURS, detail="pixel", noise=False, voxel_size_m=0.02),
        "found by pixel, above the layer at the floor, at 2 cm",
    ),
    Due("found_pct", "≥", 94.0, where(**OURS, detail="pixel", noise=False, voxel_size_m=0.05), "at 5 cm"),
    Due(
        "found_pct",
        "≥",
        92.0,
        where(**OURS, detail="pixel", noise=True, voxel_size_m=0.02),
        "with noise at 2 cm",
    ),
)


@dataclass(slots=True)
class Tally:
    """Voxels of all moments together."""

    occupied: int = 0
    kept: int = 0
    free: int = 0
    free_declared: int = 0
    visible: int = 0
    found: int = 0
    visible_above_floor: int = 0
    found_above_floor: int = 0

    def add(
        self,
        free: NDArray[np.bool_],
        occupied: NDArray[np.bool_],
        machine: NDArray[np.bool_],
        seen: NDArray[np.bool_],
    ) -> None:
        """Counts one moment.

        Args:
            free: what is declared free.
            occupied, machine: what a solid or the machine truly touches.
            seen: voxels whose centre some camera sees.
        """
        truly_free = ~occupied & ~machine
        visible = truly_free & seen
        self.occupied += int(occupied.sum())
        self.kept += int((occupied & ~free).sum())
        self.free += int(truly_free.sum())
        self.free_declared += int((truly_free & free).sum())
        self.visible += int(visible.sum())
        self.found += int((visible & free).sum())
        self.visible_above_floor += int(visible[:, :, 1:].sum())
        self.found_above_floor += int((visible & free)[:, :, 1:].sum())

    def row(self) -> dict[str, object]:
        """Shares [%] and what they are shares of."""
        return {
            "occupied_pct": 100 * self.kept / self.occupied,
            "occupied_voxels": self.occupied,
            "false_free_voxels": self.occupied - self.kept,
            "found_pct": 100 * self.found_above_floor / self.visible_above_floor,
            "found_with_floor_layer_pct": 100 * self.found / self.visible,
            "free_pct": 100 * self.free_declared / self.free,
            "visible_pct": 100 * self.visible / self.free,
        }


class _Scene(NamedTuple):
    """A moment of the room, its images without noise and with it."""

    moment: Moment
    plain: list[DepthFrame]
    rough: list[DepthFrame]


def room_rows(
    voxel_sizes_m: Sequence[float] = (0.05, 0.02),
    *,
    details: Sequence[Detail] = ("footprint", "pixel", "point"),
    cameras: int = 21,
    size: str = "vga",
    rule: Rule = "three",
    moments_s: Sequence[float] = MOMENTS_S,
) -> Iterator[dict[str, object]]:
    """Every voxel size and detail, without noise and with it and its margins.

    Occupied is every voxel that a solid touches, the machine apart; found is counted without the layer that touches
    the floor, of the free voxels whose centre an exact camera sees. Footprint, pixel and point use the same frames.

    Args:
        voxel_sizes_m: edges of voxels [m].
        details, rule: of the carve.
        cameras, size: along the walls, and of their images.
        moments_s: times of the room's course [s].

    Yields:
        Rows of voxel_size_m, detail, rule, noise, cameras, width, height, moments, occupied_pct, found_pct, free_pct
        and what they are shares of.
    """
    room = InterventionRoom()
    exact = wall_cameras(cameras, size=size)
    noisy = wall_cameras(cameras, size=size, noise=NOISE_PRESETS["tof"])
    scenes = [_Scene(at, render(exact, at, noise=False), render(noisy, at)) for at in map(room.at, moments_s)]
    for voxel_size_m in voxel_sizes_m:
        grid = VoxelGrid.covering(ROOM_LOWER_M, ROOM_UPPER_M, voxel_size_m)
        truths = [true_occupancy(grid, scene.moment) for scene in scenes]
        seen = [
            reconstruct(grid, exact, scene.plain, rule="any", detail="point", looks=False).free
            for scene in scenes
        ]
        for noise, detail in itertools.product((False, True), details):
            tally = Tally()
            for scene, truth, visible in zip(scenes, truths, seen, strict=True):
                views, frames = (noisy, scene.rough) if noise else (exact, scene.plain)
                joints = scene.moment.joints
                space = reconstruct(
                    grid, views, frames, room.machine, joints, rule=rule, detail=detail, looks=False
                )
                tally.add(space.free, truth.occupied, truth.machine, visible)
            said = {"voxel_size_m": voxel_size_m, "detail": detail, "rule": rule, "noise": noise}
            yield {**said, **cameras_row(exact), "moments": len(scenes), **tally.row()}


def cameras_row(cameras: Sequence[DepthCamera]) -> dict[str, int]:
    """What rows say of cameras that are all alike: how many, and the size of their images."""
    return {"cameras": len(cameras), "width": cameras[0].width, "height": cameras[0].height}
