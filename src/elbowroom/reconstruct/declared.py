"""What is free about the fixed things of declared contacts, for the links that may be near them."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from elbowroom.geometry import DepthCamera, VoxelGrid, bits
from elbowroom.geometry.bits import Words
from elbowroom.geometry.kept import kept
from elbowroom.machine import Machine, Zone, body_words
from elbowroom.machine.contact import Contact
from elbowroom.machine.things import thing_of, with_things
from elbowroom.machine.zone_words import zone_words
from elbowroom.reconstruct.carve import carve_images
from elbowroom.reconstruct.explained import explain
from elbowroom.reconstruct.images import RoomImages
from elbowroom.reconstruct.resolve import decide
from elbowroom.reconstruct.terms import Terms
from elbowroom.sensing import Snapshot

SIGMAS = 3.0
"""A return is the thing that lies within so many sigmas of it, besides `explain_tolerance_m`."""


def declared_words(
    grid: VoxelGrid,
    cameras: Sequence[DepthCamera],
    images: RoomImages,
    snapshot: Snapshot,
    machine: Machine,
    terms: Terms,
    focus: NDArray[np.bool_] | None = None,
) -> tuple[Words, ...]:
    """For each of a machine's contacts, the plane of the voxels that its links may have.

    The thing is explained in the images as the machine is: what fits it says nothing but that space is free up to it,
    and what stands out of it disputes, as everywhere. So a voxel near it is free by the same evidence and the same
    rule as all others are; voxels that the thing itself covers, grown by half a voxel, are free
    beside such, where nothing else may lie in them. Less evidence leaves fewer.

    Args:
        grid: the watched box.
        cameras, images: of the room.
        snapshot: says where the machine was.
        machine: with contacts.
        terms: how strictly space is judged.
        focus: blocks that are looked at; None: all.
    """
    near = [_near(contact, grid) for contact in machine.contacts]
    blocks = np.bitwise_or.reduce(near) != 0
    if focus is not None:
        blocks &= focus
    explained = explain(grid, with_things(machine), images, snapshot, terms, SIGMAS)
    evidence = carve_images(grid, images, explained, terms, complete=terms.needs_counts, focus=blocks)
    if focus is not None:
        near = [np.where(focus, words, np.uint64(0)) for words in near]
    space = decide(evidence, cameras, machine, snapshot.joints_at_newest, replace(terms, look_again=False))
    elsewhere = _elsewhere(evidence.unexplained, space.disputed_words)
    beside = _beside(space.free_words, grid) & ~elsewhere
    return tuple(
        (space.free_words | (_covered(contact, grid) & beside)) & words
        for contact, words in zip(machine.contacts, near, strict=True)
    )


def _beside(words: Words, grid: VoxelGrid) -> Words:
    """The plane of the voxels that are set, and of all that touch one: what lies beside space that was seen to be free.

    Under a thing that stands on a table nobody sees the table.
    """
    mask = np.pad(bits.unpack(words, grid), 1)
    for axis in range(3):
        mask = mask | np.roll(mask, 1, axis) | np.roll(mask, -1, axis)
    return bits.pack(np.ascontiguousarray(mask[1:-1, 1:-1, 1:-1]), grid)


def _elsewhere(unexplained: Words, disputed: Words) -> Words:
    """Where something else than the thing may lie: what nobody explains, and what anybody disputes."""
    return unexplained | disputed


@kept
def _near(contact: Contact, grid: VoxelGrid) -> Words:
    """The plane of the voxels that a contact may change: near its thing, and in its zone."""
    words = body_words(thing_of(contact), {}, grid, contact.near_m)
    if contact.zone is None:
        return words
    return words & zone_words(Zone.box(contact.name, "kept_out", *contact.zone), grid, True)


@kept
def _covered(contact: Contact, grid: VoxelGrid) -> Words:
    """The plane of the voxels that a contact's thing covers, grown by half a voxel."""
    return body_words(thing_of(contact), {}, grid)
