"""Points of measured place fix the world: corners of the board in several poses, and points in images."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.stats import chi2

from elbowroom.calibrate.extrinsics import BoardAnchor, PointsAnchor, SeenPoint, solve_extrinsics
from elbowroom.calibrate.extrinsics.known_points import KnownPoints
from elbowroom.calibrate.extrinsics.unknowns import Index, State
from elbowroom.errors import CalibrationError
from elbowroom.evaluate.calibrating.board_views import (
    BOARD,
    EXACT,
    Shaken,
    board_poses,
    measured_corners,
    ring,
    views_of,
)
from elbowroom.geometry import invert_rigid
from elbowroom.geometry.lens import project
from elbowroom.geometry.twist import exp, log
from elbowroom.sensing import NOISE_PRESETS

SIGMA_M = 0.002
COARSE = {"width": 64, "noise": NOISE_PRESETS["tof"]}
ROUGH = Shaken(0.15)
STANDS = (1, 2, 3)
PLACES = {"door": (0.5, 0.4, 0.9), "table": (-0.4, 0.3, 0.7), "cross": (0.1, -0.5, 0.2), "lamp": (0, 0, 1.2)}


def made(seed, cameras=5, poses=10, shaken=ROUGH, **kinds):
    random = np.random.default_rng([seed, 4])
    cameras, poses = ring(cameras, **(kinds or COARSE)), board_poses(poses, random)
    for pose in STANDS:  # far apart, as stands are
        angle = 2 * np.pi * pose / len(STANDS)
        poses[pose][:2, 3] += (0.8 * np.cos(angle), 0.8 * np.sin(angle)) - poses[pose][:2, 3]
    return cameras, poses, views_of(cameras, poses, random, shaken), random


def seen_points(cameras, random, sigma_m=SIGMA_M, sigma_px=0.5):
    """Points that all cameras see: measured places, and pixels that somebody clicked."""
    points = []
    for name, place in PLACES.items():
        seen_px = {}
        for camera in cameras:
            at = camera.camera_from_world
            pixel = project(camera.intrinsics, (at[:3, :3] @ place + at[:3, 3])[None])[0][0]
            seen_px[camera.name] = pixel + random.normal(0, sigma_px, 2)
        points.append(SeenPoint(name, np.array(place) + random.normal(0, sigma_m, 3), seen_px))
    return tuple(points)


def errors(found, truth):
    by_name = {one.camera.name: one.camera for one in found.cameras}
    return np.array(
        [
            log(invert_rigid(by_name[camera.name].world_from_camera) @ camera.world_from_camera)
            for camera in truth
        ]
    )


def common_error_m(found, truth):
    """How far the cameras' centres are off in the mean, all together [m]."""
    by_name = {one.camera.name: one.camera for one in found.cameras}
    off = [by_name[camera.name].centre_in_world - camera.centre_in_world for camera in truth]
    return float(np.linalg.norm(np.mean(off, axis=0)))


def test_exact_corners_of_several_poses_give_the_true_poses():
    cameras, poses, views, random = made(0, shaken=EXACT, width=640)
    found = solve_extrinsics(
        cameras, BOARD, views, PointsAnchor(measured_corners(poses, STANDS, random, sigma_m=0))
    )
    assert np.abs(errors(found, cameras)).max() < 1e-6
    assert max(found.points_off_m.values()) < 1e-6


def test_several_known_poses_leave_less_to_all_cameras_together_than_one():
    off = {1: [], 3: []}
    for seed in range(5):
        cameras, poses, views, random = made(seed, cameras=4, poses=8)
        for count, own in off.items():
            anchor = PointsAnchor(measured_corners(poses, STANDS[:count], random))
            own.append(common_error_m(solve_extrinsics(cameras, BOARD, views, anchor), cameras))
    assert np.mean(off[3]) < 0.6 * np.mean(off[1])


def test_one_more_known_pose_makes_no_covariance_larger():
    cameras, poses, views, random = made(1)
    corners = measured_corners(poses, STANDS, random)
    some, more = (solve_extrinsics(cameras, BOARD, views, PointsAnchor(corners[:n])) for n in (6, 9))
    for camera, better in zip(some.cameras, more.cameras, strict=True):
        gained = np.linalg.eigvalsh(camera.covariance - better.covariance)
        assert gained.min() > -1e-3 * gained.max()


def test_corners_that_are_surely_known_are_as_a_pose_that_is_held():
    cameras, poses, views, random = made(2)
    corners = measured_corners(poses, (1,), random, sigma_m=0)
    held = solve_extrinsics(cameras, BOARD, views, BoardAnchor(1, poses[1]))
    known = solve_extrinsics(cameras, BOARD, views, PointsAnchor(corners, sigma_m=1e-6))
    for one, other in zip(held.cameras, known.cameras, strict=True):
        np.testing.assert_allclose(other.camera.world_from_camera, one.camera.world_from_camera, atol=2e-5)
        np.testing.assert_allclose(np.diag(other.covariance), np.diag(one.covariance), rtol=0.05)


def test_order_of_points_cameras_and_views_does_not_matter():
    cameras, poses, views, random = made(3)
    points = (*measured_corners(poses, STANDS, random), *seen_points(cameras, random))
    one = solve_extrinsics(cameras, BOARD, views, PointsAnchor(points))
    other = solve_extrinsics(cameras[::-1], BOARD, views[::-1], PointsAnchor(points[::-1]))
    by_name = {camera.camera.name: camera for camera in other.cameras}
    for camera in one.cameras:
        same = by_name[camera.camera.name]
        np.testing.assert_allclose(same.camera.world_from_camera, camera.camera.world_from_camera, atol=1e-5)
        np.testing.assert_allclose(same.covariance, camera.covariance, rtol=0.02, atol=1e-8)


@pytest.mark.parametrize("kinds", [{"width": 640}, COARSE], ids=["640x480", "64x48"])
@pytest.mark.parametrize("by", ["corners", "pixels"])
def test_stated_covariance_holds_the_truth(kinds, by):
    """With errors of measured places drawn as they are said; none of them is refused."""
    inside, squares = [], []
    for seed in range(4):
        cameras, poses, views, random = made(seed, poses=9, **kinds)
        points = measured_corners(poses, STANDS, random) if by == "corners" else seen_points(cameras, random)
        found = solve_extrinsics(cameras, BOARD, views, PointsAnchor(points))
        for one, error in zip(found.cameras, errors(found, cameras), strict=True):
            squares.append(error @ np.linalg.solve(one.covariance, error))
            inside.append(squares[-1] < chi2.ppf(0.95, 6))
    assert np.mean(inside) >= 0.8
    # far too wide would be no merit either
    assert 2.0 < np.mean(squares) < 12.0


def test_derivatives_are_those_of_the_residuals():
    cameras, poses, _, random = made(4)
    anchor = PointsAnchor((*measured_corners(poses, STANDS, random), *seen_points(cameras[:3], random)))
    known = KnownPoints(anchor, {camera.name: camera for camera in cameras})
    state = State({c.name: c.world_from_camera for c in cameras}, dict(enumerate(poses)), {})
    index = Index(state, None)
    step, small = random.normal(0, 1, index.size), 1e-6
    shift = random.normal(0, 1, 3)
    moved = [known.rows(state.moved(sign * small * step, index), index) for sign in (1, -1)]
    shifted = []
    for sign in (1, -1):
        points = tuple(
            replace(point, world_m=point.world_m + sign * small * shift) for point in anchor.points
        )
        shifted.append(KnownPoints(replace(anchor, points=points), known.cameras).rows(state, index))
    for number, own in enumerate(known.rows(state, index)):
        slope = (moved[0][number].residual - moved[1][number].residual) / (2 * small)
        # weights change with the step, by residuals of a few sigmas
        tolerance = 1e-3 * np.abs(slope).max() + 10
        np.testing.assert_allclose(own.rows @ step[own.among], slope, atol=tolerance)
        slope = (shifted[0][number].residual - shifted[1][number].residual) / (2 * small)
        np.testing.assert_allclose(own.by_shift @ shift, slope, atol=1e-3 * np.abs(slope).max() + 10)


def test_corners_in_a_pose_that_nobody_saw_are_left_out_and_told():
    cameras, poses, views, random = made(8)
    views = [view for view in views if view.pose != 3]
    points = measured_corners(poses, STANDS, random)
    found = solve_extrinsics(cameras, BOARD, views, PointsAnchor(points))
    assert found.points_unseen == tuple(point.name for point in points if point.pose == 3)
    kept = tuple(point for point in points if point.pose != 3)
    other = solve_extrinsics(cameras, BOARD, views, PointsAnchor(kept))
    assert other.points_unseen == ()
    np.testing.assert_array_equal(errors(found, cameras), errors(other, cameras))
    assert set(found.points_off_m) == {point.name for point in kept}


class TestPlacesThatContradict:
    def test_one_of_three_poses_is_named_with_how_far_it_is_off(self):
        cameras, poses, views, random = made(5)
        points = measured_corners(poses, STANDS, random)
        wrong = [replace(p, world_m=p.world_m + (0, 0.1, 0)) if p.pose == 2 else p for p in points]
        with pytest.raises(CalibrationError, match=r"^pose 2: .* lies (9\d|10\d|11\d) mm from") as caught:
            solve_extrinsics(cameras, BOARD, views, PointsAnchor(tuple(wrong)))
        assert "or it is" not in str(caught.value) and "\n" not in str(caught.value)

    def test_of_two_poses_both_are_named(self):
        cameras, poses, views, random = made(5)
        points = measured_corners(poses, (1, 2), random)
        wrong = [replace(p, world_m=p.world_m + (0, 0.1, 0)) if p.pose == 2 else p for p in points]
        with pytest.raises(CalibrationError, match=r"pose [12]: .*or it is pose [12] that is wrong"):
            solve_extrinsics(cameras, BOARD, views, PointsAnchor(tuple(wrong)))

    @pytest.mark.parametrize("which", [(2,), STANDS])
    def test_a_corner_that_was_written_down_wrong(self, which):
        cameras, poses, views, random = made(6)
        points = measured_corners(poses, which, random)
        wrong = [
            replace(p, world_m=p.world_m + 0.1 * (poses[2][:3, 0])) if p.name == "stand 2, corner 0" else p
            for p in points
        ]
        with pytest.raises(CalibrationError, match=r"^pose 2: the measured place of stand 2, corner"):
            solve_extrinsics(cameras, BOARD, views, PointsAnchor(tuple(wrong)))

    def test_places_worse_than_they_are_said_to_be(self):
        cameras, poses, views, random = made(7)
        points = measured_corners(poses, STANDS, random, sigma_m=0.015)
        with pytest.raises(CalibrationError, match="more than sigma_m of 2 mm allows"):
            solve_extrinsics(cameras, BOARD, views, PointsAnchor(points))
        solve_extrinsics(cameras, BOARD, views, PointsAnchor(points, sigma_m=0.015))

    def test_no_pose_that_anybody_saw(self):
        cameras, poses, views, random = made(8)
        views = [view for view in views if view.pose != 3]
        with pytest.raises(
            CalibrationError, match=r"point stand 3, corner 0: .* pose 3, which was seen by no camera"
        ):
            solve_extrinsics(cameras, BOARD, views, PointsAnchor(measured_corners(poses, (3,), random)))

    def test_a_point_behind_the_camera_that_sees_it(self):
        cameras, poses, views, random = made(9)
        lost = SeenPoint("lost", cameras[0].centre_in_world * 1.5, {"cam-0": np.array([30.0, 20.0])})
        with pytest.raises(CalibrationError, match="point lost: lies behind camera cam-0"):
            solve_extrinsics(
                cameras, BOARD, views, PointsAnchor((*measured_corners(poses, STANDS, random), lost))
            )

    def test_points_in_a_line(self):
        cameras, poses, views, random = made(10)
        points = [
            replace(point, world_m=(poses[1] @ np.append(at, 1))[:3], board_m=at)
            for point, at in zip(
                measured_corners(poses, (1,), random), BOARD.corners_in_board[[0, 3, 7]], strict=True
            )
        ]
        with pytest.raises(CalibrationError, match="lie in a line"):
            solve_extrinsics(cameras, BOARD, views, PointsAnchor(tuple(points)))


def test_a_world_that_is_turned_turns_the_cameras():
    cameras, poses, views, random = made(11)
    turned = exp(np.array([0.4, -0.2, 1.0, 3.0, -2.0, 0.5]))
    points = measured_corners(poses, STANDS, random)
    also = tuple(replace(point, world_m=(turned @ np.append(point.world_m, 1))[:3]) for point in points)
    one = solve_extrinsics(cameras, BOARD, views, PointsAnchor(points))
    other = solve_extrinsics(cameras, BOARD, views, PointsAnchor(also))
    for camera, same in zip(one.cameras, other.cameras, strict=True):
        np.testing.assert_allclose(
            same.camera.world_from_camera, turned @ camera.camera.world_from_camera, atol=1e-5
        )
        np.testing.assert_allclose(same.covariance, camera.covariance, rtol=0.02, atol=1e-8)
