"""Which pairs of a machine's links need not be compared, found as MoveIt's setup assistant does."""

from collections.abc import Callable
from itertools import combinations

import numpy as np

from elbowroom.machine import Machine
from elbowroom.machine.kernels.apart import apart_now
from elbowroom.machine.kernels.body import TURNS
from elbowroom.machine.overlap import ALWAYS, TOUCH_M, bodies_of
from elbowroom.machine.poses import is_bounded
from elbowroom.motion.contacts import can_move_apart, next_body

NEVER_M = 0.02
"""Links that came no nearer than this in any pose never meet [m]."""


def found_pairs(
    machine: Machine, poses: int, seed: int = 0, tell: Callable[[int], None] | None = None
) -> dict[str, list[tuple[str, str]]]:
    """Pairs of links that need not be compared, by reason.

    Links that a joint joins (*adjacent*), that touch in nearly all poses (*always*), at zero (*default*), or come no
    nearer than 2 cm in any (*never*); poses are drawn from the joints' limits. MoveIt calls *never* what touches in no
    pose: here it has room to spare, as poses between those that were tried are not looked at. Links between which one
    slides without end are never called so: no draw says how they come to each other.

    Args:
        machine: whose links.
        poses: how many are tried.
        seed: of the poses.
        tell: called with how many were tried so far.
    """
    names, links = machine.link_names, range(len(machine.links))
    rows = [
        pair
        for pair in combinations([row for row in links if machine.links[row].has_geometry], 2)
        if can_move_apart(machine, *pair)
    ]
    adjacent = [next_body(machine, b) == a for a, b in rows]
    bodies = bodies_of(machine.shape, rows)
    touched, nearest = np.zeros(len(rows)), np.full(len(rows), np.inf)
    apart = np.empty(len(rows))
    for count, placed in enumerate(machine.random_places(poses, seed)):
        apart_now(bodies, placed, NEVER_M, apart)
        touched += apart <= TOUCH_M
        nearest = np.minimum(nearest, apart)
        if tell is not None:
            tell(count + 1)
    rest = machine.world_from_link_array(machine.positions(machine.nearest_to_zero())[None])[0]
    apart_now(bodies, rest, NEVER_M, apart)
    nearest = np.minimum(nearest, apart)
    found: dict[str, list[tuple[str, str]]] = {
        reason: [] for reason in ("adjacent", "always", "default", "never")
    }
    for n, (a, b) in enumerate(rows):
        reason = (
            "adjacent"
            if adjacent[n]
            else "always"
            if touched[n] >= ALWAYS * poses
            else "default"
            if apart[n] <= TOUCH_M
            else "never"
            if nearest[n] > NEVER_M and not _endless_between(machine, a, b)
            else None
        )
        if reason is not None:
            found[reason].append((names[a], names[b]))
    return found


def _endless_between(machine: Machine, a: int, b: int) -> bool:
    """Whether a joint lies between two links of whose way draws show a part alone; a turn shows all turns.

    Args:
        machine: whose links.
        a, b: their rows.
    """
    tree = machine.tree
    one, other = _way_up(machine, a), _way_up(machine, b)
    joints = [machine.joint(name) for name in machine.joint_names]
    return any(
        tree.column[row] >= 0
        and not is_bounded(joints[tree.column[row]])
        and not (tree.kind[row] == TURNS and abs(tree.multiplier[row]) == 1)
        for row in one ^ other
    )


def _way_up(machine: Machine, row: int) -> set[int]:
    """The rows of a link and of all those that it hangs on."""
    way = set()
    while row >= 0:
        way.add(row)
        row = int(machine.tree.parent[row])
    return way
