"""How well `elbowroom calibrate extrinsics` finds cameras: simulated captures beside their truth, a real one, time."""

import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
import yaml
from numpy.typing import NDArray
from scipy.stats import chi2

from elbowroom.calibrate import Board, CalibratedCamera
from elbowroom.calibrate.boards.capture import sightings
from elbowroom.calibrate.extrinsics import BoardAnchor, Extrinsics, PointsAnchor, solve_extrinsics
from elbowroom.calibrate.extrinsics.site_anchor import anchor_of
from elbowroom.calibrate.refinement.agreement import agreement
from elbowroom.calibrate.result.change import pose_difference
from elbowroom.calibrate.result.margin import is_within, pose_margin
from elbowroom.calibrate.simulated import BoardCapture, Start, record_board, started
from elbowroom.errors import InputError
from elbowroom.evaluate.calibrating.board_images import board_image_rows
from elbowroom.evaluate.calibrating.board_views import (
    BOARD,
    ROUGH,
    board_poses,
    floor,
    measured_corners,
    ring,
    views_of,
)
from elbowroom.evaluate.examples import EXAMPLES, example
from elbowroom.evaluate.rooms.room import MOMENTS_S, ROOM_LOWER_M, ROOM_UPPER_M, Tally
from elbowroom.geometry import DepthCamera, VoxelGrid
from elbowroom.geometry.twist import between
from elbowroom.reconstruct import reconstruct
from elbowroom.sensing import NOISE_PRESETS, Margin
from elbowroom.simulate import InterventionRoom, render, true_occupancy, wall_cameras
from elbowroom.site import Site
from elbowroom.sources import moments

SENSOR_LATERAL_PX = (0.5, 0.0)
Tell = Callable[[str], None]
PARTS = ("real", "coverage", "images", "captures")
REAL_SITE = "kinect_board_2cam_calibration"
"""The example with two real cameras."""
INSIDE = float(chi2.ppf(0.95, 6))


@dataclass(frozen=True, slots=True)
class Case:
    """A simulated capture.

    Args:
        name: of its folder.
        size, noise: of the cameras.
        board: what they see.
        stands: so many poses are on stands, and corners measured there fix the world: in 64x48 pixels no camera reads
            a board on the floor. 0: the board on the floor defines it.
        due: worst and median error of the camera's centre [mm] and of its direction [degrees].
        seed: of the capture.
        room: whether the room is carved with these cameras.
    """

    name: str
    size: str
    noise: str
    board: Board
    stands: int
    due: dict[str, float]
    seed: int = 1
    room: bool = True

    @property
    def world(self) -> str:
        """What fixes the world, in words."""
        return f"corners measured on {self.stands} stands" if self.stands else "board on the floor"


CASES = (
    Case(
        "vga",
        "vga",
        "kinect_v1",
        Board(8, 5, 0.1, "cut_out", 0.04, marked=True, thickness_m=0.003),
        0,
        {"worst_mm": 5.0, "worst_deg": 0.15, "median_mm": 2.0, "median_deg": 0.05},
    ),
    *(
        Case(
            f"thesis-{stands}-stands-{seed}",
            "thesis",
            "tof",
            Board(5, 4, 0.18, "cut_out", 0.04, marked=True, thickness_m=0.003),
            stands,
            {"worst_mm": 15.0, "worst_deg": 0.5},
            seed,
            room=stands == 10 and seed == 1,
        )
        for stands, seeds in ((3, (1, 2, 3)), (10, (1, 2, 3, 4, 5, 6)))
        for seed in seeds
    ),
)


def extrinsics_rows(
    tell: Tell,
    captures: Path,
    parts: Sequence[str] = PARTS,
    *,
    cases: Sequence[Case] = CASES,
    cameras: int = 21,
    poses: int = 40,
    draws: int = 100,
    examples: Path = EXAMPLES,
) -> Iterator[dict[str, Any]]:
    """All rows: captures, the room with the cameras that were found, coverage, the real recording.

    Args:
        tell: told what is being done.
        captures: a folder for simulated captures; one that is there already is taken as it is.
        parts: of `PARTS`.
        cases: captures to make.
        cameras, poses: of the captures.
        draws: for the coverage of the covariance.
        examples: the folder of site files of recordings.

    Yields:
        Rows of kind "real", "coverage", "images", "extrinsics", "room".
    """
    if "real" in parts:
        yield real_row(tell, examples)
    if "coverage" in parts:
        yield coverage_row(draws, tell)
        yield coverage_row(draws, tell, stands=(1, 2, 3))
    if "images" in parts:
        tell("boards in rendered images")
        yield from board_image_rows()
    for case in cases if "captures" in parts else ():
        site = capture(case, captures / case.name, cameras, poses, tell)
        tell(f"{case.name}: looking for the board, solving")
        begun = time.perf_counter()
        seen = sightings(site)
        detected = time.perf_counter()
        found = solve_extrinsics(site.cameras(), seen.board, seen.views, anchor_of(site))
        ended = time.perf_counter()
        truth = true_poses(captures / case.name)
        yield {
            "kind": "extrinsics",
            "case": case.name,
            "world": case.world,
            "cameras": len(found.cameras),
            "poses": seen.poses,
            "images": len(seen.views) + len(seen.troubles),
            "views": len(found.seen),
            "noise": case.noise,
            "width": found.cameras[0].camera.width,
            **errors_of(found, truth),
            "detection_s": detected - begun,
            "solution_s": ended - detected,
            "seconds": ended - begun,
            "due": case.due | {"seconds": 180.0},
        }
        if case.room:
            tell(f"{case.name}: the room as these cameras see it")
            yield from room_rows(case, found, truth)


def capture(case: Case, folder: Path, cameras: int, poses: int, tell: Tell) -> Site:
    """The capture's site; rendered unless it is there.

    Args:
        case: what is calibrated.
        folder: of captures.
        cameras, poses: how many.
        tell: what is being done.
    """
    path = folder / "site.yaml"
    if not path.is_file():
        hung = wall_cameras(cameras, size=case.size, noise=NOISE_PRESETS[case.noise])
        true = started(hung, Start(), np.random.default_rng([case.seed, 5]))
        wanted = BoardCapture(true, case.board, poses, min(case.stands, poses), case.noise, case.seed)
        path = record_board(
            wanted, folder, lambda done, views: tell(f"{case.name}: rendering, {done} of {poses} poses")
        )
    return Site.load(path)


def true_poses(folder: Path) -> dict[str, NDArray[np.float64]]:
    """world_from_camera by name, as a simulated capture's `truth.yaml` has it."""
    content = yaml.safe_load((folder / "truth.yaml").read_text(encoding="utf-8"))
    return {name: np.array(camera["world_from_camera"]) for name, camera in content["cameras"].items()}


def errors_of(found: Extrinsics, truth: dict[str, NDArray[np.float64]]) -> dict[str, float]:
    """Worst and median error of centres [mm] and directions [degrees]; the share inside the stated 95 % region."""
    mm, deg, inside = [], [], []
    for one in found.cameras:
        moved, turned = pose_difference(one.camera.world_from_camera, truth[one.camera.name])
        mm.append(moved * 1e3)
        deg.append(np.degrees(turned))
        error = between(one.camera.world_from_camera, truth[one.camera.name])
        inside.append(float(error @ np.linalg.solve(one.covariance, error)) <= INSIDE)
    return {
        "worst_mm": float(max(mm)),
        "worst_deg": float(max(deg)),
        "median_mm": float(np.median(mm)),
        "median_deg": float(np.median(deg)),
        "inside_pct": 100 * float(np.mean(inside)),
    }


def room_rows(
    case: Case,
    found: Extrinsics,
    truth: dict[str, NDArray[np.float64]],
    moments_s: Sequence[float] = MOMENTS_S,
) -> Iterator[dict[str, Any]]:
    """The simulated room at 5 cm, seen by the true cameras and carved with those that were found and their margins.

    Once with the half pixel that sensors have by default beside what calibration leaves open, and once without it.

    Args:
        case: what was calibrated.
        found: the result.
        truth: world_from_camera by name, shape (4, 4).
        moments_s: of the room [s].
    """
    grid, room = VoxelGrid.covering(ROOM_LOWER_M, ROOM_UPPER_M, 0.05), InterventionRoom()
    true = [replace(one.camera, world_from_camera=truth[one.camera.name]) for one in found.cameras]
    tallies = {lateral: Tally() for lateral in SENSOR_LATERAL_PX}
    for number, time_s in enumerate(moments_s):
        moment = room.at(time_s)
        there = true_occupancy(grid, moment)
        exact = render(true, moment, noise=False)
        seen = reconstruct(grid, true, exact, rule="any", detail="point", looks=False).free
        frames = render(true, moment, seed=number)
        for lateral, tally in tallies.items():
            said = [with_margin(one, lateral) for one in found.cameras]
            space = reconstruct(grid, said, frames, machine=room.machine, joints=moment.joints, looks=False)
            tally.add(space.free, there.occupied, there.machine, seen)
    held = sum(_margin_holds(one, truth[one.camera.name]) for one in found.cameras)
    for lateral, tally in tallies.items():
        margins = [pose_margin(one.camera, one.covariance) for one in found.cameras]
        yield {
            "kind": "room",
            "case": case.name,
            "voxel_size_m": 0.05,
            "rule": "three",
            "detail": "pixel",
            "noise": case.noise,
            "moments": len(moments_s),
            **tally.row(),
            "sensor_lateral_px": lateral,
            "margin_held_pct": 100 * held / len(found.cameras),
            "pose_lateral_px": float(np.median([margin.lateral_px for margin in margins])),
            "pose_bias_mm": 1e3 * float(np.median([margin.bias_m for margin in margins])),
            "due": {"occupied_pct": 99.99, "found_pct": 88.0} if case.size == "vga" else {},
        }


def _margin_holds(one: CalibratedCamera, world_from_camera: NDArray[np.float64]) -> bool:
    """Whether the true pose displaces nothing by more than the margin of the pose that was found."""
    error = between(one.camera.world_from_camera, world_from_camera)
    return is_within(one.camera, error, pose_margin(one.camera, one.covariance))


def with_margin(one: CalibratedCamera, sensor_lateral_px: float) -> DepthCamera:
    """The camera with the usual margin of sensors and that of its pose."""
    margin = pose_margin(one.camera, one.covariance).over(Margin(lateral_px=sensor_lateral_px))
    return replace(one.camera, margin=margin)


def coverage_row(draws: int, tell: Tell, stands: Sequence[int] = ()) -> dict[str, Any]:
    """Five cameras and twelve poses, drawn anew each time: how often the stated 95 % region holds the true pose.

    Args:
        draws: how many.
        tell: told what is being done.
        stands: poses in which corners are measured, to fix the world; none: the board on the floor does.
    """
    inside, squares, held = [], [], []
    for draw in range(draws):
        if draw % 10 == 0:
            tell(f"coverage{' with stands' if stands else ''}: {draw} of {draws} draws")
        random = np.random.default_rng([draw, 95])
        cameras, poses = ring(5), board_poses(12, random)
        shaken = replace(ROUGH, hand_m=0.0002, view_px=0.03) if draw % 2 else ROUGH
        views = views_of(cameras, poses, random, shaken)
        corners = measured_corners(poses, stands, random)
        anchor = PointsAnchor(corners) if stands else BoardAnchor(0, floor())
        found = solve_extrinsics(cameras, BOARD, views, anchor)
        for camera, one in zip(cameras, found.cameras, strict=True):
            error = between(one.camera.world_from_camera, camera.world_from_camera)
            squares.append(float(error @ np.linalg.solve(one.covariance, error)))
            inside.append(squares[-1] <= INSIDE)
            held.append(_margin_holds(one, camera.world_from_camera))
    return {
        "kind": "coverage",
        "case": "projected corners and depth, hand that shakes and common errors in every second draw",
        "world": f"corners measured in {len(stands)} poses" if stands else "board on the floor",
        "cameras": 5,
        "poses": 12,
        "draws": draws,
        "inside_pct": 100 * float(np.mean(inside)),
        "margin_held_pct": 100 * float(np.mean(held)),
        "mean_square": float(np.mean(squares)),
        "due": {"inside_pct": [90.0, 99.0]},
    }


def real_row(tell: Tell, examples: Path = EXAMPLES) -> dict[str, Any]:
    """The recorded board seen by two Kinects: share of co-visible depth pixels that agree within 5 cm.

    Where the example or its recording is not there, the row says so.
    """
    tell("the recorded board")
    row: dict[str, Any] = {"kind": "real", "case": "kinect_board_2cam, pair 2", "due": {"agree_pct": 80.0}}
    try:
        site = Site.load(example(REAL_SITE, examples))
        folder = site.recording_folder()
    except InputError as error:
        return row | {"skipped": True, "note": str(error)}
    seen = sightings(site)
    found = solve_extrinsics(site.cameras(), seen.board, seen.views, anchor_of(site))
    frames = {}
    for frame in next(iter(moments(site))).frames:
        camera = next(c for c in site.cameras() if c.name == frame.camera)
        near, far = camera.min_depth_m, camera.max_depth_m
        frames[frame.camera] = np.where((frame.depth_m > near) & (frame.depth_m < far), frame.depth_m, 0)
    one, other = (camera.camera for camera in found.cameras)
    there = agreement(one, frames[one.name], other, frames[other.name])
    back = agreement(other, frames[other.name], one, frames[one.name])
    shares = {"left to right": there.agree_pct, "right to left": back.agree_pct}
    return row | {"folder": folder.name, "agree_pct": min(shares.values()), "shares_pct": shares}
