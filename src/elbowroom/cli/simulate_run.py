"""The run of `elbowroom simulate`: a GLB in, a recording out."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from rich.console import Console

from elbowroom.cli.progress import Steps
from elbowroom.errors import InputError
from elbowroom.files.atomic import folder
from elbowroom.files.json_rows import json_rows
from elbowroom.geometry import DepthCamera, VoxelGrid
from elbowroom.machine import Machine
from elbowroom.machine.c_arm import ceiling_c_arm
from elbowroom.sensing import NOISE_PRESETS, DepthFrame
from elbowroom.simulate import Moment, Walls, render, setup, solids_of_glb, wall_cameras
from elbowroom.simulate.inside import check_outside
from elbowroom.simulate.machine_solids import link_solids
from elbowroom.sources.recorder import Recording, write_recording
from elbowroom.view.draw.colour import View, colour_picture
from elbowroom.view.draw.depth import depth_picture

INSIDE_WALLS_M = 0.01
"""Cameras hang so far inside the box [m]."""


@dataclass(frozen=True, slots=True)
class Wanted:
    """What the command line says; see its help."""

    room: str
    out: Path
    cameras: int
    size: str
    heights_m: tuple[float, ...]
    noise: str
    box: str
    voxel_size_m: float
    machine: bool
    joints: Mapping[str, float] | None


def simulate_room(wanted: Wanted, json: Path | None) -> None:
    """Renders a room and writes the recording.

    Raises:
        InputError: a room that cannot be used, a box or a noise that is none, a folder that cannot be written to.
        MachineError: joints that the C-arm does not have.
    """
    grid = _box(wanted.box, wanted.voxel_size_m)
    folder(wanted.out)
    with json_rows(json) as add, Steps(Console(stderr=True), 4) as steps:
        steps.begin("reading the room")
        machine = ceiling_c_arm() if wanted.machine else None
        moment = _moment(wanted, machine, grid)
        cameras = _cameras(wanted, grid)
        check_outside(cameras, moment.solids)
        steps.begin("rendering")
        frames = render(cameras, moment)
        steps.begin("writing images")
        what = Recording(
            Path(wanted.room).stem, grid, dict(moment.joints) if machine is not None else None, wanted.noise
        )
        site = write_recording(wanted.out, what, cameras, frames)
        steps.begin("drawing")
        _draw(wanted.out, grid, moment, frames[0])
        add(_row(wanted, moment, frames, site))
    Console(highlight=False).print(
        f"{len(frames)} images of {len(moment.solids)} solids; now: elbowroom reconstruct {site} --out result",
        soft_wrap=True,
    )


def _moment(wanted: Wanted, machine: Machine | None, grid: VoxelGrid) -> Moment:
    if wanted.room in {f"setup{n}" for n in range(1, 7)}:
        shipped = setup(wanted.room)
        solids, usual = shipped.solids(), dict(shipped.joints)
    else:
        solids = solids_of_glb(wanted.room)
        usual = dict.fromkeys(machine.joint_names, 0.0) if machine is not None else {}
    inside = [s for s in solids if _meets(s.vertices_in_world, grid)]
    if not inside:
        raise InputError(f"{wanted.room}: no object reaches into the box {wanted.box}; give another --box")
    if machine is None:
        if wanted.joints:
            raise InputError("--joints: without a machine there are none; leave out --joints or --no-machine")
        return Moment(1.0, solids, {})
    joints = {**usual, **(wanted.joints or {})}
    machine.checked(joints)
    return Moment(1.0, solids + link_solids(machine, joints), joints)


def _meets(vertices: np.ndarray, grid: VoxelGrid) -> bool:
    return bool(((vertices.max(axis=0) > grid.lower_m) & (vertices.min(axis=0) < grid.upper_m)).all())


def _cameras(wanted: Wanted, grid: VoxelGrid) -> tuple[DepthCamera, ...]:
    if wanted.noise != "exact" and wanted.noise not in NOISE_PRESETS:
        raise InputError(
            f"--noise: {wanted.noise!r} is unknown, allowed are exact, {', '.join(NOISE_PRESETS)}"
        )
    middle, half = (grid.lower_m + grid.upper_m) / 2, (grid.upper_m - grid.lower_m) / 2 - INSIDE_WALLS_M
    if min(half[:2]) <= 0:
        raise InputError(f"--box: {wanted.box} is too small for cameras in it")
    return wall_cameras(
        wanted.cameras,
        wanted.heights_m,
        size=wanted.size,
        walls=Walls(
            half_side_m=(float(half[0]), float(half[1])),
            centre_m=(float(middle[0]), float(middle[1])),
            aim_m=float(grid.lower_m[2] + 0.44 * (grid.upper_m - grid.lower_m)[2]),
        ),
        noise=None if wanted.noise == "exact" else NOISE_PRESETS[wanted.noise],
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


def _row(wanted: Wanted, moment: Moment, frames: list[DepthFrame], site: Path) -> dict[str, Any]:
    return {
        "kind": "simulate",
        "room": wanted.room,
        "objects": len([s for s in moment.solids if not s.is_machine]),
        "triangles": sum(len(s.mesh.faces) for s in moment.solids),
        "cameras": len(frames),
        "noise": wanted.noise,
        "joints": moment.joints,
        "without_return_pct": 100 * float(np.mean([np.mean(frame.depth_m <= 0) for frame in frames])),
        "site": str(site),
    }
