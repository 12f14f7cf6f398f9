"""Verdicts of a cell's motions beside exact geometry, pose by pose, and what they come to by cause."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from elbowroom.evaluate.cell.cell import Cell, cell_of
from elbowroom.evaluate.cell.scenes import Kind, cell_scenes
from elbowroom.evaluate.due import Due, where
from elbowroom.evaluate.rooms.exact import Contact, ExactTravel
from elbowroom.evaluate.rooms.scene import Comparison, only, settings_of
from elbowroom.geometry.margin import Margin
from elbowroom.machine import Machine
from elbowroom.motion import Cause, Level, check_motions
from elbowroom.motion.contacts import watched_rows
from elbowroom.reconstruct import FreeSpace, reconstruct
from elbowroom.simulate import Moment, render

SHOULDER_AND_ELBOW = ("shoulder_pan_joint", "shoulder_lift_joint", "elbow_joint")
"""Of the UR5: what moves its large links."""
TOUCHING = 1e-6
"""A pose from which no motion can go farther than this touches something, and is none [m or rad]."""
COMPARED = (
    *(
        "joint",
        "direction",
        "level",
        "cause",
        "link",
        "other_link",
        "free_travel",
        "free_travel_unit",
        "place_m",
    ),
    *("true_level", "true_travel", "true_link", "true_solid", "truly_clear", "milder"),
)
"""What is kept of a comparison."""
STOPPING = (Cause.SURFACE, Cause.UNSEEN, Cause.BLIND, Cause.MACHINE, Cause.OUTSIDE_GRID)
"""What can end a motion in this experiment."""
MEASURED = where(joints="shoulder and elbow", kind_of_pose="all", contact="declared")
DUE = (
    Due("stop_where_clear_pct", "≤", 15.0, MEASURED, "of the truly clear motions of shoulder and elbow stop"),
    Due("milder_level", "≤", 0, words="milder than the truth of the room"),
)


def cell_rows(
    site: Path | None = None,
    *,
    poses: int = 60,
    kinds: Sequence[Kind] = ("random", "work"),
    voxel_size_m: float | None = None,
    noise: bool = True,
    seed: int = 1,
) -> Iterator[dict[str, object]]:
    """Moments of a cell with a person in it: every motion judged from images, and by exact geometry.

    Exact geometry: how far the links that move can go until their meshes touch a solid, or another link that they
    must not touch.

    Args:
        site: its file, with a key `room`; None: the UR5 on a table.
        poses: how many, kinds in turn.
        kinds: of poses; "work" is known of arms like a UR5 alone.
        voxel_size_m: edge of a voxel [m]; None: the site's.
        noise: whether the sensors scatter as the site says, and the margin allows for it; False: exact images.
        seed: of poses, people and noise.

    Yields:
        A row of kind "verdict" for each pose and motion.

    Raises:
        PackageError: coal, or the package with the UR5, is not installed.
        InputError: a site that is no cell; see `cell_of` and `cell_scenes`.
    """
    cell, done = cell_of(site, voxel_size_m), 0
    names = cell.machine.link_names
    own_pairs = [(names[a], names[b]) for a, b in watched_rows(cell.machine)]
    for number, drawn in enumerate(cell_scenes(cell, seed, tuple(kinds))):
        truths = _truths(cell, drawn.moment, own_pairs)
        if any(truth.travel < TOUCHING for truth in truths):
            continue
        space = _space_of(cell, drawn.moment, noise, seed + number)
        said = {"kind": "verdict", "pose": number, "kind_of_pose": drawn.kind, **_settings(cell, noise, seed)}
        for contact, machine in _machines(cell).items():
            verdicts = check_motions(space, machine, drawn.moment.joints, cell.motions)
            for motion, verdict, truth in zip(cell.motions, verdicts, truths, strict=True):
                row = only(Comparison(motion, verdict, truth).row(), COMPARED)
                yield said | row | {"contact": contact, "true_own": truth.solid in machine.link_names}
        done += 1
        if done == poses:
            return


def _settings(cell: Cell, noise: bool, seed: int) -> dict[str, object]:
    return {
        "cell": cell.site.name,
        "voxel_size_m": cell.grid.voxel_size_m,
        "detail": cell.terms.detail,
        "noise": noise,
        "seed": seed,
        "cameras": len(cell.cameras),
        "width": max(camera.width for camera in cell.cameras),
        "height": max(camera.height for camera in cell.cameras),
    }


def _truths(cell: Cell, moment: Moment, own: Sequence[tuple[str, str]]) -> list[Contact]:
    """How far each motion really can go; `own`: links that must not touch each other."""
    machine, joints = cell.machine, moment.joints
    exact = ExactTravel(machine, moment.solids)
    return [
        _earlier(exact.until_contact(joints, motion), exact.until_own_contact(joints, motion, own))
        for motion in cell.motions
    ]


def _machines(cell: Cell) -> dict[str, Machine]:
    """As the site declares what links may be near, and without a word of it, where it declares anything."""
    machine = cell.machine
    if not (machine.stands or machine.contacts):
        return {"none": machine}
    return {"declared": machine, "none": replace(machine, stands=(), contacts=())}


def _space_of(cell: Cell, moment: Moment, noise: bool, seed: int) -> FreeSpace:
    """The free space of a moment, from its images."""
    terms = cell.terms
    return reconstruct(
        cell.grid,
        cell.cameras,
        render(cell.cameras, moment, noise=noise, seed=seed),
        cell.machine,
        moment.joints,
        rule=terms.rule,
        detail=terms.detail,
        margin=terms.margin if noise else Margin(lateral_px=0.0),
        looks=False,
    )


def _earlier(one: Contact, other: Contact) -> Contact:
    """The contact that comes first; none of neither."""
    return min((one, other), key=lambda contact: (not contact.touches, contact.travel))


def cell_summary(rows: Sequence[Mapping[str, Any]]) -> list[dict[str, Any]]:
    """Rows of kind "summary": shoulder and elbow, the wrist, and all of them; by kind of pose, and of all poses.

    Of a machine that has no joints of these names there are rows for all joints alone.

    Args:
        rows: of `cell_rows`.
    """
    found = []
    for contact in dict.fromkeys(row["contact"] for row in rows):
        same = [row for row in rows if row["contact"] == contact]
        groups = {
            "shoulder and elbow": _of_joints(same, SHOULDER_AND_ELBOW),
            "wrist": _of_joints(same, SHOULDER_AND_ELBOW, False),
        }
        if not groups["shoulder and elbow"]:
            groups = {}
        groups["all"] = same
        kinds = list(dict.fromkeys(row["kind_of_pose"] for row in rows))
        for joints, of in groups.items():
            for kind in ["all", *(kinds if len(kinds) > 1 else ())]:
                some = [row for row in of if kind in ("all", row["kind_of_pose"])]
                found.append(_summed(some, joints, kind) | {"contact": contact})
    return found


def _of_joints(
    rows: Sequence[Mapping[str, Any]], names: Sequence[str], among: bool = True
) -> list[Mapping[str, Any]]:
    return [row for row in rows if (row["joint"] in names) is among]


def _summed(rows: Sequence[Mapping[str, Any]], joints: str, kind: str) -> dict[str, Any]:
    """One row: how many motions are truly clear, how many of these stop, and what stops them.

    `milder_level` counts levels milder than the truth where the link meets something of the room, `milder_own` where it
    meets another link.
    """
    ranks = {level.name.lower(): level.rank for level in Level}
    clear = [row for row in rows if row["truly_clear"]]
    milder = [row for row in rows if ranks[row["level"]] > ranks[row["true_level"]]]
    stopped = [row for row in clear if row["level"] == "stop"]
    return {
        **settings_of(rows),
        **({} if not rows else only(rows[0], ("cell", "noise"))),
        "joints": joints,
        "kind_of_pose": kind,
        "poses": len({row["pose"] for row in rows}),
        "motions": len(rows),
        "milder_level": sum(not row["true_own"] for row in milder),
        "milder_own": sum(row["true_own"] for row in milder),
        "more_travel": sum(row["milder"] for row in rows),
        "same_level_pct": _share(sum(row["level"] == row["true_level"] for row in rows), len(rows)),
        "truly_clear": len(clear),
        "stop_where_clear": len(stopped),
        "stop_where_clear_pct": _share(len(stopped), len(clear)),
        **{f"stopped_by_{c.name.lower()}": _count(stopped, "cause", c.name.lower()) for c in STOPPING},
    }


def _count(rows: Sequence[Mapping[str, Any]], key: str, value: str) -> int:
    return sum(row[key] == value for row in rows)


def _share(part: int, whole: int) -> float | None:
    """[%]; None of nothing."""
    return 100 * part / whole if whole else None
