"""Captures without a board: the machine in many poses, or the still room; and a camera that was knocked."""

import csv
from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from elbowroom.calibrate.simulated.board_capture import GRID
from elbowroom.calibrate.simulated.start import TrueCamera, moved
from elbowroom.calibrate.simulated.writer import CaptureWriter
from elbowroom.errors import CalibrationError
from elbowroom.files.atomic import whole_file
from elbowroom.geometry.parallel import spread
from elbowroom.simulate import InterventionRoom, Moment, render

PERIOD_S = 2.0
FRAME_S = 1 / 30


def record_machine(
    cameras: Sequence[TrueCamera],
    poses: int,
    noise: str,
    seed: int,
    out: Path,
    on_pose: Callable[[int, int], None] = lambda done, views: None,
) -> Path:
    """The ceiling C-arm stands still in one pose after the other; all cameras look, joints are recorded.

    Args:
        cameras: true and said.
        poses: how many.
        noise: name of the sensors' noise.
        seed: of all random numbers.
        out: folder.
        on_pose: is told how many poses are done, and how many images the last one gave.

    Returns:
        The site file.
    """
    room, random = InterventionRoom(people=False), np.random.default_rng([seed, 23])
    moments = []
    for number in range(poses):
        drawn = room.random_moment(random)
        moments.append(room.at(PERIOD_S * (number + 1), joints=drawn.joints))
    return _record(cameras, moments, noise, seed, out, on_pose)


def record_room(
    cameras: Sequence[TrueCamera],
    moments: int,
    noise: str,
    seed: int,
    out: Path,
    on_pose: Callable[[int, int], None] = lambda done, views: None,
) -> Path:
    """The room with its furniture and its machine at rest, at 30 Hz; arguments as of `record_machine`.

    Args:
        cameras: true and said.
        moments: how many.
        noise: name of the sensors' noise, for the site file.
        seed: of all random numbers.
        out: folder.
        on_pose: is told how many moments are done, and how many images the last one gave.
    """
    room = InterventionRoom(people=False)
    rest = dict.fromkeys(room.machine.joint_names, 0.0)
    shown = [room.at(1.0 + FRAME_S * number, joints=rest) for number in range(moments)]
    return _record(cameras, shown, noise, seed, out, on_pose)


def knocked(
    cameras: Sequence[TrueCamera], name: str, turned_deg: float, moved_m: float, random: np.random.Generator
) -> tuple[TrueCamera, ...]:
    """The cameras, of which one was knocked after the site file was written: its true pose differs by so much.

    Args:
        cameras: true and said.
        name: of the one that is knocked.
        turned_deg, moved_m: by how much [deg], [m].
        random: for the directions.

    Raises:
        CalibrationError: no camera of this name.
    """
    if name not in {camera.true.name for camera in cameras}:
        known = ", ".join(camera.true.name for camera in cameras)
        raise CalibrationError(f"knocked camera {name!r}: unknown; cameras are {known}")
    return tuple(
        replace(
            camera,
            true=replace(
                camera.true,
                world_from_camera=camera.true.world_from_camera @ moved(turned_deg, moved_m, random),
            ),
        )
        if camera.true.name == name
        else camera
        for camera in cameras
    )


def _record(
    cameras: Sequence[TrueCamera],
    moments: Sequence[Moment],
    noise: str,
    seed: int,
    out: Path,
    on_pose: Callable[[int, int], None],
) -> Path:
    writer = CaptureWriter(out, cameras)
    for number, moment in enumerate(moments):

        def one(camera: TrueCamera, moment: Moment = moment) -> None:
            frame = render([camera.true], moment, seed=seed)[0]
            writer.depth(camera, moment.stamp_ns, frame.depth_m)

        spread(one, cameras)
        on_pose(number + 1, len(cameras))
    with whole_file(out / "images" / "joints.csv") as unfinished, unfinished.open("w", newline="") as file:
        rows = csv.writer(file)
        rows.writerow(["stamp_ns", *moments[0].joints])
        for moment in moments:
            rows.writerow([moment.stamp_ns, *(repr(float(value)) for value in moment.joints.values())])
    writer.truth({"poses": [{"stamp_ns": m.stamp_ns, "joints": dict(m.joints)} for m in moments]})
    more = {
        "machine": {"builtin": "ceiling_c_arm"},
        "recording": {
            "layout": "folder",
            "folder": "images",
            "max_joint_gap_ms": 2000 * PERIOD_S,
        },
        "calibration": {"world": {"by": "machine"}},
    }
    return writer.site(noise, more, GRID)
