"""The run of `elbowroom simulate`: a GLB in, a recording out."""

import sys
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from rich.console import Console

from elbowroom.cli.noise import noise_named
from elbowroom.cli.progress import Steps
from elbowroom.cli.simulate_options import Size
from elbowroom.errors import InputError
from elbowroom.files.atomic import folder
from elbowroom.files.json_rows import json_rows
from elbowroom.files.mesh.objects import Axis
from elbowroom.geometry import DepthCamera, VoxelGrid
from elbowroom.machine import Machine
from elbowroom.machine.c_arm import ceiling_c_arm
from elbowroom.sensing import DepthFrame
from elbowroom.simulate import Moment, Solid, Walls, render, setup, wall_cameras
from elbowroom.simulate.glb import solids_of
from elbowroom.simulate.inside import check_outside
from elbowroom.simulate.machine_solids import link_solids
from elbowroom.simulate.room_mesh import read_room_mesh
from elbowroom.sources.recorder import Recording, write_recording
from elbowroom.view.draw.colour import View, colour_picture
from elbowroom.view.draw.depth import depth_picture

INSIDE_WALLS_M = 0.01
"""Cameras hang so far inside the box [m]."""


@dataclass(frozen=True, slots=True)
class RoomOptions:
    """What the command line says; see its help."""

    room: str
    up: Axis | None
    unit_m: float | None
    out: Path
    cameras: int
    size: Size
    heights_m: tuple[float, ...]
    noise: str
    box: str
    voxel_size_m: float
    machine: bool
    joints: Mapping[str, float] | None


def simulate_room(options: RoomOptions, json: Path | None) -> None:
    """Renders a room and writes the recording.

    Raises:
        InputError: a room that cannot be used, a box or a noise that is none, a folder that cannot be written to.
        MachineError: joints that the C-arm does not have.
    """
    grid = _box(options.box, options.voxel_size_m)
    folder(options.out)
    with json_rows(json) as add, Steps(Console(stderr=True), 4) as steps:
        steps.begin("reading the room")
        machine = ceiling_c_arm() if options.machine else None
        moment = _moment(options, machine, grid)
        cameras = _cameras(options, grid)
        _check_outside(cameras, moment)
        steps.begin("rendering")
        frames = render(cameras, moment)
        steps.begin("writing images")
        what = Recording(
            Path(options.room).stem, grid, dict(moment.joints) if machine is not None else None, options.noise
        )
        site = write_recording(options.out, what, cameras, frames)
        steps.begin("drawing")
        _draw(options.out, grid, moment, frames[0])
        add(_row(options, moment, frames, site))
    print(
        f"{len(frames)} images of {len(moment.solids)} solids; now: elbowroom reconstruct {site} --out result"
    )


def _check_outside(cameras: tuple[DepthCamera, ...], moment: Moment) -> None:
    try:
        check_outside(cameras, moment.solids)
    except InputError as error:
        raise InputError(f"{error} (--height, --cameras, --box)") from None


def _moment(options: RoomOptions, machine: Machine | None, grid: VoxelGrid) -> Moment:
    if options.room in {f"setup{n}" for n in range(1, 7)}:
        shipped = setup(options.room)
        solids, usual = shipped.solids(), dict(shipped.joints)
    else:
        solids = _modelled(options, grid)
        usual = dict.fromkeys(machine.joint_names, 0.0) if machine is not None else {}
    inside = [s for s in solids if _meets(s.vertices_in_world, grid)]
    if not inside:
        raise InputError(f"{options.room}: no object reaches into the box {options.box}; give another --box")
    if machine is None:
        if options.joints:
            raise InputError("--joints: without a machine there are none; leave out --joints or --no-machine")
        return Moment(1.0, solids, {})
    joints = {**usual, **(options.joints or {})}
    machine.checked(joints)
    return Moment(1.0, solids + link_solids(machine, joints), joints)


def _modelled(options: RoomOptions, grid: VoxelGrid) -> tuple[Solid, ...]:
    box_m = np.array([grid.lower_m, grid.upper_m])
    room = read_room_mesh(options.room, up=options.up, unit_m=options.unit_m, box_m=box_m)
    for note in room.notes:
        print(f"note: {note}", file=sys.stderr)
    return solids_of(Path(options.room), room)


def _meets(vertices: np.ndarray, grid: VoxelGrid) -> bool:
    return bool(((vertices.max(axis=0) > grid.lower_m) & (vertices.min(axis=0) < grid.upper_m)).all())


def _cameras(options: RoomOptions, grid: VoxelGrid) -> tuple[DepthCamera, ...]:
    noise = noise_named(options.noise)
    middle, half = (grid.lower_m + grid.upper_m) / 2, (grid.upper_m - grid.lower_m) / 2 - INSIDE_WALLS_M
    if min(half[:2]) <= 0:
        raise InputError(f"--box: {options.box} is too small for cameras in it")
    return wall_cameras(
        options.cameras,
        options.heights_m,
        size=options.size,
        walls=Walls(
            half_side_m=(float(half[0]), float(half[1])),
            centre_m=(float(middle[0]), float(middle[1])),
            aim_m=float(grid.lower_m[2] + 0.44 * (grid.upper_m - grid.lower_m)[2]),
        ),
        noise=noise,
    )


def _box(text: str, voxel_size_m: float) -> VoxelGrid:
    try:
        numbers = [float(word) for word in text.split(",")]
    except ValueError:
        numbers = []
    if len(numbers) != 6:
        raise InputError(f"--box: {text!r} is no box; write six numbers, such as -2,-2,0,2,2,2.5")
    return VoxelGrid.covering(numbers[:3], numbers[3:], voxel_size_m)


def _draw(out: Path, grid: VoxelGrid, moment: Moment, frame: DepthFrame) -> None:
    """The room without what hangs above it or stands between it and the eye, and the first camera's image."""
    shown = [s for s in moment.solids if s.is_machine or _is_inside(s.vertices_in_world, grid)]
    shown = shown or list(moment.solids)  # all of it stands in the way
    middle, size = (grid.lower_m + grid.upper_m) / 2, float(np.linalg.norm(grid.upper_m - grid.lower_m))
    eye = middle + np.array([0.66, -0.70, 0.50]) * size
    view = View(
        (float(eye[0]), float(eye[1]), float(eye[2])),
        (float(middle[0]), float(middle[1]), float(middle[2])),
        46,
    )
    colour_picture(shown, view).save(out / "colour.png", optimize=True)
    depth_picture(frame.depth_m).save(out / "depth.png", optimize=True)


def _is_inside(vertices: np.ndarray, grid: VoxelGrid) -> bool:
    """Not a wall or ceiling on the eye's side: its middle lies over the box, or behind it."""
    middle = (vertices.min(axis=0) + vertices.max(axis=0)) / 2
    return bool(
        middle[0] < grid.upper_m[0] and middle[1] > grid.lower_m[1] and middle[2] < grid.upper_m[2] + 0.3
    )


def _row(options: RoomOptions, moment: Moment, frames: list[DepthFrame], site: Path) -> dict[str, Any]:
    return {
        "kind": "simulate",
        "room": options.room,
        "objects": len([s for s in moment.solids if not s.is_machine]),
        "triangles": sum(len(s.mesh.faces) for s in moment.solids),
        "cameras": len(frames),
        "noise": options.noise,
        "joints": moment.joints,
        "without_return_pct": 100 * float(np.mean([np.mean(frame.depth_m <= 0) for frame in frames])),
        "site": str(site),
    }
