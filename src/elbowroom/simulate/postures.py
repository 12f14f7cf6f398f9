"""Poses of a machine that touch nothing: neither the room that it stands in nor the machine itself."""

import itertools
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from elbowroom.errors import InputError
from elbowroom.geometry import VoxelGrid
from elbowroom.machine import Machine
from elbowroom.simulate.machine_solids import link_solids, random_joints
from elbowroom.simulate.solid import Solid
from elbowroom.simulate.taken import Taken, share_space
from elbowroom.simulate.truth import touched_by

TRIES = 200


@dataclass(frozen=True, eq=False)
class Postures:
    """What a machine can do in a room.

    What it stands on does not count: a link that no joint moves may be where it is, and whatever shares less than about
    a voxel with something else touches it, but does not stand in it.

    Args:
        machine: its checked links are looked at.
        taken: by the room.
        box: that they must not leave; None: they may be anywhere.
    """

    machine: Machine
    taken: Taken
    box: VoxelGrid | None = None

    def trouble(self, joints: Mapping[str, float]) -> str | None:
        """What is wrong with a pose, in words; None: nothing is.

        Raises:
            MachineError: joints that are not possible.
        """
        links = [link for link in link_solids(self.machine, joints) if link.name in self._looked_at]
        for link in links:
            if self._leaves(link):
                return f"{link.name} leaves the watched box"
            if self.taken.meets(link):
                return f"{link.name} stands in {' and '.join(self.taken.what_meets(link)) or 'the room'}"
        both = next(iter(self._in_itself(joints, self._apart)), None)
        return None if both is None else f"{both[1]} stands in {both[0]}, another link of it"

    def usual(self, rng: np.random.Generator) -> dict[str, float]:
        """Joints at zero, or as near to it as they go; if that touches something, a pose drawn at random.

        Args:
            rng: source of randomness.

        Raises:
            InputError: as `drawn`.
        """
        joints = self.machine.nearest_to_zero()
        return joints if self.trouble(joints) is None else self.drawn(rng)

    def drawn(self, rng: np.random.Generator, tries: int = TRIES) -> dict[str, float]:
        """A pose that touches nothing, drawn at random.

        Args:
            rng: source of randomness.
            tries: how often.

        Raises:
            InputError: none was found; says what was in the way most often.
        """
        found: dict[str, int] = {}
        for _ in range(tries):
            joints = random_joints(self.machine, rng)
            trouble = self.trouble(joints)
            if trouble is None:
                return joints
            found[trouble] = found.get(trouble, 0) + 1
        most = max(found, key=lambda words: found[words])
        raise InputError(
            f"no pose of {self.machine.name} that touches nothing in {tries} tries; most often {most}: correct the "
            "room, the watched box or the place of the machine's base, or give a pose"
        )

    def _leaves(self, link: Solid) -> bool:
        vertices, box = link.vertices_in_world, self.box
        if box is None:
            return False
        return bool((vertices.min(axis=0) < box.lower_m).any() or (vertices.max(axis=0) > box.upper_m).any())

    @cached_property
    def _looked_at(self) -> frozenset[str]:
        """Links that some joint moves, and that are checked."""
        moved = {link for joint in self.machine.joint_names for link in self.machine.moved_links(joint)}
        return frozenset(moved & set(self.machine.checked_links))

    @cached_property
    def _apart(self) -> frozenset[tuple[str, str]]:
        """Pairs of links that must not share space: no neighbours, and apart where the machine is at zero."""
        names = [link.name for link in self.machine.links if link.has_geometry]
        pairs = frozenset(
            (a, b) for a, b in itertools.combinations(names, 2) if not self._are_neighbours(a, b)
        )
        return pairs - frozenset(self._in_itself(self.machine.nearest_to_zero(), pairs))

    def _in_itself(
        self, joints: Mapping[str, float], pairs: frozenset[tuple[str, str]]
    ) -> list[tuple[str, str]]:
        """Of some pairs of links those that share space."""
        solids = {link.name: link for link in link_solids(self.machine, joints)}
        grid = self.taken.grid
        voxels = {name: touched_by(grid, solid, surface=False) for name, solid in solids.items()}
        return [pair for pair in sorted(pairs) if share_space(voxels[pair[0]], voxels[pair[1]])]

    def _are_neighbours(self, a: str, b: str) -> bool:
        """Whether one carries the other, or one link carries both; links without a body do not count."""
        above_a, above_b = self._carrier(a), self._carrier(b)
        return a == above_b or b == above_a or above_a == above_b

    def _carrier(self, name: str) -> str | None:
        """The nearest link above one that has a body."""
        names, parents = self.machine.link_names, self.machine.tree.parent
        row = int(parents[names.index(name)])
        while row >= 0 and not self.machine.links[row].has_geometry:
            row = int(parents[row])
        return None if row < 0 else names[row]
