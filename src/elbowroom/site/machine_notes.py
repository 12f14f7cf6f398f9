"""What a user should know of a site's machine: links without a body, slips that pass, wheels on the floor."""

from itertools import combinations

import numpy as np

from elbowroom.machine import Machine
from elbowroom.machine.carried import holds
from elbowroom.machine.overlap import POSES, always_touching
from elbowroom.machine.sizes import LARGEST_LINK_M
from elbowroom.machine.together import BETWEEN
from elbowroom.motion.contacts import can_move_apart, is_allowed
from elbowroom.site.site import Site

ON_THE_FLOOR_VOXELS = 1.0
"""A wheel whose lowest point lies within so many voxels of the floor stands on it."""
LEVEL = 0.1
"""An axis that rises by less than this per metre is level."""
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
    least = site.explain_tolerance_m
    more = [
        f"{entry.name} {entry.explain_tolerance_m:g}"
        for entry in site.entry.machines
        if entry.explain_tolerance_m is not None and entry.explain_tolerance_m > least
    ]
    if more:
        notes.append(
            f"explain_tolerance_m: {', '.join(more)} m have no effect: the least of all machines counts for all, which "
            f"is {least:g} m (the usual one where a machine says nothing)"
        )
    grid = site.grid()
    for contact in machine.contacts:
        lower, upper = contact.extent_m
        if (upper <= grid.lower_m).any() or (lower >= grid.upper_m).any():
            notes.append(f"contact {contact.name} lies outside the watched box: it changes nothing")
        elif (upper - lower).max() > LARGEST_LINK_M:
            notes.append(f"contact {contact.name} is {(upper - lower).max():.3g} m long: is it in metres?")
    if site.entry.machines:
        notes += _in_each_other(machine)
    standing = _wheels_on_the_floor(machine, site)
    if standing:
        notes.append(
            f"wheels that touch the floor at rest: {', '.join(standing)}; the floor is a surface, so all "
            "motions that move them stop; say that they stand on it (machine: stands_on)"
        )
    return tuple(notes)


def _in_each_other(machine: Machine) -> list[str]:
    """Links of different machines that touch in nearly all poses, or of which one stands in the other."""
    bodies = [row for row, link in enumerate(machine.links) if link.has_geometry]
    names = machine.link_names
    rows = [
        (a, b)
        for a, b in combinations(bodies, 2)
        if names[a].partition(BETWEEN)[0] != names[b].partition(BETWEEN)[0]
        and not is_allowed(machine, names[a], names[b])
    ]
    placed = machine.random_places(POSES)
    always = always_touching(machine.shape, rows, placed)
    met = [
        f"{names[a]} and {names[b]}"
        for (a, b), touch in zip(rows, always, strict=True)
        if touch or (not can_move_apart(machine, a, b) and holds(machine.links, a, b, placed[0]))
    ]
    if not met:
        return []
    more = f" and {len(met) - MOST_NOTES} pairs more" if len(met) > MOST_NOTES else ""
    return [
        f"links of different machines that lie in each other in nearly all poses: {', '.join(met[:MOST_NOTES])}{more}; "
        "they are not compared: correct world_from_base, or name them in allowed_contacts, beside machines"
    ]


def _wheels_on_the_floor(machine: Machine, site: Site) -> list[str]:
    """Checked links that move and turn without end about a level axis, and reach down to the floor at rest.

    The floor is at height 0, or at the bottom of the grid.
    """
    grid = site.grid()
    near = ON_THE_FLOOR_VOXELS * grid.voxel_size_m
    floors = [height for height in (0.0, float(grid.lower_m[2])) if height >= grid.lower_m[2]]
    asked = [joint for joint in machine.joint_names if joint in site.entry.joints]
    moving = {name for joint in asked for name in machine.moved_links(joint)}
    turning = {
        joint.child: joint for joint in machine.joints if joint.unit == "rad" and np.isinf(joint.upper)
    }
    placed = machine.world_from_links(machine.nearest_to_zero())
    standing = []
    for link in machine.links:
        if link.name not in moving & set(machine.checked_links) & set(turning):
            continue
        up = placed[link.name][2]
        lowest = float((link.vertices @ up[:3] + up[3]).min())
        is_level = abs(up[:3] @ turning[link.name].axis_in_joint) < LEVEL
        if is_level and any(abs(lowest - floor) <= near for floor in floors):
            standing.append(link.name)
    return standing
