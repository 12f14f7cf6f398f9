"""The scale model (thesis 5.2, 6.2): a room at 1:5 with C-arm, table, doctor and four Kinects; free travel and truth.

Ours is simulated, the thesis' was a physical model: same scale, same kind of sensor (noise of a Kinect v1, nothing
nearer than 0.5 m), but exact meshes for truth where the thesis used a ruler. Poses are drawn at random; every joint and
direction whose way truly ends at an object is looked at, to the joint's end. An object is *in view* if exact images
show a surface within two voxels of where it is touched; that is the truth's choice, not the verdict's. Shortfalls are
those of the point that touches, in millimetres of the model. *Free travel* stops at all that is not seen to be free.
Four Kinects leave unseen pockets beside the machine in nearly every pose, so beside it stands the *travel to what is
seen*: the same with unseen space passed over, as when an operator overrides it (thesis 6.1.1); what is measured, or
looked at without a valid return, still stops. Where the object is not in view it says nothing.
"""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from elbowroom.evaluate.exact import Contact, ExactTravel, load_coal
from elbowroom.evaluate.part import Part
from elbowroom.evaluate.scale_model import (
    FACTOR,
    coloured_picture,
    kinects,
    model_grid,
    model_machine,
    model_solids,
    whole_motions,
)
from elbowroom.evaluate.scene import DECIMALS, SAME, WELL_KNOWN
from elbowroom.evaluate.task import Outcome, Row, Settings, Task
from elbowroom.geometry import VoxelGrid, bits
from elbowroom.motion import Motion, Verdict, blocks_in_reach, check_motions
from elbowroom.reconstruct import FreeSpace, reconstruct
from elbowroom.simulate import Moment, render, true_occupancy
from elbowroom.simulate.machine_solids import link_solids, random_joints
from elbowroom.view.blocks import Block, Picture, Table, Words

VOXEL_M = 0.002
POSES = 12
CLEAR_M = 0.008
"""Between the machine and everything else at the start [m of the model]."""
NEAR_VOXELS = 2
"""An object is in view if a surface is seen within so many voxels of where it is touched."""


def tasks(settings: Settings) -> list[Task]:
    """One for each pose.

    Raises:
        ElbowroomError: coal is not installed.
    """
    load_coal()
    edge = settings.voxel_sizes_m[0] * FACTOR if settings.voxel_sizes_m else VOXEL_M
    return [
        Task("scale", f"pose{pose}", judge_pose, {"pose": pose, "voxel_size_m": edge, "picture": pose == 0})
        for pose in range(POSES)
    ]


def judge_pose(pose: int, voxel_size_m: float, picture: bool) -> Outcome:
    """The motions from one pose that truly end at an object, without noise and with it."""
    machine, solids = model_machine(), model_solids()
    truth, grid = ExactTravel(machine, solids), model_grid(voxel_size_m)
    rng = np.random.default_rng([pose, 15])
    joints = random_joints(machine, rng)
    while truth.gap(joints, CLEAR_M) < CLEAR_M:
        joints = random_joints(machine, rng)
    moment = Moment(1.0, solids + link_solids(machine, joints), joints)
    contacts = {motion: truth.until_contact(joints, motion) for motion in whole_motions(machine)}
    met = {motion: contact for motion, contact in contacts.items() if contact.touches}
    motions = list(met)
    # the picture wants all of the grid
    focus = None if picture else blocks_in_reach(grid, machine, joints, motions)
    rows: list[dict[str, Any]] = []
    drawn: dict[str, bytes] = {}
    in_view: list[bool] = []
    for noise in (False, True):
        views = kinects(noise)
        space = reconstruct(
            grid,
            views,
            render(views, moment, noise=noise, seed=pose),
            machine=machine,
            joints=joints,
            margin=WELL_KNOWN,
            focus=focus,
        )
        if not noise:
            in_view = _in_view(space, Moment(moment.time_s, solids, joints), motions)
        strict = check_motions(space, machine, joints, motions)
        passed = check_motions(without_unseen(space), machine, joints, motions)
        for motion, verdict, beyond, seen in zip(motions, strict, passed, in_view, strict=True):
            rows.append(
                {
                    "kind": "travel",
                    "setup": "scale model",
                    "motion": f"{motion.joint} {'-+'[motion.direction > 0]}",
                    "pose": pose,
                    "sensor": "kinect_v1",
                    "noise": noise,
                    "voxel_size_m": voxel_size_m,
                    "rule": "three",
                    "detail": "pixel",
                    "in_view": seen,
                    **_compared(met[motion], verdict, beyond),
                }
            )
        if picture and noise:
            drawn["scale-model"] = coloured_picture(space, moment)
    return Outcome(rows, drawn)


def _compared(contact: Contact, verdict: Verdict, passed: Verdict) -> dict[str, Any]:
    def short_mm(one: Verdict) -> float:
        return round(1000 * (contact.travel - one.free_travel) * contact.speed, 3)

    return {
        "free_travel": round(verdict.free_travel, DECIMALS),
        "free_travel_unit": verdict.free_travel_unit,
        "truth_travel": round(contact.travel, DECIMALS),
        "cause": verdict.cause.name.lower(),
        "true_solid": contact.solid,
        "short_mm": short_mm(verdict),
        "more_than_truth": verdict.free_travel > contact.travel + SAME,
        "seen_travel": round(passed.free_travel, DECIMALS),
        "seen_short_mm": short_mm(passed),
        "seen_more_than_truth": passed.free_travel > contact.travel + SAME,
    }


def _in_view(space: FreeSpace, moment: Moment, motions: Sequence[Motion]) -> list[bool]:
    """Of each motion, whether a surface is seen where it truly touches first, by the volume of true voxels.

    The moment is without the machine, which is taken out of the volume.
    """
    machine, grid = model_machine(), space.grid
    volume = FreeSpace.from_occupied(grid, true_occupancy(grid, moment).occupied)
    surface = space.surface
    ends = check_motions(volume.without(machine, moment.joints), machine, moment.joints, motions)
    return [end.place_in_world is not None and _is_near(end.place_in_world, surface, grid) for end in ends]


def _is_near(place: tuple[float, float, float], voxels: NDArray[np.bool_], grid: VoxelGrid) -> bool:
    """Whether a voxel of a volume lies within `NEAR_VOXELS` of a place."""
    index = grid.index_of(place)
    low, high = np.maximum(index - NEAR_VOXELS, 0), index + NEAR_VOXELS + 1
    return bool(voxels[low[0] : high[0], low[1] : high[1], low[2] : high[2]].any())


def without_unseen(space: FreeSpace) -> FreeSpace:
    """A space in which nothing stops that an operator may override: unseen, and nothing measured or disputed there."""
    stops = ~space.free_words & (space.surface_words | space.blind_words | space.disputed_words)
    return FreeSpace.from_occupied(space.grid, bits.unpack(stops & bits.inside(space.grid), space.grid))


def summary(rows: Sequence[Row]) -> list[dict[str, Any]]:
    """With noise and without: travel beyond the truth, shortfall in millimetres of the model."""
    result = []
    for noise in dict.fromkeys(row["noise"] for row in rows):
        mine = [row for row in rows if row["noise"] == noise]
        view = [row for row in mine if row["in_view"]]
        result.append(
            {
                "kind": "summary",
                "noise": noise,
                "voxel_size_m": mine[0]["voxel_size_m"],
                "motions": len(mine),
                "in_view": len(view),
                "more_than_truth": sum(row["more_than_truth"] for row in mine),
                "seen_more_than_truth": sum(row["seen_more_than_truth"] for row in view),
                **_median_and_worst("short_mm", "short_mm", mine),
                **_median_and_worst("in_view_short_mm", "short_mm", view),
                **_median_and_worst("seen_short_mm", "seen_short_mm", view),
            }
        )
    return result


def _median_and_worst(name: str, key: str, rows: Sequence[Row]) -> dict[str, float | None]:
    values = [row[key] for row in rows]
    return {
        f"median_{name}": float(np.median(values)) if values else None,
        f"worst_{name}": max(values, default=None),
    }


def show(rows: Sequence[Row], pictures: Mapping[str, bytes]) -> list[Block]:
    """The table, and the coloured reconstruction."""
    blocks: list[Block] = [Words(" ".join((__doc__ or "").split("\n\n", 1)[1].split()))]
    lines = [
        (
            "yes" if row["noise"] else "no",
            f"{row['voxel_size_m'] * 1000:g} mm",
            f"{row['motions']} / {row['in_view']}",
            str(row["more_than_truth"]),
            _pair(row, "short_mm"),
            _pair(row, "in_view_short_mm"),
            str(row["seen_more_than_truth"]),
            _pair(row, "seen_short_mm"),
        )
        for row in rows
        if row["kind"] == "summary"
    ]
    columns = (
        "noise",
        "voxel",
        "motions / in view",
        "free travel: more than the truth",
        "short by, median / worst [mm]",
        "of those in view [mm]",
        "to what is seen, in view: more than the truth",
        "short by [mm]",
    )
    blocks.append(
        Table("Travel; thesis: within 5 mm; due: never more, 5 mm median, 12 mm worst", columns, lines)
    )
    for png in pictures.values():
        blocks.append(
            Picture(png, "Surfaces found by four Kinects: C-arm blue, table green, doctor red (Fig. 10)", 560)
        )
    return blocks


def _pair(row: Row, name: str) -> str:
    """Median and worst."""
    pair = (row[f"median_{name}"], row[f"worst_{name}"])
    return " / ".join("-" if value is None else f"{value:.1f}" for value in pair)


PART = Part("scale", "Scale model", tasks, summary, show)
