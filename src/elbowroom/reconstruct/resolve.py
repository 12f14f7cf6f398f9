"""Evidence -> free space, by a rule; the machine's body taken out."""

from collections.abc import Callable, Mapping, Sequence

import numpy as np

from elbowroom.choices import Detail, Rule
from elbowroom.errors import EvidenceError
from elbowroom.geometry import DepthCamera, bits
from elbowroom.geometry.bits import Words
from elbowroom.geometry.margin import Margin
from elbowroom.machine import Machine
from elbowroom.reconstruct.carve import carve_images
from elbowroom.reconstruct.evidence import Evidence, merge
from elbowroom.reconstruct.explained import NOTHING
from elbowroom.reconstruct.free_space import FreeSpace
from elbowroom.reconstruct.images import room_images
from elbowroom.reconstruct.own_body import OwnBody, own_body
from elbowroom.reconstruct.terms import Terms
from elbowroom.reconstruct.witnesses import witnesses


def _three(evidence: Evidence) -> Words:
    """Three see through, or one does and none disputes (thesis 3.2)."""
    one, _, three = evidence.through
    return three | (one & ~evidence.disputed)


def _majority(evidence: Evidence) -> Words:
    """More cameras see through than dispute."""
    if evidence.counts is None:
        raise EvidenceError("resolve: rule majority needs counts; carve with complete=True")
    free = evidence.counts.through > evidence.counts.disputes
    return np.packbits(free.reshape(-1), bitorder="little").view(np.uint64)


def _veto(evidence: Evidence) -> Words:
    """One sees through, and no camera measured a surface there. Not lawful: losing that camera frees its surface."""
    return evidence.through[0] & ~evidence.surface


def _any(evidence: Evidence) -> Words:
    """One sees through, whatever the others say. Not lawful, and not safe: for comparison."""
    return evidence.through[0]


_DECIDE: dict[Rule, Callable[[Evidence], Words]] = {
    "three": _three,
    "majority": _majority,
    "veto": _veto,
    "any": _any,
}


def resolve(
    evidence: Evidence,
    cameras: Sequence[DepthCamera],
    *,
    rule: Rule = "three",
    detail: Detail = "pixel",
    margin: Margin | None = None,
    machine: Machine | None = None,
    joints: Mapping[str, float] | None = None,
    body_growth_m: float | None = None,
) -> FreeSpace:
    """Decides for each voxel whether it is free.

    A camera of the room that gave no evidence disputes all that it looks at: otherwise losing the one camera that
    sees a hand would free the hand.

    Args:
        evidence: merged, of any of the room's cameras, and of other sensors.
        cameras: all cameras of the room.
        rule: how cameras that disagree are decided between. Only `three` and `majority` are lawful.
        detail, margin: as the evidence was carved with; used for cameras that gave none.
        machine, joints: whose body to take out, and where it is; both None: the bare room.
        body_growth_m: by how much the body is grown, at least a quarter voxel [m]; None: by what a pixel covers
            (`growth.growth_of`). Evidence of returns that the machine does not explain must have been looked for
            with the same growth.

    Raises:
        InputError: an unknown rule, or a machine without joints.
        MachineError: impossible joints, or a growth below a quarter voxel.
        EvidenceError: the rule needs counts and the evidence has none, or cameras that are one witness were carved
            apart.
    """
    terms = Terms(rule, detail, margin or Margin(), body_growth_m=body_growth_m)
    return decide(evidence, cameras, machine, joints, terms)


def decide(
    evidence: Evidence,
    cameras: Sequence[DepthCamera],
    machine: Machine | None,
    joints: Mapping[str, float] | None,
    terms: Terms,
) -> FreeSpace:
    """As `resolve`, by terms.

    Args:
        evidence, cameras, machine, joints: as of `resolve`.
        terms: those by which the evidence was carved.

    Raises:
        InputError, MachineError, EvidenceError: as `resolve`.
    """
    return decide_around(evidence, cameras, own_body(evidence.grid, cameras, machine, joints, terms), terms)


def decide_around(
    evidence: Evidence, cameras: Sequence[DepthCamera], own: OwnBody, terms: Terms
) -> FreeSpace:
    """As `decide`, where it is known which voxels are the machine's own.

    Args:
        evidence, cameras, terms: as of `decide`.
        own: the machine's body. Of voxels that it decides (`OwnBody.decided`) the evidence need say nothing.

    Raises:
        EvidenceError: as `resolve`.
    """
    grid = evidence.grid
    if terms.needs_counts and evidence.counts is None:
        raise EvidenceError(f"resolve: rule {terms.rule} needs evidence carved with complete=True")
    if terms.rule == "three":
        _require_one_witness(evidence, cameras)
    evidence = _with_silent(evidence, cameras, terms)
    free = _DECIDE[terms.rule](evidence) & bits.inside(grid)
    body = own.taken_out(evidence)
    free = free | body
    blocked = ~free & bits.inside(grid)
    surface: Words = (evidence.surface | evidence.unexplained) & blocked
    return FreeSpace(
        grid,
        free,
        surface,
        evidence.blind & blocked & ~surface,
        (evidence.disputed | evidence.unexplained) & blocked,
        body,
    )


def _require_one_witness(evidence: Evidence, cameras: Sequence[DepthCamera]) -> None:
    """Cameras that are one witness must have been carved together: evidence of each alone counts as one of its own."""
    for group in witnesses(evidence.grid, tuple(cameras), evidence.witness_angle_deg):
        near = {cameras[number].name for number in group} & set(evidence.cameras)
        if len(near) > 1 and not any(near <= together for together in evidence.as_one):
            raise EvidenceError(
                f"resolve: cameras {', '.join(sorted(near))} stand within {evidence.witness_angle_deg:g} degrees of "
                "each other, as seen from the grid, and are one witness: carve them in one group"
            )


def _with_silent(evidence: Evidence, cameras: Sequence[DepthCamera], terms: Terms) -> Evidence:
    """The evidence, and that of cameras that gave none: they dispute all that they look at."""
    silent = [camera for camera in cameras if camera.name not in evidence.cameras]
    if not silent:
        return evidence
    blank = carve_images(evidence.grid, room_images(silent, []), NOTHING, terms, complete=terms.needs_counts)
    return merge([evidence, blank])
