"""Random motions in the six setups: those whose truth lies within L, and false stops among all the others."""

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np

from elbowroom.evaluate.due import Due, due_of, figure_of, where
from elbowroom.evaluate.rooms.exact import Contact, ExactTravel
from elbowroom.evaluate.rooms.scene import Comparison
from elbowroom.evaluate.shares.task import Outcome, Row, Settings, Task
from elbowroom.evaluate.thesis.bands import counted
from elbowroom.evaluate.thesis.due import DueLine, first
from elbowroom.evaluate.thesis.judged import (
    LATERAL_PX,
    SAID,
    Variant,
    cameras_of,
    is_small,
    judged,
    motions_of,
    seen_space,
)
from elbowroom.evaluate.thesis.thesis import c_arm
from elbowroom.motion import Motion, check_motions
from elbowroom.simulate import Moment, render, setup
from elbowroom.simulate.machine_solids import random_joints
from elbowroom.view.report.blocks import Block, Table, cm, pct

CHUNK = 21
"""Random motions of one share of the work."""
CLEAR_M = 0.02
"""Random poses keep this distance of everything [m]."""
CAREFUL = 2
"""One of so many rounds of the setups is judged with an allowance for lateral error as well."""
EDGE_M = 0.02
"""Of a voxel, unless the settings say otherwise."""
_OF = where(kind="summary", of="random")
DUE = (
    Due("motions", "≥", 500, _OF),
    Due("more_than_truth", "≤", 0, _OF),
    DueLine("u", "≤", 0, _OF, name="random motions: unsafe, of {motions}", pick=first),
    DueLine("unsafe_of_small_objects", "≤", 0, _OF, name="and of small objects", pick=first),
    DueLine(
        "median_shortfall_voxels", "≤", 2, _OF, name="random motions: median shortfall [voxels]", pick=first
    ),
)


def random_tasks(settings: Settings) -> list[Task]:
    """One for every 21 random motions, the setups in turn."""
    chunks = -(-settings.random_motions // CHUNK)
    return [
        Task(
            "motions",
            f"random{n:02d}",
            judge_random,
            {
                "number": settings.setups[n % len(settings.setups)],
                "seed": n,
                "count": min(CHUNK, settings.random_motions - n * CHUNK),
                "cameras": settings.cameras,
                "voxel_size_m": min(settings.voxel_sizes_m or (EDGE_M,)),
                "careful": n // len(settings.setups) % CAREFUL == 0,
            },
        )
        for n in range(chunks)
    ]


def judge_random(
    number: int, seed: int, count: int, cameras: int, voxel_size_m: float, careful: bool
) -> Outcome:
    """Random poses in one setup until so many motions of theirs have a truth within L.

    Each pose is judged without an allowance for lateral error; with `careful` from the same images with it, too.
    Rows of kind "random" are the motions within L; all other motions of the poses are counted by joint.

    Args:
        number: of the setup.
        seed: of the poses.
        count: of motions within L.
        cameras: how many.
        voxel_size_m: edge of a voxel [m].
        careful: whether they are judged with an allowance for lateral error as well.
    """
    scene, machine = setup(number), c_arm()
    truth = ExactTravel(machine, scene.solids())
    allowances = (0.0, LATERAL_PX) if careful else (0.0,)
    variants = [Variant("640x480", voxel_size_m, "pixel", lateral_px=px) for px in allowances]
    rng = np.random.default_rng([number, seed])
    rows: list[dict[str, Any]] = []
    left, pose = count, 0
    while left:
        joints = random_joints(machine, rng)
        if truth.gap(joints, CLEAR_M) < CLEAR_M:
            continue
        contacts = {m: truth.until_contact(joints, m) for m in motions_of(machine).values()}
        within = [motion for motion, contact in contacts.items() if contact.touches][:left]
        if not within:
            continue
        left, pose = left - len(within), pose + 1
        said = {"setup": number, "motion": f"{seed}-{pose}"}
        for motion, row in _compared(scene.at(machine, joints), contacts, variants, cameras):
            rows.append({"kind": "random" if motion in within else "other", **said, **row})
    drawn, others = ([row for row in rows if row["kind"] == kind] for kind in ("random", "other"))
    return Outcome(drawn + _by_joint(drawn, others))


def _compared(
    moment: Moment, contacts: Mapping[Motion, Contact], variants: Sequence[Variant], cameras: int
) -> Iterator[tuple[Motion, dict[str, Any]]]:
    """All motions from one pose by each variant, and their rows."""
    machine, motions = c_arm(), list(contacts)
    views = cameras_of("640x480", False, cameras)
    frames = render(views, moment, noise=False)
    for variant in variants:
        space = seen_space(machine, moment, motions, views, frames, variant)
        for motion, verdict in zip(
            motions, check_motions(space, machine, moment.joints, motions), strict=True
        ):
            found = Comparison(motion, verdict, contacts[motion])
            yield motion, {**variant.said(cameras), **judged(found, variant.voxel_size_m)}


def _by_joint(rows: Sequence[Row], others: Sequence[Row]) -> list[dict[str, Any]]:
    """Of all motions of the poses, by variant and joint: how many stop, and are clear, where the truth is not."""
    every = [*rows, *others]
    counts = []
    for lateral_px, joint in dict.fromkeys((row["lateral_px"], row["joint"]) for row in every):
        mine = [row for row in every if (row["lateral_px"], row["joint"]) == (lateral_px, joint)]
        safe = [row for row in mine if row["truth_band"] != "S"]
        clear = [row for row in mine if row["truth_band"] == "0"]
        counts.append(
            {
                "kind": "joint",
                "lateral_px": lateral_px,
                "joint": joint,
                "motions": len(mine),
                "not_within_s": len(safe),
                "false_stops": sum(row["band"] == "S" for row in safe),
                "clear": len(clear),
                "found_clear": sum(row["band"] == "0" for row in clear),
                "more_than_truth": sum(row["more_than_truth"] for row in mine),
            }
        )
    return counts


def random_summary(rows: Sequence[Row]) -> list[dict[str, Any]]:
    """Verdicts and shortfall by the allowance for lateral error; false stops by joint without it."""
    drawn = [row for row in rows if row["kind"] == "random"]
    counts = [row for row in rows if row["kind"] == "joint"]
    result: list[dict[str, Any]] = []
    for lateral_px in dict.fromkeys(row["lateral_px"] for row in drawn):
        mine = [row for row in drawn if row["lateral_px"] == lateral_px]
        small = [row for row in mine if is_small(row)]
        short = [row["shortfall_voxels"] for row in mine]
        result.append(
            {
                "kind": "summary",
                "of": "random",
                **{key: mine[0][key] for key in SAID},
                "motions": len(mine),
                **counted([row["verdict"] for row in mine]),
                "small_objects": len(small),
                "unsafe_of_small_objects": sum(row["verdict"] == "u" for row in small),
                "all_motions": sum(row["motions"] for row in counts if row["lateral_px"] == lateral_px),
                "more_than_truth": sum(
                    row["more_than_truth"] for row in counts if row["lateral_px"] == lateral_px
                ),
                "median_shortfall_voxels": float(np.median(short)),
                "p90_shortfall_voxels": float(np.percentile(short, 90)),
                "greatest_shortfall_voxels": max(short),
            }
        )
    for joint in dict.fromkeys(row["joint"] for row in counts):
        mine = [row for row in counts if row["joint"] == joint and row["lateral_px"] == 0.0]
        total = {
            key: sum(row[key] for row in mine)
            for key in ("not_within_s", "false_stops", "clear", "found_clear")
        }
        result.append({"kind": "summary", "of": "false stops", "joint": joint, **total})
    return result


def random_blocks(rows: Sequence[Row]) -> list[Block]:
    """Verdicts and shortfall; false stops by joint."""
    summaries = [row for row in rows if row["kind"] == "summary"]
    blocks: list[Block] = []
    found = [row for row in summaries if row["of"] == "random"]
    if found:
        blocks.append(_shortfall_table(found))
    stops = [row for row in summaries if row["of"] == "false stops"]
    if stops:
        blocks.append(_stops_table(stops))
    return blocks


FIGURES = (
    ("motions", "motions whose truth is within L", "{motions}"),
    ("u", "unsafe", "{u}"),
    (
        "unsafe_of_small_objects",
        "unsafe, of those that touch what is under 0.10 m",
        "{unsafe_of_small_objects} of {small_objects}",
    ),
    (
        "more_than_truth",
        "more free travel than the truth, of all motions",
        "{more_than_truth} of {all_motions}",
    ),
    ("s", "same band", "{s}"),
    ("ts", "too safe by one band or two", "{ts}"),
    ("tts", "too safe by three", "{tts}"),
    (
        "median_shortfall_voxels",
        "median shortfall [voxels of the moving point]",
        "{median_shortfall_voxels:.2f}",
    ),
    ("p90_shortfall_voxels", "90 % shortfall", "{p90_shortfall_voxels:.2f}"),
    ("greatest_shortfall_voxels", "greatest shortfall", "{greatest_shortfall_voxels:.1f}"),
)
"""What the table shows: key, words, and how the value is written."""


def _shortfall_table(found: Sequence[Row]) -> Table:
    first = found[0]
    lines = []
    for key, words, form in FIGURES:
        due = "" if due_of(DUE, key) is None else f"{figure_of(DUE, key):g}"
        lines.append((words, *(form.format(**row) for row in found), due))
    return Table(
        f"Random motions, {first['sensor']}, {cm(first['voxel_size_m'])}, {first['detail']}, "
        "by how much pixels are widened",
        ("", *(f"+-{row['lateral_px']:g} px" for row in found), "due"),
        lines,
    )


def _stops_table(stops: Sequence[Row]) -> Table:
    lines = [
        (
            row["joint"],
            str(row["not_within_s"]),
            str(row["false_stops"]),
            _share(row["false_stops"], row["not_within_s"]),
            _share(row["found_clear"], row["clear"]),
        )
        for row in stops
    ]
    return Table(
        "False stops in random poses, by joint: of motions whose truth is not within S",
        ("joint", "motions", "false stops", "[%]", "0 where the truth is 0 [%]"),
        lines,
    )


def _share(part: int, whole: int) -> str:
    return pct(100 * part / whole if whole else None, 1)
