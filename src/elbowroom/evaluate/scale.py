"""The scale model (thesis 5.2, 6.2): a room at 1:5 with C-arm, table, doctor and four Kinects; free travel and truth.

Ours is simulated, the thesis' was a physical model: same scale, same kind of sensor (noise of a Kinect v1, nothing
nearer than 0.5 m), but exact meshes for truth where the thesis used a ruler. Travels are looked at to the joint's end;
shortfalls are those of the point that touches, in millimetres of the model; a voxel of 4 mm stands for 2 cm.
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import distance_transform_edt

from elbowroom.evaluate.cases import as_png
from elbowroom.evaluate.exact import ExactTravel, load_coal
from elbowroom.evaluate.part import Part
from elbowroom.evaluate.scene import SAME, room_motions
from elbowroom.evaluate.task import Outcome, Row, Settings, Task
from elbowroom.evaluate.thesis import c_arm
from elbowroom.geometry import DepthCamera, VoxelGrid
from elbowroom.machine import Machine
from elbowroom.motion import Motion, check_motions
from elbowroom.reconstruct import FreeSpace, reconstruct
from elbowroom.sensing import NOISE_PRESETS
from elbowroom.simulate import Moment, Solid, render, setup, true_occupancy, wall_cameras
from elbowroom.simulate.machine_solids import link_solids, random_joints
from elbowroom.simulate.picture import View, cubes
from elbowroom.simulate.shapes import box, join
from elbowroom.simulate.solid import Mesh
from elbowroom.simulate.truth import touched_by
from elbowroom.view.blocks import Block, Picture, Table, Words

FACTOR = 0.2
VOXEL_M = 0.004
POSES = 8
CLEAR_M = 0.008
"""Between the machine and everything else at the start [m of the model]."""
NEAR_VOXELS = 3
"""What ends a travel is an object's own if it lies within so many voxels of it; otherwise it is a shadow."""
OBJECTS = ("table", "mattress", "table controls", "doctor")
BLUE, GREEN, RED = (0.05, 0.15, 0.75), (0.05, 0.5, 0.12), (0.75, 0.04, 0.04)
GREY = (0.75, 0.75, 0.72)


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
    """All joints and directions from one pose, without noise and with it."""
    machine, solids = model_machine(), model_solids()
    truth = ExactTravel(machine, solids)
    rng = np.random.default_rng([pose, 15])
    joints = dict.fromkeys(machine.joint_names, 0.0)
    while pose > 0 and (not any(joints.values()) or truth.gap(joints, CLEAR_M) < CLEAR_M):
        joints = random_joints(machine, rng)
    moment = Moment(1.0, solids + link_solids(machine, joints), joints)
    grid = VoxelGrid.covering((-0.4, -0.4, 0.0), (0.4, 0.4, 0.5), voxel_size_m)
    motions = whole_motions(machine)
    objects = true_occupancy(grid, moment).occupied
    rows: list[dict[str, Any]] = []
    drawn: dict[str, bytes] = {}
    for noise in (False, True):
        views = kinects(noise)
        space = reconstruct(grid, views, render(views, moment, seed=pose), machine=machine, joints=joints)
        for motion, verdict in zip(motions, check_motions(space, machine, joints, motions), strict=True):
            contact = truth.until_contact(joints, motion)
            at_object = verdict.place_in_world is not None and _is_near(verdict.place_in_world, objects, grid)
            short_m = (contact.travel - verdict.free_travel) * contact.speed
            rows.append(
                {
                    "kind": "travel",
                    "setup": "scale model",
                    "motion": f"{motion.joint} {'-+'[motion.direction > 0]}",
                    "pose": pose,
                    "joints": joints,
                    "sensor": "kinect_v1",
                    "noise": noise,
                    "voxel_size_m": voxel_size_m,
                    "rule": "three",
                    "detail": "pixel",
                    "free_travel": verdict.free_travel,
                    "free_travel_unit": verdict.free_travel_unit,
                    "truth_travel": contact.travel,
                    "cause": verdict.cause.name.lower(),
                    "true_solid": contact.solid,
                    "ended_at_object": at_object,
                    "short_mm": 1000 * short_m if contact.touches else None,
                    "more_than_truth": verdict.free_travel > contact.travel + SAME,
                }
            )
        if picture and noise:
            drawn["scale-model"] = coloured_picture(space, moment)
    return Outcome(rows, drawn)


def _is_near(place: tuple[float, float, float], objects: NDArray[np.bool_], grid: VoxelGrid) -> bool:
    """Whether a place lies within `NEAR_VOXELS` of a voxel that an object touches."""
    index = grid.index_of(place)
    low, high = np.maximum(index - NEAR_VOXELS, 0), index + NEAR_VOXELS + 1
    return bool(objects[low[0] : high[0], low[1] : high[1], low[2] : high[2]].any())


@cache
def model_machine() -> Machine:
    """The C-arm at 1:5; always the same object, so that what is worked out for it is kept."""
    return scaled(c_arm(), FACTOR)


def scaled(machine: Machine, factor: float) -> Machine:
    """The same machine, smaller: lengths times a factor, angles as they are."""

    def pose(matrix: NDArray[np.float64]) -> NDArray[np.float64]:
        smaller = np.array(matrix)
        smaller[..., :3, 3] *= factor
        return smaller

    joints = tuple(
        replace(
            joint,
            parent_from_joint=pose(joint.parent_from_joint),
            lower=joint.lower * (factor if joint.kind == "prismatic" else 1.0),
            upper=joint.upper * (factor if joint.kind == "prismatic" else 1.0),
        )
        for joint in machine.joints
    )
    return replace(
        machine,
        links=tuple(replace(link, vertices=link.vertices * factor) for link in machine.links),
        joints=joints,
        tree=machine.tree._replace(parent_from_joint=pose(machine.tree.parent_from_joint)),
        world_from_base=pose(machine.world_from_base),
    )


@cache
def model_solids() -> tuple[Solid, ...]:
    """Table and doctor of the first setup at 1:5, on the floor of a laboratory."""
    small = [
        replace(solid, mesh=Mesh(solid.mesh.vertices * FACTOR, solid.mesh.faces))
        for solid in setup(1).solids()
        if solid.name.startswith(OBJECTS)
    ]
    a, b, c = 2.0, 2.2, 2.6
    parts = {
        "floor": [box((-b, -b, -0.2), (b, b, 0.0))],
        "walls": [
            box((-b, -b, 0), (-a, b, c)),
            box((a, -b, 0), (b, b, c)),
            box((-a, -b, 0), (a, -a, c)),
            box((-a, a, 0), (a, b, c)),
        ],
        "ceiling": [box((-b, -b, c), (b, b, c + 0.2))],
    }
    lab = [Solid(name, join(shapes), np.eye(4), is_static=True) for name, shapes in parts.items()]
    return (*small, *lab)


def kinects(noise: bool) -> tuple[DepthCamera, ...]:
    """Four, on the four sides, two high and two low, a metre from the model: their near limit keeps them there."""
    return wall_cameras(
        4,
        (0.85, 0.3),
        hfov_deg=57.0,
        half_side_m=0.9,
        aim_m=0.22,
        noise=NOISE_PRESETS["kinect_v1"] if noise else None,
        min_depth_m=0.5,
        max_depth_m=4.0,
    )


def whole_motions(machine: Machine) -> list[Motion]:
    """Every joint in both directions, to the end of its range; braking distances at 1:5 where they are lengths."""
    whole = []
    for motion in room_motions(c_arm()):
        joint = machine.joint(motion.joint)
        factor = FACTOR if joint.kind == "prismatic" else 1.0
        whole.append(
            Motion(
                motion.joint, motion.direction, motion.braking_distance * factor, joint.upper - joint.lower
            )
        )
    return whole


def coloured_picture(space: FreeSpace, moment: Moment) -> bytes:
    """Surfaces as the thesis' Fig. 10 shows them: C-arm blue, table green, the doctor red. PNG."""
    grid = space.grid
    owner = np.zeros(grid.shape, dtype=np.uint8)
    for solid in moment.solids:
        number = 1 if solid.is_machine else 3 if solid.name.startswith("doctor") else 2
        if solid.name in ("floor", "walls", "ceiling"):
            continue
        corner, touched = touched_by(grid, solid)
        part = owner[tuple(slice(c, c + n) for c, n in zip(corner, touched.shape, strict=True))]
        part[touched] = number
    away, nearest = distance_transform_edt(owner == 0, return_indices=True)
    shown = (space.surface & (away <= 4)) | (owner == 1)
    labels = np.where(shown, owner[tuple(nearest)], 0)
    view = View((0.75, -0.80, 0.80), (0.0, 0.0, 0.22), 46, 640, 480)
    return as_png(cubes(labels, grid, np.array([GREY, BLUE, GREEN, RED]), view))


def summary(rows: Sequence[Row]) -> list[dict[str, Any]]:
    """With noise and without: travel beyond the truth, shortfall at contacts in millimetres of the model."""
    result = []
    for noise in dict.fromkeys(row["noise"] for row in rows):
        mine = [row for row in rows if row["noise"] == noise]
        short = [row["short_mm"] for row in mine if row["short_mm"] is not None]
        met = [row["short_mm"] for row in mine if row["short_mm"] is not None and row["ended_at_object"]]
        result.append(
            {
                "kind": "summary",
                "noise": noise,
                "voxel_size_m": mine[0]["voxel_size_m"],
                "motions": len(mine),
                "touching": len(short),
                "more_than_truth": sum(row["more_than_truth"] for row in mine),
                "median_short_mm": float(np.median(short)) if short else None,
                "worst_short_mm": max(short, default=None),
                "ended_at_object": len(met),
                "median_short_at_object_mm": float(np.median(met)) if met else None,
                "worst_short_at_object_mm": max(met, default=None),
            }
        )
    return result


def show(rows: Sequence[Row], pictures: Mapping[str, bytes]) -> list[Block]:
    """The table, and the coloured reconstruction."""
    blocks: list[Block] = [Words(" ".join((__doc__ or "").split("\n\n", 1)[1].split()))]
    lines = [
        (
            "yes" if row["noise"] else "no",
            f"{row['voxel_size_m'] * 1000:g} mm",
            str(row["motions"]),
            str(row["more_than_truth"]),
            str(row["touching"]),
            f"{_mm(row['median_short_mm'])} / {_mm(row['worst_short_mm'])}",
            str(row["ended_at_object"]),
            f"{_mm(row['median_short_at_object_mm'])} / {_mm(row['worst_short_at_object_mm'])}",
        )
        for row in rows
        if row["kind"] == "summary"
    ]
    columns = (
        "noise",
        "voxel",
        "motions",
        "more than the truth",
        "that touch",
        "short by, median / worst [mm]",
        "ended at an object",
        "of these, median / worst [mm]",
    )
    blocks.append(
        Table("Free travel; thesis: within 5 mm; due: never more, 5 mm median, 12 mm worst", columns, lines)
    )
    for png in pictures.values():
        blocks.append(
            Picture(png, "Surfaces found by four Kinects: C-arm blue, table green, doctor red (Fig. 10)", 560)
        )
    return blocks


def _mm(value: float | None) -> str:
    return "-" if value is None else f"{value:.1f}"


PART = Part("scale", "Scale model", tasks, summary, show)
