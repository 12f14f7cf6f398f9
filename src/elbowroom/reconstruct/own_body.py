"""The voxels of the machine's own body, which are made free where nothing else was seen in them."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from elbowroom.errors import InputError
from elbowroom.geometry import DepthCamera, VoxelGrid, bits
from elbowroom.geometry.bits import Words
from elbowroom.machine import Machine, body_words
from elbowroom.reconstruct.evidence import Evidence
from elbowroom.reconstruct.growth import growth_of
from elbowroom.reconstruct.terms import Terms


@dataclass(frozen=True, slots=True, eq=False)
class OwnBody:
    """Planes of what the grown body covers.

    Args:
        covered: by the machine that moves.
        seen: by the machine as cameras see it, where its model is larger than that; None: they are the same.
    """

    covered: Words
    seen: Words | None

    def decided(self, unexplained: Words | None) -> Words:
        """The voxels that become free whatever cameras say of them, so that none need be asked.

        Args:
            unexplained: plane of those in which returns lie that the machine does not explain; None: none.
        """
        alone = self.covered if unexplained is None else self.covered & ~unexplained
        return alone if self.seen is None else alone & self.seen

    def taken_out(self, evidence: Evidence) -> Words:
        """The voxels that become free.

        Where the model is larger than what cameras see of it, nothing else may be disputed: a hand in its excess is.
        """
        free = self.covered & ~evidence.unexplained
        return free if self.seen is None else free & (self.seen | ~evidence.disputed)


def own_body(
    grid: VoxelGrid,
    cameras: Sequence[DepthCamera],
    machine: Machine | None,
    joints: Mapping[str, float] | None,
    terms: Terms,
) -> OwnBody:
    """The body of a machine where it is; of a bare room nothing.

    Args:
        grid: the watched box.
        cameras: of the room; what their pixels cover says by how much the body is grown, if the terms do not.
        machine, joints: whose body, and where it is; both None: the bare room.
        terms: say by how much it is grown.

    Raises:
        InputError: a machine without joints.
        MachineError: impossible joints, or a growth below a quarter voxel.
    """
    growth_m = growth_of(grid, cameras, terms)
    if machine is None:
        return OwnBody(bits.empty(grid), None)
    if joints is None:
        raise InputError("resolve: a machine without joints; give its joint positions by name")
    covered = body_words(machine, joints, grid, growth_m)
    if machine.as_seen is machine:
        return OwnBody(covered, None)
    return OwnBody(covered, body_words(machine.as_seen, joints, grid, growth_m))
