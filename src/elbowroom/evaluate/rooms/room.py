"""The simulated room against its exact truth: occupied voxels kept, free voxels found."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

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
        """One moment: declared free; truly occupied; touched by the machine; centre seen by some camera."""
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

    Yields:
        Rows of voxel_size_m, detail, rule, noise, cameras, width, height, moments, occupied_pct, found_pct, free_pct
        and what they are shares of.
    """
    room = InterventionRoom()
    exact = wall_cameras(cameras, size=size)
    noisy = wall_cameras(cameras, size=size, noise=NOISE_PRESETS["tof"])
    scenes = [(room.at(time_s), *_frames(room.at(time_s), exact, noisy)) for time_s in moments_s]
    for voxel_size_m in voxel_sizes_m:
        grid = VoxelGrid.covering(ROOM_LOWER_M, ROOM_UPPER_M, voxel_size_m)
        truths = [true_occupancy(grid, moment) for moment, _, _ in scenes]
        seen = [reconstruct(grid, exact, frames, rule="any", detail="point").free for _, frames, _ in scenes]
        for noise in (False, True):
            for detail in details:
                tally = Tally()
                for (moment, plain, rough), truth, visible in zip(scenes, truths, seen, strict=True):
                    space = reconstruct(
                        grid,
                        noisy if noise else exact,
                        rough if noise else plain,
                        machine=room.machine,
                        joints=moment.joints,
                        rule=rule,
                        detail=detail,
                    )
                    tally.add(space.free, truth.occupied, truth.machine, visible)
                yield {
                    "voxel_size_m": voxel_size_m,
                    "detail": detail,
                    "rule": rule,
                    "noise": noise,
                    "cameras": len(exact),
                    "width": exact[0].width,
                    "height": exact[0].height,
                    "moments": len(scenes),
                    **tally.row(),
                }


def _frames(
    moment: Moment, exact: Sequence[DepthCamera], noisy: Sequence[DepthCamera]
) -> tuple[list[DepthFrame], list[DepthFrame]]:
    return render(exact, moment, noise=False), render(noisy, moment)
