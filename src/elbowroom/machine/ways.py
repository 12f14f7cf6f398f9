"""Where links go: which of them a volume covers wherever they are, and how far they can reach at most."""

from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray

from elbowroom.machine.kernels.body import SLIDES
from elbowroom.machine.machine import Machine

POSES = 64
"""So many poses, drawn from the joints' limits, stand for all that a link can do."""
COARSE_M = 0.002
"""Fine meshes are looked at with triangles that lie off them by this at most [m]."""

Inside = Callable[[NDArray[np.float64]], NDArray[np.bool_]]
"""Whether points, shape (n, 3), world frame [m], lie in a volume."""


Names = Callable[[str], bool]
"""Whether a volume is one for a link, by its name."""


def never_out_of(machine: Machine, volumes: Sequence[tuple[Inside, Names]]) -> tuple[str, ...]:
    """Links that move and lie wholly in the union of their volumes in all of some random poses.

    Args:
        machine: whose links.
        volumes: which points each holds, and for which links it is; what holds the corners and the middles of a link's
            triangles holds the link.
    """
    placed = machine.random_places(POSES)
    bodies = machine.shape.within(COARSE_M)
    covered = []
    for row, link in enumerate(machine.links):
        own = [inside for inside, names in volumes if names(link.name)]
        if not (own and link.has_geometry and moves(machine, row)):
            continue
        corners = bodies[row].vertices[np.unique(bodies[row].faces)]
        if len(own) > 1:  # those of one, which is convex, say it of the middles too
            corners = np.concatenate([corners, bodies[row].vertices[bodies[row].faces].mean(axis=1)])
        if all(_is_in(own, corners @ pose[:3, :3].T + pose[:3, 3]) for pose in placed[:, row]):
            covered.append(link.name)
    return tuple(covered)


def _is_in(volumes: Sequence[Inside], points: NDArray[np.float64]) -> bool:
    """Whether each of some points lies in one of some volumes."""
    return bool(np.any([inside(points) for inside in volumes], axis=0).all())


def moves(machine: Machine, row: int) -> bool:
    """Whether any joint moves a link; `row`: of the link."""
    while row >= 0:
        if machine.tree.column[row] >= 0:
            return True
        row = int(machine.tree.parent[row])
    return False


def reach_m(machine: Machine) -> float:
    """No point of the machine is ever farther from its base than this [m]; infinity: a joint slides without end."""
    tree, most = machine.tree, 0.0
    lengths = np.linalg.norm(tree.parent_from_joint[:, :3, 3], axis=1)
    for row in np.flatnonzero(tree.kind == SLIDES).tolist():
        joint = machine.joint(machine.joint_names[tree.column[row]])
        ends = np.array([joint.lower, joint.upper]) * tree.multiplier[row] + tree.offset[row]
        lengths[row] += float(np.abs(ends).max())
    parent = tree.parent.tolist()
    for row, link in enumerate(machine.links):
        if link.has_geometry:
            away, above = float(np.linalg.norm(link.vertices, axis=1).max()), row
            while parent[above] >= 0:
                away += float(lengths[above])
                above = parent[above]
            most = max(most, away)
    return most
