"""What the evaluations of motions share: the room's motions, and a verdict beside the truth."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from elbowroom.evaluate.rooms.exact import Contact
from elbowroom.evaluate.rooms.room import ROOM_LOWER_M, ROOM_UPPER_M
from elbowroom.geometry import VoxelGrid
from elbowroom.geometry.margin import Margin
from elbowroom.machine import Machine
from elbowroom.motion import Level, Motion, Verdict
from elbowroom.site import Site

WELL_KNOWN = Margin(lateral_px=0.0)
"""Of simulated cameras, which are where they are said to be: their noise alone, no lateral error to allow for."""
SAME = 1e-9
"""Travels that differ by less are the same: rounding [m or rad]."""


IN_SUMMARY = ("seed", "cameras", "width", "height", "heights_m")
"""What is the same in all rows of a run; in its file the summary alone says it."""
DECIMALS = 6
"""Of numbers in a file: micrometres, microradians."""


def room_grid(voxel_size_m: float) -> VoxelGrid:
    """The watched box of the simulated room."""
    return VoxelGrid.covering(ROOM_LOWER_M, ROOM_UPPER_M, voxel_size_m)


def room_motions(machine: Machine) -> tuple[Motion, ...]:
    """Every joint in both directions, with the speeds and braking times of the simulated room's site file."""
    return tuple(Site.simulated_room().motions(machine))


def settings_of(rows: Sequence[Mapping[str, Any]]) -> dict[str, Any]:
    """What a summary says of how its rows were made: its kind, and the rows' voxel size, detail, seed and cameras."""
    names = ("voxel_size_m", "detail", *IN_SUMMARY)
    return {"kind": "summary", **{name: rows[0][name] for name in names if rows and name in rows[0]}}


def lean(row: Mapping[str, Any]) -> dict[str, Any]:
    """A row as a file has it: without what the summary says, numbers rounded to `DECIMALS`.

    Joint positions are not written at all: they follow from seed and number of the pose.
    """
    return {
        name: round(value, DECIMALS) if isinstance(value, float) else value
        for name, value in row.items()
        if name not in IN_SUMMARY
    }


def only(row: Mapping[str, Any], keys: Sequence[str]) -> dict[str, Any]:
    """Of a row what some keys say, in their order."""
    return {key: row[key] for key in keys}


@dataclass(frozen=True, slots=True)
class Comparison:
    """A verdict beside exact geometry's answer to the same question.

    Args:
        motion: what was asked.
        verdict: ours.
        contact: the truth.
    """

    motion: Motion
    verdict: Verdict
    contact: Contact

    @property
    def true_level(self) -> Level:
        """The level by the same distances S, M and L. Joint limits cap the travel, not the level."""
        if not self.contact.touches:
            return Level.CLEAR
        return Level.at(self.contact.travel, self.motion.braking_distance)

    @property
    def milder(self) -> bool:
        """Whether ours promises more than the truth: a milder level, or more travel."""
        return self.verdict.level.rank > self.true_level.rank or self.excess > SAME

    @property
    def excess(self) -> float:
        """Free travel beyond the truth, below zero where it falls short [m or rad]."""
        return self.verdict.free_travel - self.contact.travel

    @property
    def truly_clear(self) -> bool:
        """Whether nothing is met within the whole reach, and no joint limit comes before it."""
        return not self.contact.touches and self.contact.length >= self.motion.looked_at - SAME

    def row(self) -> dict[str, Any]:
        """The verdict, the truth, and how they compare; travels in `free_travel_unit`."""
        return self.verdict.row() | {
            "true_level": self.true_level.name.lower(),
            "true_band": self.true_level.band,
            "true_travel": self.contact.travel,
            "true_link": self.contact.link,
            "true_solid": self.contact.solid,
            "truly_clear": self.truly_clear,
            "milder": self.milder,
        }
