"""The thesis' scale model (5.2), simulated: a laboratory with the C-arm, table and doctor at 1:5, and four Kinects."""

from dataclasses import replace
from functools import cache

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import distance_transform_edt

from elbowroom.evaluate.rooms.exact import Contact, ExactTravel
from elbowroom.evaluate.rooms.scene import room_motions
from elbowroom.evaluate.thesis.cases import as_png
from elbowroom.evaluate.thesis.thesis import c_arm
from elbowroom.geometry import DepthCamera, Intrinsics, VoxelGrid, looking_at
from elbowroom.machine import Machine
from elbowroom.motion import Motion
from elbowroom.reconstruct import FreeSpace
from elbowroom.sensing import NOISE_PRESETS
from elbowroom.simulate import Moment, Solid, setup
from elbowroom.simulate.machine_solids import random_joints
from elbowroom.simulate.shapes import box, join
from elbowroom.simulate.solid import Mesh
from elbowroom.simulate.truth import touched_by
from elbowroom.view.draw.colour import View, cubes

FACTOR = 0.2
OBJECTS = ("table", "mattress", "table controls", "doctor")
LABORATORY = ("floor", "walls", "ceiling")
"""Solids that are not of the model."""
VOXEL_M = 0.002
"""Edge of a voxel in what is due: 1 cm at full size [m]."""
VOXEL_SIZES_M = (VOXEL_M, 0.004)
"""All that are measured [m]."""
PICTURE_VOXEL_M = 0.004
"""Edge of a voxel in the picture, which shows the whole grid [m]."""
POSES = 24
CLEAR_M = 0.008
"""Between the machine and everything else at the start [m of the model]."""
AIM_M = (0.0, 0.0, 0.22)
"""What the Kinects look at: the middle of the C."""
PLACES_M = ((-0.346, 0.742, 0.45), (-0.841, 0.0, 0.1), (0.142, -0.806, 0.45), (0.763, -0.356, 0.1))
"""Where they stand: `elbowroom evaluate scale-cameras` found it, for the ways of the motions judged [m]."""
BLUE, GREEN, RED = (0.05, 0.15, 0.75), (0.05, 0.5, 0.12), (0.75, 0.04, 0.04)
GREY = (0.75, 0.75, 0.72)


def model_grid(voxel_size_m: float) -> VoxelGrid:
    """The watched box of the model: the room of the thesis at 1:5, up to the machine's rail."""
    return VoxelGrid.covering((-0.4, -0.4, 0.0), (0.4, 0.4, 0.5), voxel_size_m)


def body_growth(voxel_size_m: float) -> float:
    """By how much the body is grown where it is taken out [m]: half a voxel of 4 mm, and more with smaller ones.

    So it takes the same space whatever the voxels (within 1 %, from 2 to 4 mm), and what it frees beside itself
    reaches no farther than with voxels of 4 mm: growth and a voxel's diagonal are at most 9 mm.
    """
    return max(voxel_size_m / 2, 0.002 + (0.004 - voxel_size_m) * 2 / 3)


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


@cache
def kinects(noise: bool) -> tuple[DepthCamera, ...]:
    """Four of Kinect v1, at `PLACES_M`."""
    return tuple(kinect(f"kinect{number}", place, noise) for number, place in enumerate(PLACES_M))


def kinect(name: str, place_m: tuple[float, float, float], noise: bool) -> DepthCamera:
    """A Kinect v1 that looks at the middle of the C.

    Args:
        name: its name.
        place_m: where it stands [m].
        noise: whether it has any.
    """
    focal_px = 320 / np.tan(np.radians(57.0) / 2)
    return DepthCamera(
        name=name,
        width=640,
        height=480,
        world_from_camera=looking_at(place_m, AIM_M),
        intrinsics=Intrinsics(fx=focal_px, fy=focal_px, cx=319.5, cy=239.5),
        noise=NOISE_PRESETS["kinect_v1"] if noise else None,
        min_depth_m=0.5,
        max_depth_m=4.0,
    )


def model_motions(machine: Machine) -> list[Motion]:
    """Every joint in both directions with the usual reach; braking distances at 1:5 where they are lengths."""
    small = {joint.name: FACTOR if joint.kind == "prismatic" else 1.0 for joint in machine.joints}
    return [
        Motion(motion.joint, motion.direction, motion.braking_distance * small[motion.joint])
        for motion in room_motions(c_arm())
    ]


def model_pose(pose: int) -> tuple[dict[str, float], dict[Motion, Contact]]:
    """The first random pose of a seed that is clear of everything, and from which a motion truly ends at an object.

    Args:
        pose: its number, which is the seed.

    Returns:
        Joint positions by name, and the motions that end at an object with where they do.
    """
    machine = model_machine()
    truth, rng = ExactTravel(machine, model_solids()), np.random.default_rng([pose, 15])
    while True:
        joints = random_joints(machine, rng)
        if truth.gap(joints, CLEAR_M) < CLEAR_M:
            continue
        contacts = {motion: truth.until_contact(joints, motion) for motion in model_motions(machine)}
        met = {motion: contact for motion, contact in contacts.items() if contact.touches}
        if met:
            return joints, met


def coloured_picture(space: FreeSpace, moment: Moment) -> bytes:
    """Surfaces as the thesis' Fig. 10 shows them: C-arm blue, table green, the doctor red. PNG."""
    grid = space.grid
    owner = np.zeros(grid.shape, dtype=np.uint8)
    for solid in moment.solids:
        number = 1 if solid.is_machine else 3 if solid.name.startswith("doctor") else 2
        if solid.name in LABORATORY:
            continue
        corner, touched = touched_by(grid, solid)
        part = owner[tuple(slice(c, c + n) for c, n in zip(corner, touched.shape, strict=True))]
        part[touched] = number
    away, nearest = distance_transform_edt(owner == 0, return_indices=True)
    shown = (space.surface & (away <= 4)) | (owner == 1)
    labels = np.where(shown, owner[tuple(nearest)], 0)
    view = View((0.75, -0.80, 0.80), (0.0, 0.0, 0.22), 46, 640, 480)
    return as_png(cubes(labels, grid, np.array([GREY, BLUE, GREEN, RED]), view))
