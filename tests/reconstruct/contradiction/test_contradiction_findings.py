"""Cameras whose description is wrong are named, with what undoes it; right ones are left alone."""

from dataclasses import replace

import numpy as np
import pytest

from elbowroom.errors import ImplausibleError
from elbowroom.evaluate.contradictions.wrongs import KINDS
from elbowroom.geometry import DepthCamera, Intrinsics
from elbowroom.geometry.twist import exp
from elbowroom.reconstruct.contradiction.findings import beyond_limit, contradictions
from elbowroom.reconstruct.contradiction.pairs import Pairs
from elbowroom.reconstruct.contradiction.views import Views
from elbowroom.reconstruct.looking import require_plausible
from elbowroom.sensing import NOISE_PRESETS, DepthFrame
from reference.contradiction_room import GRID, MARGIN, room_cameras, room_scene, room_site
from reference.reconstruct_scenes import camera_at, frame_of

RIGHT = room_site()


def found(cameras, frames=RIGHT.snapshot.frames):
    return contradictions(cameras, frames, MARGIN)


def posed(camera, pose):
    return replace(camera, world_from_camera=pose)


def test_right_cameras_are_left_alone():
    assert found(RIGHT.cameras) == ()


@pytest.mark.parametrize("seed", range(5))
def test_what_a_calibration_leaves_open_is_no_contradiction(seed):
    rng = np.random.default_rng(seed)
    off = [np.concatenate([rng.normal(0, 0.003, 3), rng.normal(0, 0.006, 3)]) for _ in RIGHT.cameras]
    cameras = [
        posed(camera, camera.world_from_camera @ exp(twist))
        for camera, twist in zip(RIGHT.cameras, off, strict=True)
    ]
    assert found(cameras) == ()


@pytest.mark.parametrize("kind", KINDS)
def test_wrong_cameras_are_named_and_stop_everything(kind):
    wrong = KINDS[kind](np.random.default_rng(3), RIGHT)
    findings = found(wrong.cameras)
    assert {name for finding in findings for name in finding.about} == wrong.named
    assert any(finding.stops or "shares no view" in finding.text for finding in findings)
    assert all(finding.kind == "contradiction" and "\n" not in finding.text for finding in findings)


def test_the_alternative_that_fits_is_told_with_both_figures():
    (finding,) = found(KINDS["inverse, all"](np.random.default_rng(0), RIGHT).cameras)
    assert "camera-from-world: with the inverse 0.0 % contradict instead of" in finding.text
    (finding,) = found(KINDS["two exchanged"](np.random.default_rng(1), RIGHT).cameras)
    assert len(finding.about) == 2 and "each other's pose" in finding.text
    (finding,) = found(KINDS["lens of twice the size, all"](np.random.default_rng(1), RIGHT).cameras)
    assert "an image 2 times as large" in finding.text


def test_the_camera_whose_pose_is_another_ones_too_is_told_so():
    wrong = KINDS["pose of another"](np.random.default_rng(2), RIGHT)
    (finding,) = found(wrong.cameras)
    assert "it has the pose of" in finding.text


def test_depths_in_another_unit_of_one_camera_are_named():
    frames = list(RIGHT.snapshot.frames)
    frames[2] = DepthFrame(frames[2].camera, 0, frames[2].depth_m * np.float32(4))
    (finding,) = found(RIGHT.cameras, frames)
    assert finding.about == ("sw",) and finding.stops
    assert "4 times too large" in finding.text


def test_planar_depth_read_as_radial_is_named():
    cameras = [replace(camera, depth_kind="radial") for camera in RIGHT.cameras]
    (finding,) = found(cameras)
    assert finding.stops and "depth_kind" in finding.text


@pytest.mark.parametrize("flip", [np.s_[::-1], np.s_[:, ::-1]])
def test_images_that_one_camera_flips_are_named(flip):
    frames = list(RIGHT.snapshot.frames)
    frames[1] = DepthFrame(frames[1].camera, 0, frames[1].depth_m[flip])
    (finding,) = found(RIGHT.cameras, frames)
    assert finding.about == ("nw",) and finding.stops


def test_two_cameras_with_mistakes_of_their_own_are_both_named():
    cameras = list(RIGHT.cameras)
    six = [*cameras, *room_cameras()[:2]]
    six[4], six[5] = (
        replace(
            six[n],
            name=name,
            world_from_camera=six[n].world_from_camera @ exp(np.array((0, 0.1, 0, 0.3, 0, 0))),
        )
        for n, name in ((4, "e"), (5, "w"))
    )
    frames = [frame_of(camera, room_scene()) for camera in six]
    wrong = list(six)
    turned = six[1].world_from_camera @ np.diag((1.0, -1.0, -1.0, 1.0))
    wrong[1] = posed(six[1], turned)
    wrong[4] = posed(six[4], np.linalg.inv(six[4].world_from_camera))
    about = {name for finding in found(wrong, frames) for name in finding.about}
    assert about == {"nw", "e"}


def test_noise_and_people_between_exposures_are_no_contradiction():
    cameras = room_cameras(NOISE_PRESETS["kinect_v1"])
    rng = np.random.default_rng(5)
    frames = []
    for number, camera in enumerate(cameras):
        exact = frame_of(camera, room_scene(person=number != 2))
        noisy = exact.depth_m + rng.normal(size=exact.depth_m.shape) * camera.noise.sigma(exact.depth_m)
        frames.append(DepthFrame(camera.name, number * 500_000_000, noisy.astype(np.float32)))
    assert not any(finding.stops for finding in found(cameras, frames))


@pytest.mark.parametrize("value", [0.0, np.nan, np.inf, 3.0])
def test_images_without_a_surface_in_common_say_nothing(value):
    frames = [DepthFrame(camera.name, 0, np.full((120, 160), value, np.float32)) for camera in RIGHT.cameras]
    assert all(not finding.stops or value == 3.0 for finding in found(RIGHT.cameras, frames))


def test_one_camera_or_none_contradicts_nobody():
    assert found(RIGHT.cameras[:1]) == () and found(()) == () and found(RIGHT.cameras, ()) == ()


def test_tiny_images_are_too_small_to_compare():
    cameras = [DepthCamera(str(n), 2, 1, np.eye(4), Intrinsics(1.0, 1.0, 0.5, 0.0)) for n in range(3)]
    frames = [DepthFrame(camera.name, 0, np.ones((1, 2), np.float32)) for camera in cameras]
    assert found(cameras, frames) == ()


def test_few_contradictions_warn_at_most_and_none_are_not_told():
    pairs = Pairs.none(2)
    views = Views.of(RIGHT.cameras[:2], RIGHT.snapshot.frames, MARGIN)
    pairs.through[0, 1], pairs.agrees[0, 1] = 17, 29
    (finding,) = beyond_limit(views.eyes, pairs)
    assert not finding.stops
    pairs.through[0, 1] = 5
    assert beyond_limit(views.eyes, pairs) == ()


def test_masked_pixels_are_not_compared():
    frames = list(RIGHT.snapshot.frames)
    spoilt = frames[0].depth_m.copy()
    spoilt[:, :80] *= np.float32(0.4)
    frames[0] = DepthFrame("ne", 0, spoilt)
    assert any(finding.kind == "contradiction" for finding in found(RIGHT.cameras, frames))
    mask = np.zeros((120, 160), dtype=bool)
    mask[:, :80] = True
    findings = found([replace(RIGHT.cameras[0], mask=mask), *RIGHT.cameras[1:]], frames)
    assert [finding.kind for finding in findings] == ["mask"]


def test_a_mask_of_other_images_is_told_of_and_the_right_one_is_not():
    frames = list(RIGHT.snapshot.frames)
    dark = frames[0].depth_m.copy()
    dark[:30] = 0
    frames[0] = DepthFrame("ne", 0, dark)
    for rows, told in ((slice(0, 30), False), (slice(90, 120), True)):
        mask = np.zeros((120, 160), dtype=bool)
        mask[rows] = True
        findings = found([replace(RIGHT.cameras[0], mask=mask), *RIGHT.cameras[1:]], frames)
        assert [finding.kind for finding in findings] == (["mask"] if told else [])
        assert not any(finding.stops for finding in findings)


def test_reconstruct_refuses_what_contradicts():
    wrong = KINDS["two exchanged"](np.random.default_rng(1), RIGHT)
    with pytest.raises(ImplausibleError, match="each other's pose"):
        require_plausible(GRID, wrong.cameras, RIGHT.snapshot.frames, MARGIN)


def test_a_camera_that_shares_no_view_is_told_of_where_it_looks_out_of_the_room_and_not_where_it_looks_into_a_corner():
    over_a_corner = camera_at("over", (-1.7, -1.7, 2.7), (-1.7, -1.69, 0.0), size=(160, 120), focal=400.0)
    frames = [*RIGHT.snapshot.frames, frame_of(over_a_corner, room_scene())]
    assert found([*RIGHT.cameras, over_a_corner], frames) == ()
    moved = np.eye(4)
    moved[0, 3] = 6.0
    away = posed(over_a_corner, moved @ over_a_corner.world_from_camera)
    (finding,) = found([*RIGHT.cameras, away], frames)
    assert finding.about == ("over",) and not finding.stops and "outside of all that they see" in finding.text
