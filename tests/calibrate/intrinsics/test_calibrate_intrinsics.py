"""Intrinsics from views whose corners are where the truth puts them, give or take their sigma."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from elbowroom.calibrate import Board, BoardView
from elbowroom.calibrate.intrinsics import advice, cells_seen, solve_intrinsics
from elbowroom.errors import CalibrationError
from elbowroom.geometry import DepthCamera, Intrinsics
from elbowroom.geometry.lens import directions, project
from elbowroom.sensing import NOISE_PRESETS

BOARD = Board(8, 5, 0.1, "cut_out", 0.04, marked=True)
TRUE = Intrinsics(325.0, 323.5, 322.0, 236.0, (-0.05, 0.012, 0.001, -0.0005, 0.0005))
SIGMA_PX = 0.15


def camera() -> DepthCamera:
    k = Intrinsics(320.0, 320.0, 319.5, 239.5)
    return DepthCamera("north", 640, 480, np.eye(4), k, noise=NOISE_PRESETS["kinect_v1"])


def view(
    pose: int,
    camera_from_board: np.ndarray,
    random: np.random.Generator,
    scale: float = 1.0,
    bias_m: float = 0.0,
) -> BoardView:
    corners = BOARD.corners_in_board @ camera_from_board[:3, :3].T + camera_from_board[:3, 3]
    pixels, _ = project(TRUE, corners)
    pixels = pixels + SIGMA_PX * random.standard_normal(pixels.shape)
    low, high = np.ceil(pixels.min(axis=0)), np.floor(pixels.max(axis=0))
    plane_px = np.rint(random.uniform(low, high, (600, 2)))
    rays = np.column_stack([directions(TRUE, plane_px), np.ones(600)])
    normal = camera_from_board[:3, 2]
    depth = scale * (normal @ camera_from_board[:3, 3]) / (rays @ normal) + bias_m
    depth = depth + NOISE_PRESETS["kinect_v1"].sigma(depth) * random.standard_normal(600)
    return BoardView("north", pose, np.arange(40), pixels, np.full(40, SIGMA_PX), plane_px, depth)


def poses(count: int, tilt_deg: float, random: np.random.Generator) -> list[np.ndarray]:
    made = []
    for _ in range(count):
        pose = np.eye(4)
        turns = (*random.uniform(-tilt_deg, tilt_deg, 2), 20 * random.standard_normal())
        pose[:3, :3] = Rotation.from_euler("xyz", turns, degrees=True).as_matrix()
        z = random.uniform(1.0, 2.2)
        middle = np.array([random.uniform(-0.45, 0.45) * z, random.uniform(-0.35, 0.35) * z, z])
        pose[:3, 3] = middle - pose[:3, :3] @ BOARD.corners_in_board.mean(axis=0)
        made.append(pose)
    return made


def views(count: int, tilt_deg: float = 35.0, seed: int = 1, **depth: float) -> list[BoardView]:
    random = np.random.default_rng(seed)
    return [view(n, pose, random, **depth) for n, pose in enumerate(poses(count, tilt_deg, random))]


def test_focal_length_lens_and_depth_are_found_within_their_sigmas() -> None:
    found = solve_intrinsics(camera(), BOARD, views(15, scale=1.008, bias_m=-0.006))
    k = found.camera.intrinsics
    assert len(k.distortion) == 5
    assert abs(k.fx / TRUE.fx - 1) < 0.003
    assert abs(k.fy / TRUE.fy - 1) < 0.003
    off = np.array([k.fx - TRUE.fx, k.fy - TRUE.fy, k.cx - TRUE.cx, k.cy - TRUE.cy])
    assert (np.abs(off) < 4 * found.sigma[:4]).all()
    assert abs(found.depth_scale - 1.008) < 4 * found.depth_sigma[0]
    assert abs(found.depth_bias_m + 0.006) < 4 * found.depth_sigma[1]


def test_stated_sigmas_are_those_of_the_errors() -> None:
    shares = []
    for seed in range(6):
        found = solve_intrinsics(camera(), BOARD, views(10, seed=seed), coefficients=5)
        k = found.camera.intrinsics
        off = np.array([k.fx - TRUE.fx, k.fy - TRUE.fy, k.cx - TRUE.cx, k.cy - TRUE.cy])
        shares.append(off / found.sigma[:4])
    assert 0.5 < np.sqrt(np.mean(np.square(shares))) < 1.7


def test_the_order_of_views_does_not_matter() -> None:
    some = views(8)
    one = solve_intrinsics(camera(), BOARD, some, coefficients=0).camera.intrinsics
    other = solve_intrinsics(camera(), BOARD, some[::-1], coefficients=0).camera.intrinsics
    assert abs(one.fx - other.fx) < 1e-3 and abs(one.cx - other.cx) < 1e-3


def test_too_few_views_are_refused() -> None:
    with pytest.raises(CalibrationError, match="camera north: the board is seen 2 times, needed are 3"):
        solve_intrinsics(camera(), BOARD, views(2))


def test_a_board_never_seen_is_refused() -> None:
    with pytest.raises(CalibrationError, match="seen 0 times"):
        solve_intrinsics(camera(), BOARD, [])


def test_parallel_poses_are_refused() -> None:
    with pytest.raises(CalibrationError, match=r"parallel.*tilt the board"):
        solve_intrinsics(camera(), BOARD, views(6, tilt_deg=0.0))


def test_a_wrong_size_is_told_from_depth() -> None:
    wrong = Board(8, 5, 0.08, "cut_out", 0.04, marked=True)
    with pytest.raises(CalibrationError, match=r"1\.2[0-9] times what squares of 0.08 m say.*0\.10"):
        solve_intrinsics(camera(), wrong, views(8))


def test_advice_names_the_parts_that_were_never_seen() -> None:
    random = np.random.default_rng(1)
    pose = np.eye(4)
    pose[:3, 3] = (-0.9, -0.7, 1.5)
    only = [view(0, pose, random)]
    counts = cells_seen(camera(), only)
    assert counts.sum() == 40 and counts[2, 2] == 0
    said = " ".join(advice(camera(), only, [pose]))
    assert "lower right corner" in said and "tilt the board" in said and "only 1 views" in said
