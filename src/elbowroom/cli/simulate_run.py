"""The run of `elbowroom simulate`: a modelled room in, a recording out."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from rich.console import Console

from elbowroom.cli.interrupt import asked_to_end
from elbowroom.cli.noise import noise_named
from elbowroom.cli.options import options_named
from elbowroom.cli.progress import Steps
from elbowroom.cli.simulate_mesh import RoomFile
from elbowroom.cli.simulate_options import Size
from elbowroom.cli.simulate_site import SiteRoom, site_room
from elbowroom.errors import InputError
from elbowroom.files.atomic import folder
from elbowroom.files.json_rows import json_rows
from elbowroom.geometry import DepthCamera, VoxelGrid
from elbowroom.machine.c_arm import ceiling_c_arm
from elbowroom.sensing import DepthFrame
from elbowroom.simulate import Moment, Walls, render, setup, true_occupancy, wall_cameras
from elbowroom.simulate.crowd import Floor
from elbowroom.simulate.floor import floor_height
from elbowroom.simulate.inside import check_outside, hung_clear
from elbowroom.simulate.scene import Course, InUse, Surroundings, scene_in
from elbowroom.simulate.solid import Solid
from elbowroom.sources.recorder import UNIT_M, Recording, write_site_of
from elbowroom.sources.recording_folder import RecordingFolder, Units, refuse_foreign
from elbowroom.view.draw.colour import View, colour_picture
from elbowroom.view.draw.depth import depth_picture

INSIDE_WALLS_M = 0.01
"""Cameras hang so far inside the box [m]."""
WALL_START_S = 1.0
"""The time of the first moment of a room without a site [s]."""
SITE_START_S = 100.0
"""With a site: from here on stamps have the same number of digits for a quarter of an hour [s]."""


@dataclass(frozen=True, slots=True)
class Asked:
    """What the command line says of any room; see its help."""

    room: RoomFile | None
    out: Path | None
    moments: int
    rate_hz: float
    people: int
    still: bool
    joints: Mapping[str, float] | None
    noise: str | None
    seed: int
    truth: bool

    def course(self, start_s: float, speeds: Mapping[str, float]) -> Course:
        """What is asked of a scene that begins at a time [s], with full speeds of joints [m/s or rad/s]."""
        times = tuple(start_s + number / self.rate_hz for number in range(self.moments))
        moves = not self.still and self.moments > 1
        return Course(times, self.joints, moves, speeds, self.people, self.seed)


@dataclass(frozen=True, slots=True)
class WallOptions:
    """What it says of cameras along the walls of a box."""

    cameras: int
    size: Size
    heights_m: tuple[float, ...]
    box: str
    voxel_size_m: float
    machine: bool


@dataclass(frozen=True, slots=True, eq=False)
class Shot:
    """What is rendered: a room in use, by which cameras, when, and where the images go.

    Args:
        scene: what is in the room at each time.
        cameras: that look at it.
        times_s: of the moments [s].
        box: the watched box.
        images: the folder of images.
        units: by camera, how depth is counted on disk.
    """

    scene: InUse
    cameras: tuple[DepthCamera, ...]
    times_s: tuple[float, ...]
    box: VoxelGrid
    images: Path
    units: Mapping[str, Units]


def simulate_walls(asked: Asked, options: WallOptions, json: Path | None) -> None:
    """Renders a room with cameras along its walls, and writes the recording.

    Args:
        asked: what is asked of any room; with a room and a folder.
        options: the cameras along its walls.
        json: where the row goes; None: nowhere.

    Raises:
        InputError: a room that cannot be used, a box or a noise that is none, a folder that cannot be written to.
        MachineError: joints that the C-arm does not have.
    """
    assert asked.room is not None and asked.out is not None
    noise = asked.noise or "exact"
    box = _box(options.box, options.voxel_size_m)
    solids = asked.room.solids(box)
    cameras = _wall_cameras(options, box, noise, solids)
    out = folder(asked.out)
    refuse_foreign(out / "images")
    with json_rows(json) as add, Steps(Console(stderr=True), asked.moments + 3) as steps:
        steps.begin("reading the room")
        around, joints = _walled(asked, options, box, cameras, solids)
        if joints is None and asked.joints:
            raise InputError("--joints: without a machine there are none; leave out --joints or --no-machine")
        machine = None if joints is None else ceiling_c_arm()
        course = asked.course(WALL_START_S, {})
        course = Course(course.times_s, joints, course.moves, course.speeds, course.people, course.seed)
        with options_named(people="--moving"):
            scene = scene_in(around, machine, course)
        units = {camera.name: Units(UNIT_M) for camera in cameras}
        shot = Shot(scene, cameras, tuple(course.times_s), box, out / "images", units)
        _check_outside(shot, " (--height, --cameras, --box)")
        moments, row = _shoot(shot, asked, steps)
        what = Recording(Path(asked.room.name).stem, box, scene.at(course.times_s[0]).joints or None, noise)
        site = write_site_of(out, what, cameras)
        add(
            {
                **row,
                "room": asked.room and asked.room.name,
                "noise": noise,
                "site": str(site),
                "notes": list(scene.notes),
            }
        )
    for words in scene.notes:
        print(f"note: {words}")
    print(
        f"{row['images']} images of {row['solids']} solids{_of(moments, asked)}; "
        f"now: elbowroom reconstruct {site} --out result"
    )


def simulate_site(path: Path, asked: Asked, json: Path | None) -> None:
    """Renders what a site's own cameras see of its room and its machine, and writes the recording.

    Args:
        path: of the site file.
        asked: what is asked of any room.
        json: where the row goes; None: nowhere.

    Raises:
        SiteError: a site that cannot be used.
        InputError: no room, a folder that cannot be written to, no pose of the machine, no way for the people.
        MachineError: joints that the machine does not have.
    """
    with json_rows(json) as add, Steps(Console(stderr=True), asked.moments + 3) as steps:
        steps.begin("reading the room")
        course = asked.course(SITE_START_S, {})
        with options_named(joints="--joints", people="--moving", room="--room", out="--out", noise="--noise"):
            room = site_room(path, asked.room, asked.out, asked.noise)
            refuse_foreign(room.images)
            if room.machine is not None:
                room.machine.require_joints(asked.joints or {})
            scene, notes = room.scene(course)
        shot = Shot(scene, room.cameras, tuple(course.times_s), room.box, room.images, room.units)
        _check_outside(shot, "")
        moments, row = _shoot(shot, asked, steps)
        site = room.write(asked.out)
        add(
            {
                **row,
                "room": asked.room and asked.room.name,
                "noise": asked.noise,
                "site": str(site),
                "notes": list(notes),
            }
        )
    for words in notes:
        print(f"note: {words}")
    print(f"{row['images']} images of {len(room.cameras)} cameras{_of(moments, asked)} in {room.images}")
    _say_next(room, site)


def _say_next(room: SiteRoom, site: Path) -> None:
    if site != room.site.path:
        print(f"{site} reads them; or write into {room.site.path}:")
        print(f"recording: {{layout: folder, folder: {room.folder_beside_site}}}")
    print(f"now: elbowroom site check {site} --out room.png; elbowroom monitor {site}")


def _of(moments: int, asked: Asked) -> str:
    if moments < asked.moments:
        return f", {moments} moments of the {asked.moments} that were asked for"
    return f", {moments} moments" if moments > 1 else ""


def _shoot(shot: Shot, asked: Asked, steps: Steps) -> tuple[int, dict[str, Any]]:
    """Renders and writes one moment after the other; how many there are, and the row of results."""
    first: tuple[Moment, list[DepthFrame]] | None = None
    missing = []
    with RecordingFolder(shot.images, shot.units) as recording, asked_to_end() as is_over:
        for number, time_s in enumerate(shot.times_s):
            if steps.console.is_terminal:
                steps.begin(f"moment {number + 1} of {len(shot.times_s)}")
            else:
                steps.begin_once("rendering")
            moment = shot.scene.at(time_s)
            frames = render(shot.cameras, moment, seed=asked.seed + number)
            recording.add(frames, moment.joints or None)
            missing.append(float(np.mean([np.mean(frame.depth_m <= 0) for frame in frames])))
            first = first or (moment, frames)
            if is_over():
                break
    if first is None or not recording.moments:
        raise KeyboardInterrupt
    moment, frames = first
    if asked.out is not None:
        steps.begin("drawing")
        _draw(folder(asked.out), shot.box, moment, frames[0])
        if asked.truth:
            steps.begin("writing the truth")
            _write_truth(asked.out / "truth", shot, recording.moments)
    return recording.moments, _row(moment, recording.moments, missing, len(shot.cameras))


def _write_truth(place: Path, shot: Shot, moments: int) -> None:
    """`<stamp_ns>.npz` of each moment: which voxels of the watched box are touched, by the machine apart."""
    folder(place)
    for old in place.glob("*.npz"):
        old.unlink()
    for time_s in shot.times_s[:moments]:
        moment = shot.scene.at(time_s)
        truth = true_occupancy(shot.box, moment)
        np.savez_compressed(
            place / f"{moment.stamp_ns}.npz",
            occupied=truth.occupied,
            machine=truth.machine,
            origin_m=shot.box.lower_m,
            voxel_size_m=shot.box.voxel_size_m,
        )


def _check_outside(shot: Shot, options: str) -> None:
    try:
        check_outside(shot.cameras, shot.scene.at(shot.times_s[0]).solids)
    except InputError as error:
        raise InputError(f"{error}{options}") from None


def _walled(
    asked: Asked,
    options: WallOptions,
    box: VoxelGrid,
    cameras: tuple[DepthCamera, ...],
    solids: tuple[Solid, ...],
) -> tuple[Surroundings, dict[str, float] | None]:
    """The room without a site, and where the C-arm is; None: it is not there."""
    assert asked.room is not None
    if asked.room.is_shipped:
        usual = dict(setup(asked.room.name).joints)
    else:
        usual = dict.fromkeys(ceiling_c_arm().joint_names, 0.0)
    if not any(_meets(s.vertices_in_world, box) for s in solids):
        raise InputError(
            f"{asked.room.name}: no object reaches into the box {options.box}; give another --box"
        )
    floor = Floor(box.lower_m[:2], box.upper_m[:2], floor_height(box, solids) if asked.people else 0.0)
    joints = {**usual, **(asked.joints or {})} if options.machine else None
    if joints is not None:
        ceiling_c_arm().require_joints(joints)
    eyes = np.array([camera.centre_in_world for camera in cameras])
    return Surroundings(box, solids, (), floor, eyes), joints


def _meets(vertices: np.ndarray, grid: VoxelGrid) -> bool:
    return bool(((vertices.max(axis=0) > grid.lower_m) & (vertices.min(axis=0) < grid.upper_m)).all())


def _wall_cameras(
    options: WallOptions, grid: VoxelGrid, noise: str, solids: Sequence[Solid]
) -> tuple[DepthCamera, ...]:
    """Along the walls; one that would hang inside a solid hangs beside it."""
    middle, half = (grid.lower_m + grid.upper_m) / 2, (grid.upper_m - grid.lower_m) / 2 - INSIDE_WALLS_M
    if min(half[:2]) <= 0:
        raise InputError(f"--box: {options.box} is too small for cameras in it")
    walls = Walls(
        half_side_m=(float(half[0]), float(half[1])),
        centre_m=(float(middle[0]), float(middle[1])),
        aim_m=float(grid.lower_m[2] + 0.44 * (grid.upper_m - grid.lower_m)[2]),
    )
    hung = wall_cameras(
        options.cameras, options.heights_m, size=options.size, walls=walls, noise=noise_named(noise)
    )
    return hung_clear(hung, solids, walls)


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


def _row(moment: Moment, moments: int, missing: list[float], cameras: int) -> dict[str, Any]:
    return {
        "kind": "simulate",
        "objects": len([s for s in moment.solids if not s.is_machine]),
        "solids": len(moment.solids),
        "triangles": sum(len(s.mesh.faces) for s in moment.solids),
        "cameras": cameras,
        "moments": moments,
        "images": moments * cameras,
        "joints": moment.joints,
        "without_return_pct": 100 * float(np.mean(missing)),
    }
