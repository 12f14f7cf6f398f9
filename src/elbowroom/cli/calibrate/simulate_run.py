"""The run of `elbowroom calibrate simulate`."""

import time
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

import numpy as np
from rich.console import Console
from rich.progress import track

from elbowroom.calibrate import Board
from elbowroom.calibrate.simulated import (
    BoardCapture,
    Start,
    record_board,
    record_machine,
    record_room,
    started,
)
from elbowroom.calibrate.simulated.room_capture import knocked
from elbowroom.calibrate.simulated.start import TrueCamera
from elbowroom.cli.options import parse_resolution
from elbowroom.errors import InputError
from elbowroom.files.json_rows import json_rows
from elbowroom.sensing import NOISE_PRESETS
from elbowroom.simulate import wall_cameras

USUAL_POSES = {"board": 40, "machine": 12, "room": 30}
USUAL_BOARD = {"vga": ((8, 5), 0.1), "qqvga": ((6, 5), 0.12), "thesis": ((5, 4), 0.18)}
"""Inner corners and edge of a square [m] by size of image."""
USUAL_STANDS = {"vga": 0, "qqvga": 0, "thesis": 10}
"""By size of image. Three would fix the world, but so few pixels tell little of each pose: by the stated covariance the
worst of 21 cameras is known to 10 mm (one sigma) with three, to 7 to 9 with ten."""
NEAR_POSES = 20
"""Of a board before each camera."""
PLATE_M = 0.003
"""Thickness of the plate [m]."""


@dataclass(frozen=True, slots=True)
class Wanted:
    """What the command line says; see its help."""

    kind: Literal["board", "machine", "room"]
    out: Path
    cameras: int
    size: str
    poses: int | None
    noise: str
    board: Literal["cut_out", "printed"]
    corners: str | None
    square_m: float | None
    border_m: float
    stands: int | None
    start: Start
    near: bool
    hand_m: float
    moved_pose: int | None
    knock: str | None
    knock_deg: float
    knock_m: float
    seed: int


def simulate_capture(wanted: Wanted, json: Path | None) -> None:
    """Renders a capture and writes it.

    Raises:
        InputError: a noise that is none, a board that does not fit, a folder that cannot be written to.
    """
    begun = time.perf_counter()
    cameras = _cameras(wanted)
    if wanted.near and wanted.kind != "board":
        raise InputError(f"--near with {wanted.kind}: near poses are those of a board; leave it out")
    poses = wanted.poses or (NEAR_POSES * len(cameras) if wanted.near else USUAL_POSES[wanted.kind])
    console = Console(stderr=True)
    images: list[int] = []

    with json_rows(json) as add:
        bar = iter(track(range(poses), "rendering", console=console, disable=not console.is_terminal))

        def on_pose(done: int, views: int) -> None:
            images.append(views)
            next(bar, None)
            if not console.is_terminal and (done % 10 == 0 or done == poses):
                console.print(f"rendering: {done} of {poses}, {sum(images)} images", highlight=False)

        site = _record(wanted, cameras, poses, on_pose)
        next(bar, None)
        seconds = time.perf_counter() - begun
        add(
            {
                "kind": "calibrate simulate",
                "capture": wanted.kind,
                "cameras": len(cameras),
                "poses": poses,
                "images": sum(images),
                "seconds": seconds,
                "site": str(site),
            }
        )
    on = {"machine": "calibrate machine", "room": "calibrate refine"}.get(wanted.kind, "calibrate extrinsics")
    on = "calibrate intrinsics" if wanted.near else on
    Console(highlight=False).print(
        f"{sum(images)} images of {len(cameras)} cameras in {seconds:.0f} s; "
        f"now: elbowroom {on} {site} --out calibrated.yaml",
        soft_wrap=True,
    )


def _record(wanted: Wanted, cameras: tuple[TrueCamera, ...], poses: int, on_pose) -> Path:  # type: ignore[no-untyped-def]
    if wanted.kind == "machine":
        return record_machine(cameras, poses, wanted.noise, wanted.seed, wanted.out, on_pose)
    if wanted.kind == "room":
        return record_room(cameras, poses, wanted.noise, wanted.seed, wanted.out, on_pose)
    usual_stands = 0 if wanted.near else min(USUAL_STANDS[wanted.size], poses)
    capture = BoardCapture(
        cameras,
        _board(wanted),
        poses,
        usual_stands if wanted.stands is None else wanted.stands,
        wanted.noise,
        wanted.seed,
        hand_moved_m=wanted.hand_m,
        hand_turned_deg=np.degrees(wanted.hand_m),
        moved_pose=wanted.moved_pose,
        near=wanted.near,
    )
    return record_board(capture, wanted.out, on_pose)


def _board(wanted: Wanted) -> Board:
    (columns, rows), square_m = USUAL_BOARD[wanted.size]
    if wanted.corners is not None:
        columns, rows = parse_resolution(wanted.corners)
    return Board(
        columns,
        rows,
        wanted.square_m or square_m,
        wanted.board,
        wanted.border_m,
        marked=wanted.board == "cut_out",
        thickness_m=PLATE_M,
    )


def _cameras(wanted: Wanted) -> tuple[TrueCamera, ...]:
    if wanted.noise != "exact" and wanted.noise not in NOISE_PRESETS:
        raise InputError(f"--noise: {wanted.noise!r} is unknown; exact, {', '.join(NOISE_PRESETS)}")
    model = None if wanted.noise == "exact" else NOISE_PRESETS[wanted.noise]
    hung = wall_cameras(wanted.cameras, size=wanted.size, noise=model)
    random = np.random.default_rng([wanted.seed, 5])
    cameras = started(hung, wanted.start, random)
    if wanted.knock is not None:
        cameras = knocked(cameras, wanted.knock, wanted.knock_deg, wanted.knock_m, random)
    return cameras
