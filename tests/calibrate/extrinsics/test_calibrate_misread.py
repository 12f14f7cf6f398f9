"""A view that misread the board, its back for its face, is left out where other cameras tell, and only there."""

from dataclasses import replace

import numpy as np
import pytest

from elbowroom.calibrate.boards.trouble import Fault
from elbowroom.calibrate.extrinsics import BoardAnchor, solve_extrinsics
from elbowroom.errors import CalibrationError
from elbowroom.evaluate.calibrating.board_views import BOARD, board_poses, floor, ring, views_of

FLOOR = BoardAnchor(0, floor())
POSE, BEHIND = 3, "cam-0"


def made():
    """Five cameras; in one pose the board stands upright and faces away from one, which reads it all the same."""
    random = np.random.default_rng(2)
    cameras, poses = ring(5), board_poses(10, random)
    camera = next(camera for camera in cameras if camera.name == BEHIND)
    into = -camera.centre_in_world * (1, 1, 0)
    into /= np.linalg.norm(into)  # from the camera, horizontally: where the face looks
    upright = np.eye(4)
    upright[:3, 2], upright[:3, 1] = -into, (0, 0, -1)
    upright[:3, 0] = np.cross(upright[:3, 1], upright[:3, 2])
    upright[:3, 3] = (0, 0, 1.2) - upright[:3, :3] @ BOARD.corners_in_board.mean(axis=0)
    poses[POSE] = upright
    views = views_of(cameras, poses, random)
    flipped = upright.copy()
    flipped[:3, :3] = upright[:3, :3] @ np.diag([-1.0, 1.0, -1.0])
    flipped[:3, 3] = (0, 0, 1.2) - flipped[:3, :3] @ BOARD.corners_in_board.mean(axis=0)
    (misread,) = views_of((camera,), [flipped], random)
    return cameras, views, replace(misread, pose=POSE)


def test_it_is_left_out_and_told():
    cameras, views, misread = made()
    witnesses = [view.camera for view in views if view.pose == POSE]
    assert len(witnesses) >= 2 and BEHIND not in witnesses
    found = solve_extrinsics(cameras, BOARD, [*views, misread], FLOOR)
    without = solve_extrinsics(cameras, BOARD, views, FLOOR)
    (trouble,) = found.left_out
    assert (trouble.camera, trouble.pose, trouble.fault) == (BEHIND, POSE, Fault.MISREAD)
    assert not without.left_out and len(found.seen) == len(without.seen)
    for one, other in zip(found.cameras, without.cameras, strict=True):
        np.testing.assert_array_equal(one.camera.world_from_camera, other.camera.world_from_camera)


def test_with_one_witness_nobody_can_tell_and_the_pose_is_refused():
    cameras, views, misread = made()
    witness = next(view.camera for view in views if view.pose == POSE)
    views = [view for view in views if view.pose != POSE or view.camera == witness]
    with pytest.raises(CalibrationError, match=rf"pose {POSE}: .* leave pose {POSE} out"):
        solve_extrinsics(cameras, BOARD, [*views, misread], FLOOR)


def test_a_camera_that_misreads_much_is_not_used_with_what_is_left():
    cameras, views, _ = made()
    half_turned = [
        replace(view, corners_px=view.corners_px[::-1]) if view.camera == "cam-1" and view.pose % 2 else view
        for view in views
    ]
    with pytest.raises(CalibrationError, match="cam-1"):
        solve_extrinsics(cameras, BOARD, half_turned, FLOOR)
