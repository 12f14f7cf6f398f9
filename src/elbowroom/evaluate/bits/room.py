"""The simulated room as it is looked at for check sums: a moment, its cameras and what they deliver."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

from elbowroom.evaluate.bits.sums import Row, Scene, row, scene_rows
from elbowroom.geometry import DepthCamera, VoxelGrid
from elbowroom.machine import Machine
from elbowroom.motion import JointPath, Motion
from elbowroom.sensing import NOISE_PRESETS, DepthFrame, Margin
from elbowroom.simulate import Moment, render, true_occupancy, wall_cameras
from elbowroom.site import Site

HALF_SIDE_M, UPPER_M = 2.0, 2.5
"""Of the watched box: half its sides in x and y, and its upper end above the floor [m]."""
HEIGHTS_M = (2.4, 2.0)
"""Of the cameras along the walls, in turn [m]."""
LOW_M = (2.4, 0.4)
"""The same where nothing stands before them [m]."""
NARROW = Margin(lateral_px=0.0)
"""Of cameras that are where they are said to be."""
WIDE = Margin()
"""Of cameras that may be half a pixel off."""
BARREL = (-0.12, 0.02, 0.001, -0.0008, -0.001)
"""A lens' distortion, by OpenCV's five numbers."""
AMONG_PEOPLE = {"long": 0.065, "larm": -0.21, "propeller": 0.17, "carc": 0.0}
TURNED = {"long": -0.15, "larm": 0.6, "propeller": -0.3, "carc": 0.3}
AT_THE_EDGE = {"long": 0.55, "larm": 1.4, "propeller": 0.0, "carc": 0.0}
"""Poses of the C-arm [m, rad]."""
PATH = JointPath(({"long": 0.05, "larm": 0.1}, {"propeller": 0.1, "carc": -0.1}), 0.1)
"""A path of all joints, asked besides the motions of each."""
COARSE_M = 0.05


@dataclass(frozen=True, slots=True)
class Shot:
    """How the simulated room is looked at.

    Args:
        time_s: of its course [s].
        joints: of the C-arm [m or rad]; None: where its course has brought it.
        voxel_size_m: edge of a voxel [m].
        size: of the images, by name.
        noise: of the sensors, by name; None: exact.
        margin: of the cameras.
        camera: what else is different in each camera.
        flying_pixels, missing: shares of mixed pixels at steps in depth and of pixels without return.
        silent: so many cameras, the first ones, deliver nothing.
        alone: nothing is in the room but the machine, and cameras look under it, too.
        half_side_m: of the watched box, in x and y [m].
        quick: whether a short run takes it.
    """

    time_s: float
    joints: Mapping[str, float] | None = None
    voxel_size_m: float = COARSE_M
    size: str = "qqvga"
    noise: str | None = None
    margin: Margin = NARROW
    camera: Mapping[str, Any] = field(default_factory=dict)
    flying_pixels: float = 0.3
    missing: float = 0.0005
    silent: int = 0
    alone: bool = False
    half_side_m: float = HALF_SIDE_M
    quick: bool = False


def simulated_rows(moment: Moment, machine: Machine, shot: Shot) -> Iterator[Row]:
    """All rows of a simulated moment: its truth, then those of its images.

    Args:
        moment: what is there.
        machine: of the moment.
        shot: how it is looked at; its time and joints are the moment's.
    """
    grid = room_grid(shot.voxel_size_m, shot.half_side_m)
    if shot.voxel_size_m >= COARSE_M:
        truth = true_occupancy(grid, moment)
        yield row("truth", [("occupied", truth.occupied), ("machine", truth.machine)])
    cameras, frames = images_of(moment, shot)
    asked: tuple[Motion | JointPath, ...] = (*motions_of(machine), PATH)
    yield from scene_rows(Scene(grid, cameras, frames, shot.margin, machine, moment.joints, asked))


def room_grid(voxel_size_m: float, half_side_m: float = HALF_SIDE_M) -> VoxelGrid:
    """The watched box, about the room's middle."""
    return VoxelGrid.covering(
        (-half_side_m, -half_side_m, 0.0), (half_side_m, half_side_m, UPPER_M), voxel_size_m
    )


def motions_of(machine: Machine) -> tuple[Motion, ...]:
    """Of every joint in both directions, as the simulated room's site file has them."""
    return tuple(Site.simulated_room().motions(machine))


def images_of(moment: Moment, shot: Shot) -> tuple[Sequence[DepthCamera], list[DepthFrame]]:
    """Cameras along the walls, and what they deliver."""
    noise = None if shot.noise is None else NOISE_PRESETS[shot.noise]
    cameras = [
        _changed(c, shot.camera)
        for c in wall_cameras(21, LOW_M if shot.alone else HEIGHTS_M, size=shot.size, noise=noise)
    ]
    heard = cameras[shot.silent :]
    return cameras, render(heard, moment, flying_pixels=shot.flying_pixels, missing=shot.missing)


def _changed(camera: DepthCamera, changes: Mapping[str, Any]) -> DepthCamera:
    rest = dict(changes)
    distortion = rest.pop("distortion", None)
    if distortion is not None:
        rest["intrinsics"] = replace(camera.intrinsics, distortion=distortion)
    return replace(camera, **rest)
