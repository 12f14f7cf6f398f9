"""What a covariance makes of the margin: no displacement is ever more."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from elbowroom.calibrate.lens import project
from elbowroom.calibrate.margin import pose_margin
from elbowroom.calibrate.rigid import exp
from elbowroom.errors import CalibrationError
from elbowroom.evaluate.board_views import ring
from elbowroom.sensing import Margin

CAMERA = ring(1)[0]


def covariance(seed: int, turn: float = 5e-4, way: float = 1e-3):
    random = np.random.default_rng(seed)
    root = random.normal(0, 1, (6, 6)) * np.array([turn] * 3 + [way] * 3)[:, None] / np.sqrt(6)
    return root @ root.T


@given(
    st.integers(0, 1000),
    st.floats(0, CAMERA.width - 1),
    st.floats(0, CAMERA.height - 1),
    st.floats(1.0, 8.0),
    st.sampled_from(["planar", "radial"]),
)
@settings(max_examples=150, deadline=None)
def test_errors_within_the_region_stay_within_the_margin(seed, u, v, depth, kind):
    camera = replace(CAMERA, depth_kind=kind)
    stated = covariance(seed)
    margin = pose_margin(camera, stated, confidence=0.95)
    # the worst errors lie on the border of the region: k root d with |d| = 1
    direction = np.random.default_rng(seed + 1).normal(0, 1, 6)
    values, vectors = np.linalg.eigh(stated)
    root = vectors * np.sqrt(np.maximum(values, 0))
    error = 3.5485 * root @ (direction / np.linalg.norm(direction))
    k = camera.intrinsics
    point = np.array([(u - k.cx) / k.fx, (v - k.cy) / k.fy, 1.0]) * depth
    off = exp(error) @ np.append(point, 1.0)
    pixel = project(k, off[None, :3])[0][0]
    moved = off[2] - depth if kind == "planar" else np.linalg.norm(off[:3]) - np.linalg.norm(point)
    range_m = depth if kind == "planar" else np.linalg.norm(point)
    assert np.abs(pixel - (u, v)).max() <= margin.lateral_px * 1.01 + 1e-9
    assert abs(moved) <= (margin.bias_m + margin.range_linear * range_m) * 1.01 + 1e-9


def test_nothing_unknown_is_no_margin():
    found = pose_margin(CAMERA, np.zeros((6, 6)))
    assert (found.lateral_px, found.bias_m, found.range_linear) == (0, 0, 0)


def test_more_confidence_is_more_margin_and_twice_the_error_twice_the_margin():
    narrow, wide = (pose_margin(CAMERA, covariance(3), confidence=share) for share in (0.9, 0.99))
    doubled = pose_margin(CAMERA, 4 * covariance(3), confidence=0.9)
    assert wide.lateral_px > narrow.lateral_px
    assert wide.bias_m > narrow.bias_m
    assert doubled.lateral_px == pytest.approx(2 * narrow.lateral_px)
    assert doubled.range_linear == pytest.approx(2 * narrow.range_linear)


def test_the_sensor_s_margin_is_added_to():
    margin = pose_margin(CAMERA, covariance(3)).over(
        Margin(sigmas=4, bias_m=0.01, lateral_px=0.5, range_quadratic=0.002)
    )
    alone = pose_margin(CAMERA, covariance(3))
    assert margin.sigmas == 4
    assert margin.range_quadratic == 0.002
    assert margin.bias_m == pytest.approx(0.01 + alone.bias_m)
    assert margin.lateral_px == pytest.approx(0.5 + alone.lateral_px)


@pytest.mark.parametrize("confidence", [0.3, 1.0, float("nan")])
def test_a_confidence_that_is_none_is_refused(confidence):
    with pytest.raises(CalibrationError, match="confidence"):
        pose_margin(CAMERA, covariance(3), confidence=confidence)
