"""The machine's links as solids of the room, and the smooth course that its joints take."""

from collections.abc import Mapping

import numpy as np

from elbowroom.geometry.kept import kept
from elbowroom.machine import Machine
from elbowroom.machine.poses import REACH, drawn_between
from elbowroom.machine.shape import Shape
from elbowroom.simulate.solid import Mesh, Solid

COURSE: dict[str, tuple[float, float]] = {
    "long": (0.20, 23.0),
    "larm": (0.35, 31.0),
    "propeller": (0.45, 19.0),
    "carc": (0.40, 13.0),
}
"""How far [m or rad] and with what period [s] the ceiling C-arm's joints swing: below their full speeds."""


def link_solids(machine: Machine, joints: Mapping[str, float]) -> tuple[Solid, ...]:
    """One solid for each link that has a body: what cameras see of it.

    Args:
        machine: any machine.
        joints: its joint positions by name [m or rad].

    Raises:
        MachineError: unknown or missing joints, or positions beyond their limits.
    """
    world_from_links = machine.world_from_links(joints)
    return tuple(
        Solid(name, mesh, world_from_links[name], is_machine=True)
        for name, mesh in _meshes_of(machine.as_seen.shape).items()
    )


def course(machine: Machine, time_s: float) -> dict[str, float]:
    """Joint positions at a time: slow swings within the limits, each joint with its own period.

    Joints that `COURSE` does not name swing over a tenth of their range, of a turn or 2 pi m at most.
    """
    return {name: _swing(machine, name, time_s) for name in machine.joint_names}


def random_joints(machine: Machine, rng: np.random.Generator) -> dict[str, float]:
    """Positions drawn evenly from each joint's limits; a joint without limits takes a whole turn."""
    drawn = {}
    for name in machine.joint_names:
        low, high = drawn_between(machine.joint(name))
        drawn[name] = float(rng.uniform(low, high))
    return drawn


def _swing(machine: Machine, name: str, time_s: float) -> float:
    low, high = drawn_between(machine.joint(name))
    middle = min(max(0.0, low), high)
    amplitude, period_s = COURSE.get(name, (0.05 * min(high - low, 2 * REACH), 20.0))
    value = middle + amplitude * np.sin(2 * np.pi * time_s / period_s)
    return float(min(max(value, low), high))


@kept
def _meshes_of(shape: Shape) -> dict[str, Mesh]:
    return {link.name: Mesh(link.vertices, link.faces) for link in shape.links if link.has_geometry}
