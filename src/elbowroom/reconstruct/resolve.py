"""Evidence -> free space, by a rule; the machine's body taken out."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import Literal, get_args

import numpy as np

from elbowroom.errors import EvidenceError, InputError
from elbowroom.geometry import DepthCamera, bits
from elbowroom.geometry.bits import Words
from elbowroom.geometry.margin import Margin
from elbowroom.machine import Machine, body_words
from elbowroom.reconstruct.carve import Detail, carve
from elbowroom.reconstruct.evidence import Evidence, merge
from elbowroom.reconstruct.free_space import FreeSpace, Source

Rule = Literal["three", "majority", "veto", "any"]
RULES: tuple[Rule, ...] = get_args(Rule)
LAWFUL: tuple[str, ...] = ("three", "majority")
"""Rules by which less evidence never adds free space."""


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


_DECIDE: dict[str, Callable[[Evidence], Words]] = {
    "three": _three,
    "majority": _majority,
    "veto": _veto,
    "any": _any,
}


def needs_complete(rule: Rule) -> bool:
    """Whether evidence must be carved with `complete=True` for this rule.

    Raises:
        InputError: an unknown rule.
    """
    if rule not in RULES:
        raise InputError(f"rule: {rule!r} is unknown, allowed are {', '.join(RULES)}")
    return rule != "three"


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
    source: Source | None = None,
    threads: int | None = None,
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
        body_growth_m: by how much the body is grown, at least a quarter voxel [m]; None: half a voxel. Evidence of
            returns that the machine does not explain must have been looked for with the same growth.
        source: where the evidence comes from, for `FreeSpace.explain`.
        threads: None: all cores.

    Raises:
        InputError: an unknown rule, or a machine without joints.
        MachineError: impossible joints, or a growth below a quarter voxel.
        EvidenceError: the rule needs counts and the evidence has none.
    """
    complete = needs_complete(rule)
    if complete and evidence.counts is None:
        raise EvidenceError(f"resolve: rule {rule} needs evidence carved with complete=True")
    silent = [camera for camera in cameras if camera.name not in evidence.cameras]
    if silent:
        blank = carve(
            evidence.grid, silent, [], detail=detail, margin=margin, complete=complete, threads=threads
        )
        evidence = merge([evidence, blank])
    free = _DECIDE[rule](evidence) & bits.inside(evidence.grid)
    body = bits.empty(evidence.grid)
    if machine is not None:
        if joints is None:
            raise InputError("resolve: a machine without joints; give its joint positions by name")
        body = body_words(machine, joints, evidence.grid, body_growth_m, threads) & ~evidence.unexplained
        free = free | body
    blocked = ~free & bits.inside(evidence.grid)
    surface: Words = (evidence.surface | evidence.unexplained) & blocked
    return FreeSpace(
        evidence.grid,
        free,
        surface,
        evidence.blind & blocked & ~surface,
        (evidence.disputed | evidence.unexplained) & blocked,
        body,
        None if source is None else replace(source, free_words=free),
    )
