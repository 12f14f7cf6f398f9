"""Extrinsics from views of a board whose truth is known, and their laws."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.stats import chi2

from elbowroom.calibrate.extrinsics import (
    BoardAnchor,
    CameraAnchor,
    PointsAnchor,
    SeenPoint,
    solve_extrinsics,
)
from elbowroom.errors import CalibrationError
from elbowroom.evaluate.calibrating.board_views import (
    BOARD,
    EXACT,
    Shaken,
    board_poses,
    floor,
    ring,
    views_of,
)
from elbowroom.geometry import invert_rigid
from elbowroom.geometry.lens import project
from elbowroom.geometry.twist import exp, log
from elbowroom.sensing import NOISE_PRESETS

ROUGH = Shaken()
FLOOR = BoardAnchor(0, floor())


def made(seed=0, cameras=4, poses=8, shaken=ROUGH, **kinds):
    random = np.random.default_rng(seed)
    views_from = ring(cameras, **kinds)
    poses = board_poses(poses, random)
    return views_from, poses, views_of(views_from, poses, random, shaken)


def errors(found, truth):
    """Motions from found to true poses, shape (n, 6), in the order of the truth."""
    by_name = {one.camera.name: one.camera for one in found.cameras}
    return np.array(
        [
            log(invert_rigid(by_name[camera.name].world_from_camera) @ camera.world_from_camera)
            for camera in truth
        ]
    )


@pytest.mark.parametrize("kind", ["planar", "radial"])
@pytest.mark.parametrize("distortion", [(), (0.1, -0.05, 0.002, -0.001, 0.01)])
def test_exact_views_give_the_true_poses(kind, distortion):
    cameras, _, views = made(shaken=EXACT, depth_kind=kind, distortion=distortion)
    assert np.abs(errors(solve_extrinsics(cameras, BOARD, views, FLOOR), cameras)).max() < 1e-6


def test_exact_views_without_depth_give_the_true_poses():
    cameras, _, views = made(shaken=EXACT)
    views = [replace(view, plane_px=np.zeros((0, 2)), plane_depth_m=np.zeros(0)) for view in views]
    found = solve_extrinsics(cameras, BOARD, views, FLOOR)
    assert np.abs(errors(found, cameras)).max() < 1e-6
    assert not found.depth_bias_m


def test_order_of_cameras_and_views_does_not_matter():
    cameras, _, views = made()
    one = solve_extrinsics(cameras, BOARD, views, FLOOR)
    other = solve_extrinsics(cameras[::-1], BOARD, views[::-1], FLOOR)
    by_name = {camera.camera.name: camera for camera in other.cameras}
    for camera in one.cameras:
        same = by_name[camera.camera.name]
        np.testing.assert_allclose(same.camera.world_from_camera, camera.camera.world_from_camera, atol=1e-6)
        np.testing.assert_allclose(same.covariance, camera.covariance, rtol=0.02, atol=1e-12)


def test_numbers_of_poses_do_not_matter():
    cameras, _, views = made()
    named = [replace(view, pose=70 - 3 * view.pose) for view in views]
    one = solve_extrinsics(cameras, BOARD, views, FLOOR)
    other = solve_extrinsics(cameras, BOARD, named, BoardAnchor(70, floor()))
    assert np.abs(errors(one, [camera.camera for camera in other.cameras])).max() < 1e-6


def test_a_world_that_is_turned_turns_the_cameras():
    cameras, _, views = made()
    turned = exp(np.array([0.4, -0.2, 1.0, 3.0, -2.0, 0.5]))
    one = solve_extrinsics(cameras, BOARD, views, FLOOR)
    other = solve_extrinsics(cameras, BOARD, views, BoardAnchor(0, turned @ floor()))
    for camera, same in zip(one.cameras, other.cameras, strict=True):
        np.testing.assert_allclose(
            same.camera.world_from_camera, turned @ camera.camera.world_from_camera, atol=1e-6
        )
        np.testing.assert_allclose(same.covariance, camera.covariance, rtol=0.02, atol=1e-12)


def test_more_poses_make_no_covariance_larger():
    cameras, _, views = made(poses=24, cameras=4)
    few = solve_extrinsics(cameras, BOARD, [view for view in views if view.pose < 9], FLOOR)
    many = solve_extrinsics(cameras, BOARD, views, FLOOR)
    for camera, better in zip(few.cameras, many.cameras, strict=True):
        # variances are estimated, hence not exactly
        assert np.trace(better.covariance[3:, 3:]) < 1.2 * np.trace(camera.covariance[3:, 3:])
        assert np.linalg.det(better.covariance) < np.linalg.det(camera.covariance)


def test_the_camera_that_fixes_the_world_stays():
    cameras, _, views = made()
    found = solve_extrinsics(cameras, BOARD, views, CameraAnchor("cam-2"))
    held = next(one for one in found.cameras if one.camera.name == "cam-2")
    np.testing.assert_allclose(held.camera.world_from_camera, cameras[2].world_from_camera, atol=1e-12)
    assert not held.covariance.any()
    assert np.abs(errors(found, cameras)[:, 3:]).max() < 0.01


def test_named_points_fix_the_world():
    cameras, _, views = made(shaken=EXACT)
    points = {
        "door": (0.5, 0.4, 0.9),
        "table": (-0.4, 0.3, 0.7),
        "cross": (0.1, -0.5, 0.2),
        "lamp": (0, 0, 1.2),
    }
    known = []
    for name, place in points.items():
        seen_px = {}
        for camera in cameras[:3]:
            at = camera.camera_from_world
            seen_px[camera.name] = project(camera.intrinsics, (at[:3, :3] @ place + at[:3, 3])[None])[0][0]
        known.append(SeenPoint(name, np.array(place, dtype=float), seen_px))
    found = solve_extrinsics(cameras, BOARD, views, PointsAnchor(tuple(known)))
    assert np.abs(errors(found, cameras)).max() < 1e-6
    with pytest.raises(CalibrationError, match="at least 3 are needed"):
        solve_extrinsics(cameras, BOARD, views, PointsAnchor(tuple(known[:2])))
    wrong = replace(known[0], world_m=known[0].world_m + (0.1, 0, 0))
    with pytest.raises(
        CalibrationError, match=r"point door: the measured place of door lies (99|100|101) mm from"
    ):
        solve_extrinsics(cameras, BOARD, views, PointsAnchor((wrong, *known[1:])))


@pytest.mark.parametrize(
    ("shaken", "kinds"),
    [
        (Shaken(), {}),
        (Shaken(0.1, 1, 0.1, 0.002, 0.001), {}),
        (Shaken(0.15), {"width": 64, "noise": NOISE_PRESETS["tof"]}),
    ],
    ids=["independent", "shaking hand, common errors", "64x48"],
)
def test_stated_covariance_holds_the_truth(shaken, kinds):
    """A few draws here; `elbowroom bench calibration` has a hundred."""
    inside, squares = [], []
    for seed in range(5):
        cameras, _, views = made(seed, cameras=5, poses=10, shaken=shaken, **kinds)
        found = solve_extrinsics(cameras, BOARD, views, FLOOR)
        off = errors(found, cameras)
        for one, error in zip(found.cameras, off, strict=True):
            squares.append(error @ np.linalg.solve(one.covariance, error))
            inside.append(squares[-1] < chi2.ppf(0.95, 6))
    assert np.mean(inside) >= 0.8
    # far too wide would be no merit either
    assert 2.0 < np.mean(squares) < 12.0


def test_bias_and_scale_of_a_camera_s_depth_are_told():
    cameras, _, views = made(poses=12)
    views = [
        replace(view, plane_depth_m=view.plane_depth_m * 1.008 + 0.01) if view.camera == "cam-1" else view
        for view in views
    ]
    found = solve_extrinsics(cameras, BOARD, views, FLOOR)
    at_two_metres = found.depth_bias_m["cam-1"] + 2 * found.depth_scale["cam-1"]
    assert at_two_metres == pytest.approx(0.01 + 2 * 0.008, abs=0.003)
    assert np.abs(errors(found, cameras)[:, 3:]).max() < 0.01


class TestWhatDoesNotGoTogether:
    def test_a_camera_that_never_saw_the_board(self):
        cameras, _, views = made()
        views = [view for view in views if view.camera != "cam-2"]
        with pytest.raises(CalibrationError, match="never seen by camera cam-2"):
            solve_extrinsics(cameras, BOARD, views, FLOOR)

    def test_groups_that_share_no_pose(self):
        cameras, _, views = made(poses=10)
        views = [view for view in views if (view.camera in ("cam-0", "cam-1")) == (view.pose % 2 == 0)]
        with pytest.raises(CalibrationError, match="share no pose"):
            solve_extrinsics(cameras, BOARD, views, FLOOR)

    def test_a_board_of_another_size(self):
        cameras, _, views = made()
        with pytest.raises(CalibrationError, match=r"square_m is 0\.09, .* 0\.08"):
            solve_extrinsics(cameras, replace(BOARD, square_m=0.09), views, FLOOR)

    def test_a_camera_whose_depth_scale_is_wrong(self):
        cameras, _, views = made()
        views = [
            replace(view, plane_depth_m=view.plane_depth_m * 1.06) if view.camera == "cam-3" else view
            for view in views
        ]
        with pytest.raises(
            CalibrationError, match=r"camera cam-3: its depth makes the board's squares 0\.084"
        ):
            solve_extrinsics(cameras, BOARD, views, FLOOR)

    def test_a_mirrored_image(self):
        cameras, _, views = made()
        width = cameras[0].width
        views = [
            replace(view, corners_px=(width - 1, 0) + (-1, 1) * view.corners_px)
            if view.camera == "cam-0"
            else view
            for view in views
        ]
        with pytest.raises(CalibrationError, match=r"camera cam-0, pose .*mirror"):
            solve_extrinsics(cameras, BOARD, views, FLOOR)

    @pytest.mark.parametrize(("count", "words"), [(4, "at least 6"), (8, "in one line")])
    def test_a_half_seen_board(self, count, words):
        cameras, _, views = made()
        views = [
            replace(
                view,
                corner_ids=view.corner_ids[:count],
                corners_px=view.corners_px[:count],
                corner_sigma_px=view.corner_sigma_px[:count],
            )
            if view.camera == "cam-0"
            else view
            for view in views
        ]
        with pytest.raises(CalibrationError, match=words):
            solve_extrinsics(cameras, BOARD, views, FLOOR)

    def test_all_poses_in_one_plane(self):
        random = np.random.default_rng(1)
        cameras = ring(4)
        poses = [floor() for _ in range(6)]
        for pose in poses[1:]:
            pose[:2, 3] += random.uniform(-0.3, 0.3, 2)
        with pytest.raises(CalibrationError, match="all 6 poses of the board lie in one plane"):
            solve_extrinsics(cameras, BOARD, views_of(cameras, poses, random), FLOOR)

    def test_a_board_that_was_moved_between_two_images(self):
        cameras, poses, views = made(poses=12, cameras=5)
        late = [pose.copy() for pose in poses]
        late[3][:3, 3] += (0.03, 0, 0)
        who = next(view.camera for view in views if view.pose == 3)
        again = views_of(cameras, late, np.random.default_rng(5))
        views = [view for view in views if (view.pose, view.camera) != (3, who)]
        views += [view for view in again if (view.pose, view.camera) == (3, who)]
        with pytest.raises(
            CalibrationError, match=r"pose 3: .* moved between their images.* leave pose 3 out"
        ):
            solve_extrinsics(cameras, BOARD, views, FLOOR)

    def test_a_camera_that_was_moved_between_poses(self):
        cameras, poses, views = made(poses=14, cameras=5)
        knocked = replace(
            cameras[2],
            world_from_camera=cameras[2].world_from_camera @ exp(np.array([0.02, 0, 0, 0.01, 0, 0])),
        )
        late = views_of((knocked,), poses, np.random.default_rng(5))
        views = [view for view in views if view.camera != "cam-2" or view.pose < 7]
        views += [view for view in late if view.pose >= 7]
        with pytest.raises(CalibrationError, match="camera cam-2: disagrees with the others"):
            solve_extrinsics(cameras, BOARD, views, FLOOR)

    def test_a_world_that_nobody_saw(self):
        cameras, _, views = made()
        with pytest.raises(CalibrationError, match=r"pose 99.* was seen by no camera"):
            solve_extrinsics(cameras, BOARD, views, BoardAnchor(99, floor()))

    def test_too_few_views(self):
        cameras, _, views = made()
        with pytest.raises(CalibrationError, match=r"too few poses .*calibration\.least_views"):
            solve_extrinsics(cameras, BOARD, views, FLOOR, least_views=50)

    def test_a_view_that_is_there_twice(self):
        cameras, _, views = made()
        with pytest.raises(CalibrationError, match="two views"):
            solve_extrinsics(cameras, BOARD, [*views, views[0]], FLOOR)


def test_what_is_weak_is_told():
    cameras, _, views = made()
    kept = [view for view in views if view.camera != "cam-1" or view.pose < 3]
    found = solve_extrinsics(cameras, BOARD, kept, FLOOR)
    notes = next(one.notes for one in found.cameras if one.camera.name == "cam-1")
    assert any("poses only" in note for note in notes)
    assert any("no corner ever in the" in note for note in notes)
