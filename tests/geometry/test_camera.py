import cv2
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from elbowroom.errors import CameraError
from elbowroom.geometry import DepthCamera, Intrinsics
from elbowroom.geometry.margin import Margin
from elbowroom.geometry.noise import NOISE_PRESETS, NoiseModel


def camera_with(**changes):
    pose = np.eye(4)
    pose[:3, :3] = Rotation.from_euler("xyz", (0.3, -0.7, 1.1)).as_matrix()
    pose[:3, 3] = (0.5, -1.0, 2.0)
    given = {
        "name": "north",
        "width": 32,
        "height": 24,
        "world_from_camera": pose,
        "intrinsics": Intrinsics(fx=20.0, fy=21.0, cx=15.0, cy=12.5),
    }
    return DepthCamera(**(given | changes))


@pytest.mark.parametrize("kind", ["planar", "radial"])
def test_measured_points_project_back_to_their_pixels_at_their_depth(kind):
    camera = camera_with(depth_kind=kind)
    depth = np.random.default_rng(1).uniform(0.5, 4, (24, 32))
    points = camera.points_in_world(depth)
    in_camera = (points - camera.centre_in_world) @ camera.world_from_camera[:3, :3]
    u = 20.0 * in_camera[..., 0] / in_camera[..., 2] + 15.0
    v = 21.0 * in_camera[..., 1] / in_camera[..., 2] + 12.5
    np.testing.assert_allclose(u, np.broadcast_to(np.arange(32), u.shape), atol=1e-9)
    np.testing.assert_allclose(v, np.broadcast_to(np.arange(24)[:, None], v.shape), atol=1e-9)
    measured = in_camera[..., 2] if kind == "planar" else np.linalg.norm(in_camera, axis=-1)
    np.testing.assert_allclose(measured, depth, atol=1e-9)


def test_axes_are_opencvs():
    """x right, y down, z forward: OpenCV puts the same points into the same pixels."""
    camera = camera_with()
    points = camera.points_in_world(np.full((24, 32), 2.0)).reshape(-1, 3)
    rotation, _ = cv2.Rodrigues(camera.camera_from_world[:3, :3])
    matrix = np.array([[20.0, 0, 15], [0, 21, 12.5], [0, 0, 1]])
    pixels, _ = cv2.projectPoints(points, rotation, camera.camera_from_world[:3, 3], matrix, None)
    u, v = np.meshgrid(np.arange(32), np.arange(24))
    np.testing.assert_allclose(pixels[:, 0], np.stack([u, v], axis=-1).reshape(-1, 2), atol=1e-6)


def test_a_camera_cannot_be_changed():
    camera = camera_with()
    with pytest.raises(ValueError, match="read-only"):
        camera.world_from_camera[0, 3] = 0
    with pytest.raises(AttributeError):
        camera.width = 3


def test_the_givers_pose_stays_writable():
    pose = np.eye(4)
    camera_with(world_from_camera=pose)
    pose[0, 3] = 1.0
    assert pose[0, 3] == 1.0


def test_flying_pixels_come_with_noise_unless_said():
    assert camera_with().flying_pixels is False
    assert camera_with(noise=NoiseModel(0.001)).flying_pixels is True
    assert camera_with(noise=NoiseModel(0.001), flying_pixels=False).flying_pixels is False
    assert camera_with(flying_pixels=True).flying_pixels is True


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"name": ""}, "name is ''"),
        ({"name": "../north"}, "without slashes"),
        ({"width": 0}, "width is 0"),
        ({"height": 100_000}, "height is 100000, must be 1 to 16384"),
        ({"width": 1.5}, "width is 1.5"),
        ({"depth_kind": "orthogonal"}, "allowed are planar, radial"),
        ({"min_depth_m": 2.0, "max_depth_m": 1.0}, "is no range"),
        ({"min_depth_m": float("nan")}, "is no range"),
        ({"world_from_camera": np.full((4, 4), np.nan)}, "camera north: world_from_camera: contains NaN"),
        ({"world_from_camera": 2 * np.eye(4)}, "last row"),
    ],
)
def test_what_no_camera_can_be_is_refused(changes, message):
    with pytest.raises(CameraError, match=message):
        camera_with(**changes)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"fx": 0.0}, "fx is 0.0, must be a finite number of pixels above 0"),
        ({"fy": -1.0}, "fy is -1.0"),
        ({"fx": float("nan")}, "fx is nan"),
        ({"cx": float("inf")}, "must be finite"),
        ({"distortion": (0.1, 0.2)}, "2 distortion coefficients, allowed are none"),
        ({"distortion": (float("nan"),) * 5}, "must be finite"),
    ],
)
def test_intrinsics_that_no_lens_has_are_refused(changes, message):
    with pytest.raises(CameraError, match=message):
        Intrinsics(**({"fx": 1.0, "fy": 1.0, "cx": 0.0, "cy": 0.0} | changes))


def test_a_camera_matrix_with_skew_is_refused():
    matrix = np.array([[500.0, 0, 320], [0, 510, 240], [0, 0, 1]])
    assert Intrinsics.from_matrix(matrix) == Intrinsics(500.0, 510.0, 320.0, 240.0)
    matrix[0, 1] = 3.0
    with pytest.raises(CameraError, match="camera matrix: expected"):
        Intrinsics.from_matrix(matrix)


@given(
    model=st.one_of(
        st.sampled_from(list(NOISE_PRESETS.values())),
        st.builds(NoiseModel, *(st.floats(0, 1) for _ in range(4))),
    ),
    near=st.floats(0, 20),
    farther=st.floats(0, 20),
)
def test_noise_never_falls_with_depth(model, near, farther):
    assert 0 <= model.sigma(near) <= model.sigma(near + farther)


def test_presets_give_the_published_figures():
    """Millimetres at metres, as docs/safety.md lists them."""
    assert NOISE_PRESETS["kinect_v1"].sigma(0.4) == pytest.approx(0.0012)
    np.testing.assert_allclose(
        NOISE_PRESETS["realsense_d435"].sigma(np.array([2, 3, 4])), [0.015, 0.034, 0.060], atol=1e-3
    )
    np.testing.assert_allclose(
        NOISE_PRESETS["realsense_d455"].sigma(np.array([2, 3, 4])), [0.008, 0.019, 0.034], atol=1e-3
    )


@pytest.mark.parametrize("name", ["sigmas", "bias_m", "lateral_px", "range_linear", "range_quadratic"])
@pytest.mark.parametrize("value", [-0.1, float("nan"), float("inf")])
def test_a_margin_below_zero_is_refused(name, value):
    with pytest.raises(CameraError, match=f"margin: {name} is"):
        Margin(**{name: value})


@pytest.mark.parametrize("name", ["constant_m", "linear", "quadratic", "offset_m"])
@pytest.mark.parametrize("value", [-0.1, float("nan"), float("inf")])
def test_noise_below_zero_is_refused(name, value):
    with pytest.raises(CameraError, match=f"noise: {name} is"):
        NoiseModel(**({"constant_m": 0.0} | {name: value}))
