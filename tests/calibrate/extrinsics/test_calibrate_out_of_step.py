"""A camera whose images belong to other poses, or are mirrored, is named, with what is wrong; nobody else is."""

from dataclasses import replace

import numpy as np
import pytest

from elbowroom.calibrate.extrinsics import BoardAnchor, solve_extrinsics
from elbowroom.calibrate.result.doubt import doubts_of
from elbowroom.errors import CalibrationError
from elbowroom.evaluate.calibrating.board_views import BOARD, board_poses, floor, ring, views_of
from elbowroom.geometry import DepthCamera

FLOOR = BoardAnchor(0, floor())


@pytest.fixture(scope="module")
def made():
    """Five cameras, twelve poses."""
    random = np.random.default_rng(4)
    cameras, poses = ring(5), board_poses(12, random)
    return cameras, views_of(cameras, poses, random)


def changed(views, name, change):
    return [one for view in views if (one := change(view) if view.camera == name else view) is not None]


def late(by):
    return lambda view: replace(view, pose=view.pose + by) if 0 <= view.pose + by < 12 else None


@pytest.mark.parametrize(
    ("by", "words"), [(1, "1 before: it is one pose late"), (-2, "2 after: it is 2 poses early")]
)
def test_a_camera_that_is_late_is_named_with_by_how_much(made, by, words):
    cameras, views = made
    with pytest.raises(
        CalibrationError, match=rf"camera cam-2: places the board elsewhere .* the pose {words}"
    ):
        solve_extrinsics(cameras, BOARD, changed(views, "cam-2", late(by)), FLOOR)


def test_of_two_cameras_one_is_late_beside_the_other(made):
    cameras, views = made
    two = [view for view in changed(views, "cam-2", late(1)) if view.camera in ("cam-1", "cam-2")]
    with pytest.raises(
        CalibrationError, match=r"cameras cam-\d and cam-\d: place the board apart .* it is one pose"
    ):
        solve_extrinsics(cameras[1:3], BOARD, two, FLOOR)


def test_a_mirrored_camera_is_named_as_such_though_its_board_bears_no_mark(made):
    cameras, views = made

    def mirrored(view):
        row, column = np.divmod(view.corner_ids, BOARD.columns)
        across = lambda px: (cameras[3].width - 1, 0) + px * (-1, 1)  # noqa: E731
        # the board's own order is right-handed in any image: its columns run the other way
        ids = row * BOARD.columns + BOARD.columns - 1 - column
        return replace(
            view, corner_ids=ids, corners_px=across(view.corners_px), plane_px=across(view.plane_px)
        )

    with pytest.raises(CalibrationError, match=r"camera cam-3: places .* fit if mirrored left to right"):
        solve_extrinsics(cameras, BOARD, changed(views, "cam-3", mirrored), FLOOR)


def test_images_of_poses_in_any_order_are_named_without_a_guess(made):
    cameras, views = made
    order = np.random.default_rng(1).permutation(12)
    with pytest.raises(
        CalibrationError, match=r"camera cam-0: places .* moved between poses, its images are another"
    ):
        solve_extrinsics(
            cameras,
            BOARD,
            changed(views, "cam-0", lambda view: replace(view, pose=int(order[view.pose]))),
            FLOOR,
        )


def renamed(cameras, views, names):
    """Folders exchanged: what one camera saw stands under another's name."""
    return [replace(view, camera=names.get(view.camera, view.camera)) for view in views]


@pytest.mark.parametrize(
    ("names", "words"),
    [
        ({"cam-1": "cam-4", "cam-4": "cam-1"}, "cam-1 at the place of cam-4, cam-4 at the place of cam-1: their"),
        (
            {"cam-0": "cam-1", "cam-1": "cam-2", "cam-2": "cam-0"},
            "cam-0 at the place of cam-2, cam-1 at the place of cam-0, cam-2 at the place of cam-1",
        ),
    ],
)  # fmt: skip
def test_folders_that_were_exchanged_are_named(made, names, words):
    cameras, views = made
    found = solve_extrinsics(cameras, BOARD, renamed(cameras, views, names), FLOOR)
    (doubt,) = doubts_of(found.cameras)
    assert "moved far from where the site has them" in doubt and words in doubt and "all moved" not in doubt


def test_a_world_that_was_turned_is_told_from_cameras_that_moved(made):
    cameras, views = made
    turned = floor()
    turned[:3, :2] = turned[:3, [1, 0]] * (1, -1)
    found = solve_extrinsics(cameras, BOARD, views, BoardAnchor(0, turned))
    (doubt,) = doubts_of(found.cameras)
    assert "all moved alike" in doubt and "90 degrees" in doubt and "exchanged" not in doubt


def test_poses_that_nobody_has_measured_yet_raise_no_doubt(made):
    cameras, views = made
    unknown = tuple(replace(camera, world_from_camera=np.eye(4)) for camera in cameras)
    found = solve_extrinsics(unknown, BOARD, views, FLOOR)
    assert not doubts_of(found.cameras)


def test_a_camera_that_is_hardly_known_is_no_result(made):
    cameras, views = made
    found = solve_extrinsics(cameras, BOARD, views, FLOOR).cameras
    assert not doubts_of(found)
    weak = [replace(found[0], covariance=np.diag([1e-6] * 3 + [0.3] * 3)), *found[1:]]
    (doubt,) = doubts_of(weak)
    assert "hardly known: cam-0 (949 mm, 0.1 degrees)" in doubt
    assert "put furniture" in doubts_of(weak, "put furniture there")[0]


def test_a_camera_alone_that_moved_by_metres_is_said(made):
    cameras, views = made
    moved: list[DepthCamera] = list(cameras)
    pose = moved[2].world_from_camera.copy()
    pose[:3, 3] += (2.5, 0, 0)
    moved[2] = replace(moved[2], world_from_camera=pose)
    (doubt,) = doubts_of(solve_extrinsics(moved, BOARD, views, FLOOR).cameras)
    assert "cam-2 by 2.5 m and 0 degrees" in doubt and "cam-1 by" not in doubt
