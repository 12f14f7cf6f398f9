"""Several machines of one site as one: each is explained, taken out and swept, and each ends the others' travel."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from elbowroom.errors import MachineError
from elbowroom.machine.contact import Contact
from elbowroom.machine.joint import Joint, Mimic
from elbowroom.machine.joint_state import JointTolerance
from elbowroom.machine.kernels.body import FIXED, Tree
from elbowroom.machine.link import Link
from elbowroom.machine.machine import Machine
from elbowroom.machine.own_links import OwnLinks

ROOM = "room"
"""The link without a body that all machines stand on."""
BETWEEN = "/"
"""Stands between a machine's name and its link's."""


@dataclass(frozen=True, slots=True)
class Member:
    """A machine among others.

    Args:
        name: stands before the names of its links: `left/tool`.
        machine: the machine, at its place.
        joint_prefix: stands before the names of its joints; "": nothing does.
    """

    name: str
    machine: Machine
    joint_prefix: str = ""


def together(members: Sequence[Member]) -> Machine:
    """One machine of several, whose base is the world's origin.

    Args:
        members: each with a name of its own, and joints whose names no other has.

    Raises:
        MachineError: no members, a name twice, or two joints of one name; says what to do.
    """
    if not members:
        raise MachineError("machines: none; at least one is needed")
    _require_names(members)
    links, joints, trees = [Link(ROOM, np.zeros((0, 3)), np.zeros((0, 3), dtype=np.int32))], [], [_root()]
    columns = 0
    for member in members:
        machine = member.machine
        links += [_renamed(link, member.name) for link in machine.links]
        joints += [_of(joint, member) for joint in machine.joints]
        trees.append(_moved(machine, len(links) - len(machine.links), columns))
        columns += len(machine.joint_names)
    machines = [member.machine for member in members]
    return Machine(
        " and ".join(member.name for member in members),
        tuple(links),
        tuple(joints),
        Tree(*(np.concatenate(arrays) for arrays in zip(*trees, strict=True))),
        unchecked_links=_all(members, lambda m: m.unchecked_links),
        allowed_contacts=tuple(
            (_long(member, a), _long(member, b))
            for member in members
            for a, b in member.machine.allowed_contacts
        ),
        own_links=_own_links(members),
        stands=tuple(
            replace(stand, links=tuple(_long(member, link) for link in stand.links))
            for member in members
            for stand in member.machine.stands
        ),
        contacts=_contacts(members),
        parts=_all(members, lambda m: m.parts),
        bodiless_links=_all(members, lambda m: m.bodiless_links),
        tolerance=_tolerance(members),
        findings=tuple(finding for machine in machines for finding in machine.findings),
    )


def _require_names(members: Sequence[Member]) -> None:
    """Each machine has a name of its own, and so has each joint."""
    names = [member.name for member in members]
    doubled = sorted({name for name in names if names.count(name) > 1})
    if doubled:
        raise MachineError(f"machines: {doubled[0]} is there more than once; each needs a name of its own")
    owner: dict[str, str] = {}
    for member in members:
        for joint in member.machine.joints:
            name = member.joint_prefix + joint.name
            if name in owner:
                raise MachineError(
                    f"machines: {owner[name]} and {member.name} both have a joint {name}, and joint states could "
                    f"not be told apart: give one of them a joint_prefix, such as {member.name}_, as its joints are "
                    "named where their positions come from"
                )
            owner[name] = member.name


def _long(member: Member, name: str) -> str:
    return member.name + BETWEEN + name


def _all(members: Sequence[Member], of: Callable[[Machine], Sequence[str]]) -> tuple[str, ...]:
    return tuple(_long(member, name) for member in members for name in of(member.machine))


def _renamed(link: Link, name: str) -> Link:
    seen = None if link.seen is None else replace(link.seen, name=name + BETWEEN + link.seen.name)
    return replace(link, name=name + BETWEEN + link.name, seen=seen)


def _of(joint: Joint, member: Member) -> Joint:
    mimic = joint.mimic
    if mimic is not None:
        mimic = Mimic(member.joint_prefix + mimic.joint, mimic.multiplier, mimic.offset)
    return replace(
        joint,
        name=member.joint_prefix + joint.name,
        parent=_long(member, joint.parent),
        child=_long(member, joint.child),
        mimic=mimic,
    )


def _root() -> Tree:
    return Tree(
        parent=np.array([-1]),
        parent_from_joint=np.eye(4)[None],
        axis=np.zeros((1, 3)),
        kind=np.array([FIXED]),
        column=np.array([-1]),
        multiplier=np.ones(1),
        offset=np.zeros(1),
    )


def _moved(machine: Machine, rows: int, columns: int) -> Tree:
    """The tree of a machine behind others, its base fixed to the first link of all.

    Args:
        machine: the machine.
        rows: links before it.
        columns: joint positions before it.
    """
    tree = machine.tree
    from_joint = tree.parent_from_joint.copy()
    from_joint[0] = machine.world_from_base
    return tree._replace(
        parent=np.where(tree.parent < 0, 0, tree.parent + rows),
        parent_from_joint=from_joint,
        column=np.where(tree.column < 0, -1, tree.column + columns),
    )


def _own_links(members: Sequence[Member]) -> OwnLinks | None:
    known = [
        member.machine.own_links.named(member.name + BETWEEN)
        for member in members
        if member.machine.own_links is not None
    ]
    return OwnLinks.all_of(known) if known else None


def _tolerance(members: Sequence[Member]) -> JointTolerance:
    """Of all: the least of each, and where they differ that of its own machine for each joint."""
    given = [member.machine.tolerance for member in members]
    own = [
        (member.joint_prefix + joint.name, member.machine.tolerance.of(joint))
        for member in members
        for joint in member.machine.joints
    ]
    least = JointTolerance(min(each.rad for each in given), min(each.m for each in given))
    return least if len(set(given)) == 1 else least._replace(own=tuple(own))


def _contacts(members: Sequence[Member]) -> tuple[Contact, ...]:
    """Things of all members; of a thing that several name, each has its own."""
    found: dict[str, Contact] = {}
    for member in members:
        for contact in member.machine.contacts:
            name = contact.name if contact.name not in found else _long(member, contact.name)
            links = tuple(_long(member, link) for link in contact.links)
            found[name] = replace(contact, name=name, links=links)
    return tuple(found.values())
