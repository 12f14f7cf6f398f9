"""What a user should know of a site's machine: links without a body, slips that pass, links that stand on the floor."""

import numpy as np

from elbowroom.machine import Machine
from elbowroom.site.site import Site

ON_THE_FLOOR_VOXELS = 1.0
"""A link whose lowest point lies within so many voxels of the floor stands on it."""
MOST_NOTES = 8
"""So many slips of a description are told one by one."""


def notes_of_machine(machine: Machine, site: Site) -> tuple[str, ...]:
    """A line for each.

    Args:
        machine: of the site.
        site: the file.
    """
    notes = []
    if machine.bodiless_links:
        notes.append(
            f"links that move without a body, by the site's word: {', '.join(machine.bodiless_links)}; "
            "what they would hit is not noticed"
        )
    notes += [finding.text for finding in machine.findings[:MOST_NOTES]]
    if len(machine.findings) > MOST_NOTES:
        notes.append(f"and {len(machine.findings) - MOST_NOTES} slips more in the description of the machine")
    standing = _on_the_floor(machine, site)
    if standing:
        notes.append(
            f"links that move and touch the floor at rest: {', '.join(standing)}; the floor is a surface, so the motions "
            "that move them stop; wheels that always touch it belong into unchecked_links"
        )
    return tuple(notes)


def _on_the_floor(machine: Machine, site: Site) -> list[str]:
    """Checked links that move, whose lowest point at rest is about where the floor is: at height 0, or the grid's bottom."""
    grid = site.grid()
    near = ON_THE_FLOOR_VOXELS * grid.voxel_size_m
    floors = [height for height in {0.0, float(grid.lower_m[2])} if height >= grid.lower_m[2]]
    moving = {name for joint in site.entry.joints if joint in machine.joint_names for name in machine.moved_links(joint)}
    placed = machine.world_from_links(machine.nearest_to_zero())
    standing = []
    for link in machine.links:
        if link.name not in moving or link.name not in machine.checked_links:
            continue
        lowest = float((link.vertices @ placed[link.name][2, :3] + placed[link.name][2, 3]).min())
        if any(np.abs(lowest - floor) <= near for floor in floors):
            standing.append(link.name)
    return standing
