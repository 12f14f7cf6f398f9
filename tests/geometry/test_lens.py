"""The lens: forward, its slopes, and back."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from elbowroom.errors import CameraError
from elbowroom.geometry import Intrinsics
from elbowroom.geometry.lens import directions, distorted, project, undistorted, usable_radius

LENSES = [
    Intrinsics(500, 510, 320, 240),
    Intrinsics(500, 510, 320, 240, (0.1, -0.05, 0.003, -0.002, 0.01)),
    Intrinsics(500, 510, 320, 240, (0.1, -0.05, 0.003, -0.002, 0.01, 0.02, -0.01, 0.003)),
]
BARREL = Intrinsics(500, 500, 320, 240, (-0.3, 0.0, 0.0, 0.0, 0.0))


@pytest.mark.parametrize("lens", LENSES, ids=["pinhole", "5", "8"])
def test_projection_goes_back_and_its_slopes_are_its_differences(lens):
    points = np.random.default_rng(0).uniform((-0.8, -0.6, 1), (0.8, 0.6, 3), (50, 3))
    pixels, slopes = project(lens, points)
    x, y = points[:, 0] / points[:, 2], points[:, 1] / points[:, 2]
    np.testing.assert_array_equal(pixels, np.stack(distorted(lens, x, y), axis=1))
    np.testing.assert_allclose(directions(lens, pixels), np.stack([x, y], axis=1), atol=1e-9)
    for axis in range(3):
        step = np.eye(3)[axis] * 1e-6
        plain = (project(lens, points + step)[0] - project(lens, points - step)[0]) / 2e-6
        np.testing.assert_allclose(slopes[:, :, axis], plain, rtol=1e-4, atol=1e-3)


@given(st.floats(-1.0, 1.0), st.floats(0.0, 6.3))
@settings(max_examples=60)
def test_within_the_usable_radius_every_direction_comes_back(share, angle):
    radius = 0.98 * share * usable_radius(BARREL, 2.0)
    x, y = radius * np.cos(angle), radius * np.sin(angle)
    u, v = distorted(BARREL, np.array([[x]]), np.array([[y]]))
    back_x, back_y = undistorted(BARREL, u, v)
    assert back_x.shape == (1, 1)
    assert (back_x[0, 0], back_y[0, 0]) == pytest.approx((x, y), abs=1e-8)


def test_without_distortion_directions_are_the_pinholes():
    lens, u, v = LENSES[0], np.array([320.0, 0.0]), np.array([240.0, 10.0])
    x, y = undistorted(lens, u, v)
    np.testing.assert_array_equal(x, (u - 320) / 500)
    np.testing.assert_array_equal(y, (v - 240) / 510)


def test_no_pixels_have_no_directions():
    assert directions(LENSES[1], np.zeros((0, 2))).shape == (0, 2)


@pytest.mark.parametrize("k1", [-2.0, -0.8])
def test_a_lens_that_has_no_direction_for_a_pixel_is_told(k1):
    lens = Intrinsics(500, 500, 320, 240, (k1, 0, 0, 0, 0))
    with pytest.raises(CameraError, match=r"camera north: .* folds back .* calibrate intrinsics"):
        directions(lens, np.array([[0.0, 0.0]]), "camera north")


def test_a_direction_beyond_the_turn_is_none():
    """A barrel that turns at 0.75 and grows again beyond 1.9: its pixels out there are those of the middle."""
    lens = Intrinsics(500, 500, 320, 240, (-0.74, 0.1, 0.0, 0.0, 0.0))
    turn = usable_radius(lens, 3.0)
    assert turn < 0.9
    u, _ = distorted(lens, np.linspace(0, turn, 100), np.zeros(100))
    with pytest.raises(CameraError, match="folds back"):
        undistorted(lens, np.array([u.max() + 20.0]), np.array([240.0]))


def test_nan_is_no_place_of_the_image():
    with pytest.raises(CameraError, match="folds back"):
        directions(BARREL, np.array([[np.nan, 10.0]]))
