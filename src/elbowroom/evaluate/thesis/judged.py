"""How a motion of the setups is judged: sensor and margins, the space that is seen, the verdict beside the truth."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from typing import Any

from elbowroom.choices import Detail
from elbowroom.evaluate.rooms.scene import DECIMALS, Comparison, lean, only, room_grid, room_motions
from elbowroom.evaluate.thesis.bands import compared
from elbowroom.evaluate.thesis.thesis import sensor_cameras
from elbowroom.geometry import DepthCamera
from elbowroom.machine import Machine
from elbowroom.motion import Motion, blocks_in_reach
from elbowroom.reconstruct import FreeSpace, reconstruct
from elbowroom.sensing import DepthFrame, Margin
from elbowroom.simulate import Moment

SMALL = ("iv pole", "iv line", "gas hose", "cables", "monitor cables", "shield")
"""Solids that are thinner than 0.10 m, what the thesis' sensor can detect."""
LATERAL_PX = 0.5
"""What is allowed for where cameras may be off [px]; simulated ones are not, so it is shown beside 0."""


@dataclass(frozen=True, slots=True)
class Variant:
    """How a movement is judged.

    Args:
        sensor: a name of `SENSORS`.
        voxel_size_m: edge of a voxel [m].
        detail: of the carve.
        noise: whether the sensor has any; its three sigmas are then the margin in depth.
        lateral_px: by how much pixels are widened for errors of pose [px].
    """

    sensor: str
    voxel_size_m: float
    detail: Detail
    noise: bool = False
    lateral_px: float = 0.0

    def said(self, cameras: int) -> dict[str, Any]:
        """As rows say it."""
        return {
            "sensor": self.sensor,
            "noise": self.noise,
            "voxel_size_m": self.voxel_size_m,
            "rule": "three",
            "detail": self.detail,
            "lateral_px": self.lateral_px,
            "cameras": cameras,
        }


SAID = ("sensor", "noise", "voxel_size_m", "rule", "detail", "lateral_px", "cameras")
"""What rows say of their variant."""
KEPT = ("joint", "direction", "band", "cause", "free_travel", "free_travel_unit")
"""What they say of a verdict."""


@cache
def motions_of(machine: Machine) -> dict[tuple[str, int], Motion]:
    """Every joint in both directions, by joint and direction."""
    return {(motion.joint, motion.direction): motion for motion in room_motions(machine)}


@cache
def cameras_of(sensor: str, noise: bool, count: int) -> tuple[DepthCamera, ...]:
    """Always the same objects, since images of what never moves are kept by camera.

    Args:
        sensor: a name of `SENSORS`.
        noise: whether it has any.
        count: how many.
    """
    return sensor_cameras(sensor, noise=noise, count=count)


def seen_space(
    machine: Machine,
    moment: Moment,
    motions: Sequence[Motion],
    views: Sequence[DepthCamera],
    frames: Sequence[DepthFrame],
    variant: Variant,
) -> FreeSpace:
    """Free space where the motions can go.

    Args:
        machine, moment: what is there.
        motions: of the machine.
        views, frames: what it is seen by.
        variant: how it is judged.
    """
    grid = room_grid(variant.voxel_size_m)
    return reconstruct(
        grid,
        views,
        frames,
        machine=machine,
        joints=moment.joints,
        detail=variant.detail,
        margin=Margin(lateral_px=variant.lateral_px),
        focus=blocks_in_reach(grid, machine, moment.joints, motions),
        looks=False,
    )


def judged(found: Comparison, voxel_size_m: float) -> dict[str, Any]:
    """A verdict beside the truth, as rows have it; lengths and angles rounded to micrometres and microradians."""
    verdict, contact = found.verdict, found.contact
    missing_m = (contact.travel - verdict.free_travel) * contact.speed
    return {
        **only(lean(verdict.row()), KEPT),
        "truth_band": found.true_level.band,
        "verdict": compared(verdict.band, found.true_level.band),
        "truth_travel": round(contact.travel, DECIMALS),
        "true_solid": contact.solid,
        "more_than_truth": found.milder,
        "shortfall_voxels": round(missing_m / voxel_size_m, 3) if contact.touches else None,
    }


def is_small(row: Mapping[str, Any]) -> bool:
    """Whether what is truly touched is thinner than 0.10 m."""
    return row["true_solid"] in SMALL
