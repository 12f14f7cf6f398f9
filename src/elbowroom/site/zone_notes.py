"""What a user should know of a site's zones: those that change nothing, and those that stop a link wherever it is."""

import numpy as np

from elbowroom.geometry import VoxelGrid
from elbowroom.machine import Machine, Zone
from elbowroom.machine.ways import never_out_of, reach_m


def notes_of_zones(machine: Machine, grid: VoxelGrid) -> tuple[str, ...]:
    """A line for each.

    Args:
        machine: with its zones.
        grid: the watched box.
    """
    notes = []
    reach = reach_m(machine)
    for zone in machine.zones:
        lower, upper = zone.extent_m
        if (upper <= grid.lower_m).any() or (lower >= grid.upper_m).any():
            notes.append(f"zone {zone.name} lies outside the watched box: it changes nothing")
        elif _distance(zone, machine.world_from_base[:3, 3]) > reach:
            notes.append(
                f"zone {zone.name}: no link reaches it, {reach:.1f} m is the farthest from the base: it changes nothing"
            )
        elif zone.kind == "kept_out":
            covered = never_out_of(machine, [(zone.has, lambda _: True)])
            if covered:
                notes.append(
                    f"zone {zone.name}: {', '.join(covered)} never leave it: motions that move them always stop"
                )
        elif (lower < grid.lower_m).any() or (upper > grid.upper_m).any():
            notes.append(
                f"zone {zone.name} reaches out of the watched box: there links stop, at the end of the box"
            )
    return tuple(notes)


def _distance(zone: Zone, point: np.ndarray) -> float:
    """No more than the distance of a point from a zone [m]: that from the box that holds it."""
    lower, upper = zone.extent_m
    return float(np.linalg.norm(np.maximum(np.maximum(lower - point, point - upper), 0.0)))
