"""The fixed things of a machine's declared contacts, as links that stand still beside it."""

from dataclasses import replace

import numpy as np

from elbowroom.geometry import invert_rigid
from elbowroom.geometry.kept import kept
from elbowroom.machine.contact import Contact
from elbowroom.machine.kernels.body import FIXED, Tree
from elbowroom.machine.link import Link
from elbowroom.machine.machine import Machine


@kept
def with_things(machine: Machine) -> Machine:
    """The machine and, after its links, a link that never moves for the thing of each of its contacts."""
    count = len(machine.contacts)
    if not count:
        return machine
    base_from_world = invert_rigid(machine.world_from_base)
    things = tuple(
        Link(
            contact.name,
            contact.surface.vertices @ base_from_world[:3, :3].T + base_from_world[:3, 3],
            contact.surface.faces,
        )
        for contact in machine.contacts
    )
    tree = machine.tree
    stands = Tree(
        parent=np.append(tree.parent, np.full(count, -1)),
        parent_from_joint=np.concatenate([tree.parent_from_joint, np.tile(np.eye(4), (count, 1, 1))]),
        axis=np.concatenate([tree.axis, np.zeros((count, 3))]),
        kind=np.append(tree.kind, np.full(count, FIXED)),
        column=np.append(tree.column, np.full(count, -1)),
        multiplier=np.append(tree.multiplier, np.ones(count)),
        offset=np.append(tree.offset, np.zeros(count)),
    )
    return replace(machine, links=(*machine.links, *things), tree=stands, contacts=())


def thing_of(contact: Contact) -> Machine:
    """A contact's thing as a machine that has no joint, in the world's frame."""
    surface = contact.surface
    tree = Tree(
        parent=np.array([-1]),
        parent_from_joint=np.eye(4)[None],
        axis=np.zeros((1, 3)),
        kind=np.array([FIXED]),
        column=np.array([-1]),
        multiplier=np.ones(1),
        offset=np.zeros(1),
    )
    return Machine(contact.name, (Link(contact.name, surface.vertices, surface.faces),), (), tree)
