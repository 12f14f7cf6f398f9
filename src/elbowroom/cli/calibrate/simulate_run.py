"""The run of `elbowroom calibrate simulate`."""

import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

import numpy as np
from rich.console import Console
from rich.progress import Progress

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
from elbowroom.cli.noise import noise_named
from elbowroom.cli.options import parse_resolution
from elbowroom.cli.simulate_options import Size
from elbowroom.errors import InputError
from elbowroom.files.json_rows import json_rows
from elbowroom.simulate import wall_cameras

OnPose = Callable[[int, int], None]
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
class BoardOptions:
    """The board, and on how many stands it is; see the help of the command."""

    kind: Literal["cut_out", "printed"]
    corners: str | None
    square_m: float | None
    border_m: float
    stands: int | None


@dataclass(frozen=True, slots=True)
class MotionOptions:
    """Where the board is held, and how still."""

    near: bool
    hand_m: float
    moved_pose: int | None


@dataclass(frozen=True, slots=True)
class KnockOptions:
    """The camera that was knocked after the site was written, and by how much."""

    camera: str
    turned_deg: float
    moved_m: float


@dataclass(frozen=True, slots=True)
class CaptureOptions:
    """What the command line says; see its help."""

    kind: Literal["board", "machine", "room"]
    out: Path
    cameras: int
    size: Size
    poses: int | None
    noise: str
    seed: int
    start: Start
    board: BoardOptions
    motion: MotionOptions
    knock: KnockOptions | None

    @property
    def next_command(self) -> str:
        """What the capture is for."""
        if self.motion.near:
            return "calibrate intrinsics"
        return {"machine": "calibrate machine", "room": "calibrate refine"}.get(
            self.kind, "calibrate extrinsics"
        )


def simulate_capture(options: CaptureOptions, json: Path | None) -> None:
    """Renders a capture and writes it.

    Raises:
        InputError: a noise that is none, a board that does not fit, a folder that cannot be written to.
    """
    begun = time.perf_counter()
    cameras = _cameras(options)
    near = options.motion.near
    if near and options.kind != "board":
        raise InputError(f"--near with {options.kind}: near poses are those of a board; leave it out")
    poses = options.poses or (NEAR_POSES * len(cameras) if near else USUAL_POSES[options.kind])
    with json_rows(json) as add, _Rendering(poses) as rendering:
        site = _record(options, cameras, poses, rendering.on_pose)
        seconds = time.perf_counter() - begun
        add(
            {
                "kind": "calibrate simulate",
                "capture": options.kind,
                "cameras": len(cameras),
                "poses": poses,
                "images": rendering.images,
                "seconds": seconds,
                "site": str(site),
            }
        )
    print(
        f"{rendering.images} images of {len(cameras)} cameras in {seconds:.0f} s; "
        f"now: elbowroom {options.next_command} {site} --out calibrated.yaml"
    )


class _Rendering:
    """Says how many poses are rendered: a bar on a terminal, a line for every tenth elsewhere. Use it as a context."""

    def __init__(self, poses: int) -> None:
        self.poses, self.images = poses, 0
        self._console = Console(stderr=True)
        self._bar = Progress(console=self._console, disable=not self._console.is_terminal)
        self._task = self._bar.add_task("rendering", total=poses)

    def __enter__(self) -> "_Rendering":
        self._bar.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._bar.stop()

    def on_pose(self, done: int, views: int) -> None:
        self.images += views
        self._bar.update(self._task, completed=done)
        if not self._console.is_terminal and (done % 10 == 0 or done == self.poses):
            self._console.print(f"rendering: {done} of {self.poses}, {self.images} images", highlight=False)


def _record(options: CaptureOptions, cameras: tuple[TrueCamera, ...], poses: int, on_pose: OnPose) -> Path:
    if options.kind == "machine":
        return record_machine(cameras, poses, options.noise, options.seed, options.out, on_pose)
    if options.kind == "room":
        return record_room(cameras, poses, options.noise, options.seed, options.out, on_pose)
    motion, stands = options.motion, options.board.stands
    if stands is None:
        stands = 0 if motion.near else min(USUAL_STANDS[options.size], poses)
    capture = BoardCapture(
        cameras=cameras,
        board=_board(options.board, options.size),
        poses=poses,
        stands=stands,
        noise=options.noise,
        seed=options.seed,
        hand_moved_m=motion.hand_m,
        hand_turned_deg=np.degrees(motion.hand_m),
        moved_pose=motion.moved_pose,
        near=motion.near,
    )
    return record_board(capture, options.out, on_pose)


def _board(options: BoardOptions, size: str) -> Board:
    (columns, rows), square_m = USUAL_BOARD[size]
    if options.corners is not None:
        columns, rows = parse_resolution(options.corners)
    return Board(
        columns,
        rows,
        options.square_m or square_m,
        options.kind,
        options.border_m,
        marked=options.kind == "cut_out",
        thickness_m=PLATE_M,
    )


def _cameras(options: CaptureOptions) -> tuple[TrueCamera, ...]:
    hung = wall_cameras(options.cameras, size=options.size, noise=noise_named(options.noise))
    random = np.random.default_rng([options.seed, 5])
    cameras = started(hung, options.start, random)
    knock = options.knock
    if knock is None:
        return cameras
    return knocked(cameras, knock.camera, knock.turned_deg, knock.moved_m, random)
