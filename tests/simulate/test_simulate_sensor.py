from dataclasses import replace

import cv2
import numpy as np
import pytest

from elbowroom.errors import CameraError, InputError
from elbowroom.geometry import DepthCamera, Intrinsics, parallel
from elbowroom.sensing import NOISE_PRESETS, NoiseModel
from elbowroom.sensing.rays import pixel_rays
from elbowroom.simulate import Moment, Optics, Solid, render, wall_cameras
from elbowroom.simulate.kernels import sensor as kernels
from elbowroom.simulate.shapes import box, ellipsoid, join
from reference import simulate_sensor as naive_sensor
from reference import simulate_truth as naive

BARREL = (-0.12, 0.02, 0.001, -0.0008, -0.001)
RATIONAL = (0.6, -2.7, 0.0006, -0.0002, 1.6, 0.48, -2.5, 1.5)
WALL = Solid("wall", join([box((-9, -9, 3), (9, 9, 4))]), np.eye(4), is_static=True)
BALL = Solid("ball", join([ellipsoid((0, 0, 2), (0.4, 0.4, 0.4), rows=12, columns=24)]), np.eye(4))
SCENE = Moment(1.5, (WALL, BALL), {})


def camera(kind="planar", width=64, height=48, focal=40.0, distortion=(), **more):
    intrinsics = Intrinsics(focal, focal, (width - 1) / 2, (height - 1) / 2, distortion)
    return DepthCamera("eye", width, height, np.eye(4), intrinsics, kind, **more)


def exact(camera, moment):
    return render([camera], moment, noise=False)[0].depth_m


@pytest.mark.parametrize("kind", ["planar", "radial"])
@pytest.mark.parametrize("distortion", [(), BARREL, RATIONAL], ids=["pinhole", "barrel", "rational"])
def test_depth_is_what_rays_through_triangles_one_by_one_give(room, kind, distortion):
    eye = wall_cameras(5, width=12, height=9, optics=Optics(depth_kind=kind))[3]
    eye = replace(eye, intrinsics=replace(eye.intrinsics, distortion=distortion))
    moment = room.at(4.0)
    triangles = np.concatenate([solid.vertices_in_world[solid.mesh.faces] for solid in moment.solids])
    rays = pixel_rays(eye)
    directions = np.stack([rays.x, rays.y, np.ones_like(rays.x)], axis=-1).reshape(-1, 3).astype(float)
    expected = np.array(
        [
            naive.first_hit(triangles, eye.centre_in_world, eye.world_from_camera[:3, :3] @ direction)
            for direction in directions
        ]
    )
    if kind == "radial":
        expected *= np.linalg.norm(directions, axis=1)
    found = exact(eye, moment).ravel()
    # a ray along an edge of a silhouette may fall to either side
    off = np.abs(found - expected) > 5e-6
    assert off.sum() <= 1, np.stack([found[off], expected[off]])


def test_moving_solid_is_seen_where_it_is():
    for shift in (-0.5, 0.0, 0.7):
        pose = np.eye(4)
        pose[0, 3] = shift
        depth = exact(camera(), Moment(0.0, (WALL, Solid("ball", BALL.mesh, pose)), {}))
        seen = np.argwhere(depth < 2.9)
        assert (seen[:, 1].mean() - 31.5) / 40.0 == pytest.approx(shift / 2, abs=0.02)
        assert depth.min() == pytest.approx(1.6, abs=0.02)
        assert depth.max() == pytest.approx(3.0, abs=1e-6)


def test_solid_behind_the_camera_is_not_seen():
    pose = np.eye(4)
    pose[2, 3] = -4
    assert exact(camera(), Moment(0.0, (WALL, Solid("ball", BALL.mesh, pose)), {})).min() > 2.9


def test_camera_within_the_box_of_a_solid_sees_it():
    ring = join([box((-1, -1, -1), (-0.9, 1, 1)), box((0.5, -1, -1), (0.6, 1, 1))])
    assert exact(camera(focal=20.0), Moment(0.0, (WALL, Solid("ring", ring, np.eye(4))), {})).min() < 1.0


def test_nothing_and_what_is_out_of_range_are_no_return():
    assert (exact(camera(), Moment(0.0, (BALL,), {})) == 0).any()
    near = exact(camera(max_depth_m=2.5), SCENE)
    far = exact(camera(min_depth_m=2.5), SCENE)
    assert near.max() < 2.5
    assert far[far > 0].min() > 2.9
    assert ((near > 0) != (far > 0)).all()
    noisy = render([camera(noise=NoiseModel(0.3), max_depth_m=3.0)], SCENE)[0].depth_m
    assert noisy.max() <= 3.0


def test_radial_depth_is_the_distance_from_the_centre():
    eye = camera("radial")
    ratio = exact(eye, SCENE) / exact(camera("planar"), SCENE)
    assert ratio == pytest.approx(eye.radial_over_planar, rel=1e-6)


@pytest.mark.parametrize("radial", [False, True])
def test_sensor_kernel_equals_its_twin(room, radial):
    eye = wall_cameras(5, width=48, height=36)[2]
    rng = np.random.default_rng(3)
    depth = exact(eye, room.at(6.0)).copy()
    depth[10:13, 20:25] = np.inf
    dark = rng.random(depth.shape) < 0.3
    normal = rng.standard_normal(depth.shape, dtype=np.float32)
    uniform = rng.integers(0, 2**32, depth.shape, dtype=np.uint32)
    sensor = kernels.Sensor(0.5, 0.1, 0.2, 0.3, 0.05, 0.8, 4.5, 0.003, 0.001, 0.002, 0.4, radial)
    found = np.empty_like(depth)
    kernels.disturb(depth, dark, pixel_rays(eye), normal, uniform, sensor, found)
    rays = pixel_rays(eye)
    expected = naive_sensor.disturbed(depth, dark, rays.x, rays.y, normal, uniform, sensor)
    assert 0.2 < (found == 0).mean() < 0.8
    assert found == pytest.approx(np.array(expected), rel=1e-5)


def test_noise_has_the_sigma_of_the_model():
    model = NoiseModel(0.002, 0.001, 0.0005, 1.0)
    bare = Moment(0.0, (WALL,), {})
    eye = camera(width=320, height=240, focal=200.0, noise=model)
    depth = render([eye], bare, missing=0.0)[0].depth_m
    off = depth[depth > 0] - 3.0
    assert off.std() == pytest.approx(float(model.sigma(3.0)), rel=0.02)
    assert abs(off.mean()) < 1e-4


def test_missing_returns_have_their_share_and_dark_surfaces_lose_more():
    eye = camera(width=320, height=240, focal=200.0, noise=NoiseModel(0.001))
    dark = replace(WALL, is_dark=True)
    share = [
        (render([eye], Moment(0.0, (wall,), {}), missing=0.05)[0].depth_m == 0).mean()
        for wall in (WALL, dark)
    ]
    assert share[0] == pytest.approx(0.05, abs=0.005)
    assert share[1] == pytest.approx(0.15, abs=0.01)


def test_flying_pixels_lie_between_both_sides_of_a_step_and_nowhere_else():
    eye = camera(width=160, height=120, focal=100.0, noise=NoiseModel(1e-5))
    sharp, flown = (render([eye], SCENE, missing=0.0, flying_pixels=share)[0].depth_m for share in (0.0, 1.0))
    changed = np.abs(sharp - flown) > 1e-3
    steps = np.zeros_like(changed)
    across, down = np.abs(np.diff(sharp, axis=1)) > 0.2, np.abs(np.diff(sharp, axis=0)) > 0.2
    steps[:, 1:] |= across
    steps[:, :-1] |= across
    steps[1:] |= down
    steps[:-1] |= down
    assert changed[steps].mean() > 0.9
    assert not changed[~steps & (np.abs(sharp - 3) < 1e-3)].any()
    assert flown[changed].min() > 1.5
    assert flown.max() < 3.01


def test_floor_seen_at_a_grazing_angle_has_no_flying_pixels():
    floor = Solid("floor", join([box((-90, 0.3, -90), (90, 1, 90))]), np.eye(4))
    eye = camera(noise=NoiseModel(1e-6))
    sharp, flown = (
        render([eye], Moment(0.0, (floor,), {}), flying_pixels=f, missing=0)[0].depth_m for f in (0, 1)
    )
    both = (sharp > 0) & (flown > 0) & (sharp < 10)
    assert both.sum() > 500
    assert np.abs(sharp - flown)[both].max() < 1e-4


def test_same_seed_and_time_leave_the_same_bits_whatever_the_threads_and_cameras(room):
    cameras = wall_cameras(5, width=80, height=60, noise=NOISE_PRESETS["tof"])
    with parallel.threads(1):
        first = render(cameras, room.at(2.0), seed=3)
    with parallel.threads(2):
        again = render(cameras[::-1], room.at(2.0), seed=3)[::-1]
    for a, b in zip(first, again, strict=True):
        assert a.camera == b.camera
        assert a.stamp_ns == 2_000_000_000
        assert (a.depth_m == b.depth_m).all()
    other = render(cameras[:1], room.at(2.0), seed=4)[0]
    assert (other.depth_m != first[0].depth_m).mean() > 0.5
    assert (render(cameras[:1], room.at(2.001), seed=3)[0].depth_m != first[0].depth_m).mean() > 0.5


def test_camera_without_noise_model_is_exact(room):
    eye = wall_cameras(1, width=40, height=30)[0]
    assert (render([eye], room.at(1.0))[0].depth_m == exact(eye, room.at(1.0))).all()


@pytest.mark.parametrize("distortion", [BARREL, RATIONAL])
def test_rays_of_a_distorted_camera_come_back_to_their_pixels(distortion):
    eye = camera(width=160, height=120, focal=100.0, distortion=distortion)
    rays = pixel_rays(eye)
    points = np.stack([rays.x, rays.y, np.ones_like(rays.x)], axis=-1).reshape(-1, 3).astype(float)
    matrix = np.array([[100.0, 0, 79.5], [0, 100.0, 59.5], [0, 0, 1]])
    pixels, _ = cv2.projectPoints(points, np.zeros(3), np.zeros(3), matrix, np.array(distortion))
    expected = np.stack(np.meshgrid(np.arange(160), np.arange(120)), axis=-1).reshape(-1, 2)
    assert np.abs(pixels[:, 0] - expected).max() < 1e-3


def test_lens_that_folds_back_in_the_image_is_refused():
    with pytest.raises(CameraError, match=r"camera eye.* folds back"):
        exact(camera(focal=20.0, distortion=(-0.5, 0.0, 0.0, 0.0, 0.0)), SCENE)


def test_impossible_share_and_seed_are_refused():
    with pytest.raises(InputError, match="seed is -1"):
        render([camera()], SCENE, seed=-1)
    with pytest.raises(InputError, match=r"missing is 1\.5"):
        render([camera()], SCENE, missing=1.5)
