"""Boards found in simulated images, compared with where they truly are."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from elbowroom.calibrate import Board, BoardView, Fault, Trouble, cut_out_view, printed_view
from elbowroom.calibrate.simulated.hand_poses import shown
from elbowroom.geometry import DepthCamera, Intrinsics
from elbowroom.geometry.lens import distorted
from elbowroom.sensing import NOISE_PRESETS
from elbowroom.simulate import Moment, Solid, render
from elbowroom.simulate.board_plate import plate_mesh
from elbowroom.simulate.furniture import shell
from elbowroom.simulate.infrared import infrared_image
from elbowroom.simulate.shapes import box, join

CUT_OUT = Board(8, 5, 0.1, "cut_out", 0.04, marked=True, thickness_m=0.003)
COARSE = Board(5, 4, 0.18, "cut_out", 0.04, marked=True, thickness_m=0.003)
PRINTED = Board(8, 5, 0.1, "printed", 0.04, marked=True)
WALL = Solid("wall", join([box((-6, -6, 4.0), (6, 6, 4.2))]), np.eye(4), is_static=True)


def camera(
    width: int = 640, height: int = 480, noise: str = "kinect_v1", kind: str = "planar"
) -> DepthCamera:
    """At the world's origin, looking along z, 90 degrees wide."""
    intrinsics = Intrinsics(width / 2, width / 2, (width - 1) / 2, (height - 1) / 2)
    return DepthCamera("north", width, height, np.eye(4), intrinsics, kind, NOISE_PRESETS[noise])


def held(board: Board, z_m: float, turns_deg: tuple[float, float, float], x_m: float = 0.0) -> np.ndarray:
    """The board's middle before the camera, turned about x, y and z."""
    pose = np.eye(4)
    pose[:3, :3] = Rotation.from_euler("xyz", turns_deg, degrees=True).as_matrix()
    pose[:3, 3] = (x_m, 0, z_m) - pose[:3, :3] @ board.corners_in_board.mean(axis=0)
    return pose


def seen(camera: DepthCamera, board: Board, pose: np.ndarray, seed: int = 1) -> BoardView | Trouble:
    plate = Solid("board", plate_mesh(board), pose)
    moment = Moment(1.0, (WALL, plate), {})
    depth = render([camera], moment, seed=seed)[0].depth_m
    if board.kind == "cut_out":
        return cut_out_view(camera, board, depth, 0)
    return printed_view(camera, board, infrared_image(camera, moment, board, plate, seed=seed), depth, 0)


def true_corners(camera: DepthCamera, board: Board, pose: np.ndarray) -> np.ndarray:
    points = board.corners_in_board @ pose[:3, :3].T + pose[:3, 3]
    u, v = distorted(camera.intrinsics, points[:, 0] / points[:, 2], points[:, 1] / points[:, 2])
    return np.column_stack([u, v])


@pytest.mark.parametrize("noise", ["tof", "kinect_v1"])
@pytest.mark.parametrize("board", [CUT_OUT, PRINTED], ids=["cut_out", "printed"])
def test_corners_lie_within_their_stated_sigma(board: Board, noise: str) -> None:
    off, sigma = [], []
    for seed, turns in enumerate([(20, 15, 5), (-25, 10, 95), (5, -30, 178)]):
        pose = held(board, 1.7, turns)
        view = seen(camera(noise=noise), board, pose, seed)
        assert isinstance(view, BoardView), view
        off.append(view.corners_px - true_corners(camera(), board, pose))
        sigma.append(view.corner_sigma_px)
    share = np.concatenate(off) / np.concatenate(sigma)[:, None]
    assert np.abs(np.concatenate(off)).max() < 1.0
    assert 0.3 < share.std() < 1.5
    assert np.abs(np.concatenate(off).mean(axis=0)).max() < 0.05


def test_64_by_48_pixels_are_enough() -> None:
    for seed, turns in enumerate([(20, 15, 5), (-25, 10, 95), (5, -30, 178)]):
        small, pose = camera(64, 48, kind="radial"), held(COARSE, 1.4, turns)
        view = seen(small, COARSE, pose, seed)
        assert isinstance(view, BoardView), view
        assert np.abs(view.corners_px - true_corners(small, COARSE, pose)).max() < 0.5


@settings(max_examples=6)
@given(turn_deg=st.floats(-180, 180), tilt_deg=st.floats(-35, 35), z_m=st.floats(1.2, 2.4))
def test_a_turned_board_keeps_its_corners(turn_deg: float, tilt_deg: float, z_m: float) -> None:
    """Each corner is the same one however the board is turned: half a turn is told apart."""
    pose = held(CUT_OUT, z_m, (tilt_deg, 0.5 * tilt_deg, turn_deg))
    view = seen(camera(noise="tof"), CUT_OUT, pose)
    assert isinstance(view, BoardView), view
    assert np.abs(view.corners_px - true_corners(camera(), CUT_OUT, pose)).max() < 1.5


@pytest.mark.parametrize("board", [CUT_OUT, COARSE], ids=["vga", "64x48"])
def test_depths_lie_on_the_face(board: Board) -> None:
    here = camera(noise="tof") if board is CUT_OUT else camera(64, 48, "tof", "radial")
    pose = held(board, 1.4, (20, 10, 0))
    view = seen(here, board, pose)
    assert isinstance(view, BoardView), view
    k = here.intrinsics
    u, v = view.plane_px.T
    rays = np.column_stack([(u - k.cx) / k.fx, (v - k.cy) / k.fy, np.ones(len(u))])
    z = (pose[:3, 2] @ pose[:3, 3]) / (rays @ pose[:3, 2])
    true = z * np.linalg.norm(rays, axis=1) if here.depth_kind == "radial" else z
    assert len(u) >= 20
    assert abs((view.plane_depth_m - true).mean()) < 0.001
    assert np.abs(view.plane_depth_m - true).max() < 0.012


def test_the_back_of_a_board_is_called_mirrored() -> None:
    view = seen(camera(noise="tof"), CUT_OUT, held(CUT_OUT, 1.6, (180, 0, 0)))
    assert isinstance(view, Trouble)
    assert view.fault is Fault.MIRRORED


def test_a_mirrored_image_is_called_mirrored() -> None:
    pose = held(CUT_OUT, 1.6, (10, 20, 0))
    moment = Moment(1.0, (WALL, Solid("board", plate_mesh(CUT_OUT), pose)), {})
    depth = render([camera(noise="tof")], moment)[0].depth_m[:, ::-1]
    view = cut_out_view(camera(noise="tof"), CUT_OUT, np.ascontiguousarray(depth), 0)
    assert isinstance(view, Trouble)
    assert view.fault is Fault.MIRRORED


def test_a_mirrored_picture_of_a_marked_board_is_called_mirrored() -> None:
    plate = Solid("board", plate_mesh(PRINTED), held(PRINTED, 1.4, (10, 20, 0)))
    moment = Moment(1.0, (WALL, plate), {})
    grey = np.ascontiguousarray(infrared_image(camera(), moment, PRINTED, plate)[:, ::-1])
    view = printed_view(camera(), PRINTED, grey, None, 0)
    assert isinstance(view, Trouble)
    assert view.fault is Fault.MIRRORED


@pytest.mark.parametrize("board", [CUT_OUT, PRINTED], ids=["cut_out", "printed"])
def test_a_board_half_out_of_view_gives_no_view(board: Board) -> None:
    view = seen(camera(noise="tof"), board, held(board, 1.4, (10, 0, 0), x_m=1.35))
    assert isinstance(view, Trouble)
    assert view.fault in (Fault.HALF_SEEN, Fault.NOT_SEEN)


@pytest.mark.parametrize("board", [CUT_OUT, PRINTED], ids=["cut_out", "printed"])
def test_an_empty_room_gives_no_view(board: Board) -> None:
    view = seen(camera(), board, held(board, -2.0, (0, 0, 0)))
    assert isinstance(view, Trouble)
    assert view.fault is Fault.NOT_SEEN


def test_squares_of_another_size_are_named() -> None:
    pose = held(CUT_OUT, 1.6, (15, 10, 0))
    moment = Moment(1.0, (WALL, Solid("board", plate_mesh(CUT_OUT), pose)), {})
    depth = render([camera(noise="tof")], moment)[0].depth_m
    wrong = Board(8, 5, 0.08, "cut_out", 0.032, marked=True)
    view = cut_out_view(camera(noise="tof"), wrong, depth, 0, other_sizes=True)
    assert isinstance(view, Trouble)
    assert view.fault is Fault.WRONG_SIZE
    assert "0.100 m" in view.detail


def test_a_camera_behind_the_board_sees_its_back() -> None:
    assert shown(camera(), CUT_OUT, held(CUT_OUT, 1.6, (0, 0, 0))).front
    assert not shown(camera(), CUT_OUT, held(CUT_OUT, 1.6, (180, 0, 0))).front
    assert not shown(camera(), CUT_OUT, held(CUT_OUT, -1.6, (0, 0, 0))).any_part


@pytest.mark.parametrize("seed", [8, 55, 68])
def test_a_slanted_back_in_a_tiny_image_is_no_face(seed: int) -> None:
    """Squares of 2.3 pixels, whose edges fit and whose mark seems to be there: it was read as a face once."""
    world_from_camera, world_from_board = np.eye(4), np.eye(4)
    world_from_camera[:3, :3] = Rotation.from_euler("xyz", (-122.7, 0.0, -100.8), degrees=True).as_matrix()
    world_from_board[:3, :3] = Rotation.from_euler("xyz", (-110.4, -5.2, 6.1), degrees=True).as_matrix()
    world_from_camera[:3, 3], world_from_board[:3, 3] = (-1.99, 0.379, 2.4), (-0.948, -0.36, 2.069)
    tiny = replace(camera(64, 48, "tof", "radial"), name="cam10", world_from_camera=world_from_camera)
    assert not shown(tiny, COARSE, world_from_board).front
    moment = Moment(1.0, (*shell(), Solid("board", plate_mesh(COARSE), world_from_board)), {})
    depth = render([tiny], moment, seed=seed)[0].depth_m
    assert isinstance(cut_out_view(tiny, COARSE, depth, 13), Trouble)
