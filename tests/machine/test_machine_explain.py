from dataclasses import replace

import numpy as np
import pytest
import trimesh
from hypothesis import assume, example, given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from elbowroom.errors import CameraError, FrameError, MachineError
from elbowroom.geometry import DepthCamera, Intrinsics, VoxelGrid, bits, parallel
from elbowroom.geometry.noise import NoiseModel
from elbowroom.machine import Machine, body_words, ceiling_c_arm, explain_frames
from elbowroom.machine.kernels.returns import least_from, most_to
from elbowroom.machine.rasterise import mesh_of, rasterise
from reference import machine_twins as naive

AT_REST = {"slide": 0.1, "elbow": 0.4, "grip": 0.02}
GRID = VoxelGrid.covering((-0.8, -0.7, -0.2), (1.0, 0.7, 1.4), 0.02)
VIEWS = [
    ((1.6, 0.5, 1.2), (0.1, 0, 0.5)),
    ((-1.0, 1.2, 0.3), (0.2, 0, 0.5)),
    ((0.2, 0.05, 2.0), (0.2, 0, 0.0)),
    # close enough for the body to reach behind the camera and out of the image
    ((0.3, -0.16, 0.6), (0.1, 0.2, 0.6)),
    ((0.1, 0.0, 0.16), (0.9, 0.1, 0.1)),
]


@pytest.fixture(scope="module")
def arm(tmp_path_factory):
    path = tmp_path_factory.mktemp("arm") / "arm.urdf"
    path.write_text(naive.ARM)
    return Machine.from_urdf(path, unchecked_links=("foot",))


def explain_one(machine, camera, depth, where=AT_REST, **more):
    return explain_frames(machine, [camera], [np.float32(depth)], [where], **more)


@pytest.mark.parametrize("kind", ["planar", "radial"])
@pytest.mark.parametrize("view", VIEWS)
def test_the_drawn_machine_is_what_rays_meet(arm, view, kind):
    camera = naive.camera_at(*view, depth_kind=kind)
    drawn = rasterise(arm, camera, AT_REST)
    cast, _ = naive.ray_cast(naive.triangles_in_world(arm, AT_REST), camera)
    both = np.isfinite(drawn) & np.isfinite(cast)
    assert both.sum() > 200
    # a ray along an edge may miss either way, or meet the next face
    assert (np.isfinite(drawn) != np.isfinite(cast)).sum() <= 2
    assert (np.abs(drawn[both] - cast[both]) > 1e-4).sum() <= 2


def test_links_whose_faces_turn_inwards_or_are_open_are_drawn_from_both_sides(tmp_path):
    box = trimesh.creation.box((0.6, 0.6, 0.6))
    inwards = trimesh.Trimesh(box.vertices, box.faces[:, ::-1], process=False)
    lidless = trimesh.Trimesh(box.vertices, box.faces[box.face_normals[:, 2] < 0.5], process=False)
    for name, mesh in (("inwards", inwards), ("lidless", lidless)):
        mesh.export(tmp_path / f"{name}.ply")
        path = tmp_path / f"{name}.urdf"
        path.write_text(
            f'<robot name="r"><link name="a"><collision><geometry><mesh filename="{name}.ply"/></geometry>'
            "</collision></link></robot>"
        )
        machine = Machine.from_urdf(path)
        assert not mesh_of(machine).closed.any()
        camera = naive.camera_at((0.9, 0.7, 1.5), (0, 0, 0))
        cast, _ = naive.ray_cast(naive.triangles_in_world(machine, {}), camera)
        drawn = rasterise(machine, camera, {})
        both = np.isfinite(drawn) & np.isfinite(cast)
        assert both.sum() > 500
        assert (np.abs(drawn[both] - cast[both]) > 1e-4).sum() <= 2


def test_a_machine_behind_the_camera_is_not_drawn(arm):
    camera = naive.camera_at((2, 0, 0.5), (4, 0, 0.5))
    assert np.isinf(rasterise(arm, camera, AT_REST)).all()


@pytest.mark.parametrize("view", VIEWS[:3])
def test_a_surface_behind_where_the_machine_is_said_to_be_is_never_the_machine(arm, view):
    """Seen past it everywhere, and not by single pixels: it is not there, and nothing is freed by it."""
    camera = naive.camera_at(*view, noise=NoiseModel(0.001, 0.002, 0.003, 0.5))
    drawn = rasterise(arm, camera, AT_REST)
    found = explain_one(arm, camera, np.full(drawn.shape, 4.0)).model_depth["north"]
    around = np.pad(np.isfinite(drawn), 1, constant_values=False)
    within = np.lib.stride_tricks.sliding_window_view(around, (3, 3)).all(axis=(2, 3))
    assert within.sum() > 100
    assert (np.abs(found[within]) < 1e-5).all()


@pytest.mark.parametrize("kind", ["planar", "radial"])
@pytest.mark.parametrize("noise", [None, NoiseModel(0.001, 0.002, 0.003, 0.5)])
@pytest.mark.parametrize("view", VIEWS)
def test_pixels_are_explained_as_one_by_one(arm, view, noise, kind):
    camera = naive.camera_at(*view, depth_kind=kind, noise=noise, min_depth_m=0.02, max_depth_m=1.9)
    drawn = rasterise(arm, camera, AT_REST)
    rng = np.random.default_rng(3)
    depth = np.where(np.isfinite(drawn), drawn, rng.uniform(0.3, 2.5, drawn.shape))
    depth = depth + rng.normal(0, 0.03, depth.shape) * (rng.uniform(size=depth.shape) < 0.5)
    depth = depth.astype(np.float32)
    lost = rng.integers(0, 12, depth.shape)
    for number, value in enumerate((0.0, np.nan, np.inf, -1.0)):
        depth[lost == number] = value
    expected = naive.explain(drawn, depth, camera, 0.01, 3.0)
    found = explain_one(arm, camera, depth, tolerance_sigmas=3.0).model_depth["north"]
    assert (expected > 0).sum() > 100
    # only what lies on the very edge of the tolerance may differ
    assert ((found > 0) != (expected > 0)).sum() <= 1
    # specks amid what is explained or farther, and what is not explained
    assert ((found < -1e-5) != (expected < -1e-5)).sum() <= 1
    assert ((found < 0) != (expected < 0)).sum() <= 1
    both = (found > 0) & (expected > 0)
    assert np.allclose(found[both], expected[both], rtol=1e-6)


@given(st.floats(0, 1e7))
def test_limits_are_the_float32_numbers_next_to_them(bound):
    """So that a float32 depth is compared with them as with the limits themselves."""
    low, high = np.float32(least_from(bound)), np.float32(most_to(bound))
    assert float(np.nextafter(low, np.float32(-1))) < bound <= float(low)
    assert float(high) <= bound < float(np.nextafter(high, np.float32(2e7)))


@pytest.mark.parametrize("kind", ["planar", "radial"])
def test_the_body_alone_leaves_nothing_unexplained(arm, kind):
    cameras = [naive.camera_at(*view, name=str(n), depth_kind=kind) for n, view in enumerate(VIEWS)]
    triangles = naive.triangles_in_world(arm, AT_REST)
    depths = [np.float32(naive.ray_cast(triangles, camera)[0]) for camera in cameras]
    explained = explain_frames(arm, cameras, depths, [AT_REST] * len(cameras), grid=GRID)
    for camera, depth in zip(cameras, depths, strict=True):
        assert (explained.model_depth[camera.name][np.isfinite(depth)] > 0).all()
    assert not explained.unexplained_words.any()


def test_a_ray_is_free_no_farther_than_the_body_may_begin(arm):
    camera = naive.camera_at(*VIEWS[0])
    drawn = rasterise(arm, camera, AT_REST)
    found = explain_one(arm, camera, np.where(np.isfinite(drawn), drawn, 0)).model_depth["north"]
    assert (found[np.isfinite(drawn)] <= drawn[np.isfinite(drawn)]).all()
    assert (found[np.isinf(drawn)] == 0).all()


def hand_before(machine, where, camera, pixel, gap_m, size=(0.08, 0.08, 0.04)):
    """Triangles of a box whose back is gap_m before the machine's surface at a pixel, facing the camera."""
    drawn, _ = naive.ray_cast(naive.triangles_in_world(machine, where), camera)
    centre = camera.points_in_world(np.where(np.isfinite(drawn), drawn, 1.0))[pixel]
    towards = camera.centre_in_world - centre
    hand = trimesh.creation.box(size)
    turned = trimesh.geometry.align_vectors([0, 0, 1], towards)[:3, :3]
    middle = centre + towards / np.linalg.norm(towards) * (gap_m + size[2] / 2)
    return hand.triangles @ turned.T + middle


@settings(max_examples=12)
@given(st.integers(0, 10**6), st.sampled_from([0.0, 0.01]), st.sampled_from(["planar", "radial"]))
@example(691, 0.0, "planar")
def test_a_hand_on_the_body_or_a_centimetre_off_is_never_explained_away(arm, draw, gap_m, kind):
    centre = np.array([0.1, 0, 0.5]) + 2.0 * np.array([np.cos(draw), np.sin(draw), 0.2])
    camera = naive.camera_at(centre, (0.1, 0, 0.5), width=320, height=240, focal=320.0, depth_kind=kind)
    drawn = rasterise(arm, camera, AT_REST)
    seen = np.argwhere(np.isfinite(drawn))
    hand = hand_before(arm, AT_REST, camera, tuple(seen[draw % len(seen)]), gap_m)
    triangles = np.concatenate([naive.triangles_in_world(arm, AT_REST), hand])
    depth, hit = naive.ray_cast(triangles, camera)
    explained = explain_one(arm, camera, depth, grid=GRID)
    # the front of the hand is farther from the body than the tolerance
    of_hand = hit >= len(triangles) - len(hand)
    front = of_hand & (depth < drawn - 0.011)
    about = np.stack([np.roll(drawn, (i, j), (0, 1)) for i in (-1, 0, 1) for j in (-1, 0, 1)]).min(axis=0)
    front &= depth < about - 0.011
    # one that stands alone says nothing of the body's voxels
    beside = sum(np.roll(front, (i, j), (0, 1)) for i in (-1, 0, 1) for j in (-1, 0, 1)) - front
    front &= beside > 0
    # at the rim of the body, a small hand may show too little of its front
    assume(front.sum() > 20)
    assert (explained.model_depth["north"][front] <= 0).all()
    kept = bits.unpack(explained.unexplained_words, GRID)
    body = bits.unpack(body_words(arm, AT_REST, GRID), GRID)
    voxels = naive.unexplained_voxels(camera, np.where(front, depth, 0), np.zeros_like(depth), GRID)
    assert (kept | ~(voxels & body)).all()
    assert (kept & voxels).any() or not voxels.any()


@pytest.mark.parametrize("roll", [0.0, np.pi / 2])
def test_voxels_of_unexplained_returns_are_those_of_the_pixels_cubes(arm, roll):
    """With rows of pixels level and upright: neighbours may differ in one axis alone."""
    camera = naive.camera_at(*VIEWS[0])
    about_axis = Rotation.from_rotvec([0.0, 0.0, roll]).as_matrix()
    pose = camera.world_from_camera.copy()
    pose[:3, :3] = pose[:3, :3] @ about_axis
    camera = replace(camera, world_from_camera=pose)
    drawn, _ = naive.ray_cast(naive.triangles_in_world(arm, AT_REST), camera)
    depth = np.where(np.isfinite(drawn), drawn - 0.05, 3.0).astype(np.float32)
    explained = explain_one(arm, camera, depth, grid=GRID)
    kept = bits.unpack(explained.unexplained_words, GRID)
    near = np.where(depth < 3, depth, 0)
    assert not (naive.unexplained_voxels(camera, depth, explained.model_depth["north"], GRID) & ~kept).any()
    # and no voxel farther than half a pixel from any of these points
    points = camera.points_in_world(np.where(near > 0, depth, 1.0))[near > 0]
    half = 0.5 * near[near > 0] / min(camera.intrinsics.fx, camera.intrinsics.fy)
    for voxel in np.argwhere(kept)[::7]:
        lower = GRID.lower_m + voxel * GRID.voxel_size_m
        away = np.maximum(np.maximum(lower - points, points - lower - GRID.voxel_size_m), 0).max(axis=1)
        assert (away <= half + 1e-6).any()


def test_a_noisy_return_is_kept_along_its_ray(arm):
    exact, noisy = (naive.camera_at(*VIEWS[0], noise=noise) for noise in (None, NoiseModel(constant_m=0.02)))
    drawn, _ = naive.ray_cast(naive.triangles_in_world(arm, AT_REST), exact)
    depth = np.where(np.isfinite(drawn), drawn - 0.15, 0)
    few, many = (
        bits.unpack(explain_one(arm, c, depth, grid=GRID, tolerance_sigmas=0).unexplained_words, GRID)
        for c in (exact, noisy)
    )
    assert (many | ~few).all()
    assert many.sum() > 1.5 * few.sum()


def test_threads_and_cameras_looking_away_change_nothing(arm):
    cameras = [naive.camera_at(*view, name=str(n)) for n, view in enumerate(VIEWS[:3])]
    cameras.append(naive.camera_at((2, 0, 0.5), (4, 0, 0.5), name="away", width=90, height=70))
    rng = np.random.default_rng(5)
    depths = [np.float32(rng.uniform(0.3, 2, (c.height, c.width))) for c in cameras]
    where = [{**AT_REST, "slide": s} for s in (0.0, 0.1, 0.2, 0.3)]
    with parallel.threads(1):
        one = explain_frames(arm, cameras, depths, where, grid=GRID)
    with parallel.threads(3):
        many = explain_frames(arm, cameras, depths, where, grid=GRID)
    assert np.array_equal(one.unexplained_words, many.unexplained_words)
    for n, camera in enumerate(cameras):
        alone = explain_frames(arm, [camera], [depths[n]], [where[n]])
        assert np.array_equal(one.model_depth[camera.name], many.model_depth[camera.name])
        assert np.array_equal(one.model_depth[camera.name], alone.model_depth[camera.name])
    assert not one.model_depth["away"].any()
    assert alone.unexplained_words is None


def test_the_shipped_c_arm_is_explained_by_cameras_about_it():
    machine = ceiling_c_arm()
    where = {"long": 0.2, "larm": 0.3, "propeller": -0.4, "carc": 0.2}
    grid = VoxelGrid.covering((-2, -2, 0), (2, 2, 2.5), 0.05)
    cameras = [
        naive.camera_at((2 * np.cos(a), 2 * np.sin(a), 2.4), (0, 0, 1), name=str(a)) for a in (0.3, 2.2, 4.1)
    ]
    triangles = naive.triangles_in_world(machine, where)
    depths = [np.float32(naive.ray_cast(triangles, camera)[0]) for camera in cameras]
    explained = explain_frames(machine, cameras, depths, [where] * 3, grid=grid)
    assert not explained.unexplained_words.any()
    assert all((explained.model_depth[c.name] > 0).mean() > 0.03 for c in cameras)


def test_images_and_cameras_that_do_not_fit_are_refused(arm):
    camera = naive.camera_at(*VIEWS[0])
    depth = np.ones((camera.height, camera.width), dtype=np.float32)
    with pytest.raises(FrameError, match=r"shape \(3, 4\), the camera delivers \(120, 160\)"):
        explain_one(arm, camera, np.ones((3, 4)))
    with pytest.raises(FrameError, match="as many of each"):
        explain_frames(arm, [camera], [depth], [])
    with pytest.raises(MachineError, match="tolerance"):
        explain_one(arm, camera, depth, tolerance_m=-1.0)
    with pytest.raises(MachineError, match="out of its limits"):
        explain_one(arm, camera, depth, {**AT_REST, "slide": 2.0})
    bent = DepthCamera("bent", 160, 120, np.eye(4), Intrinsics(90, 90, 80, 60, (0.1, 0, 0, 0, 0)))
    with pytest.raises(CameraError, match="camera bent: has distortion"):
        explain_one(arm, bent, depth)
    empty = explain_frames(arm, [], [], [], grid=GRID)
    assert empty.model_depth == {}
    assert not empty.unexplained_words.any()
