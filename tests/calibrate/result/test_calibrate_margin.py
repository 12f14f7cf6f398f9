"""What a covariance makes of the margin: no displacement is ever more."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.stats import chi2, norm

from elbowroom.calibrate.result.margin import is_within, pose_margin
from elbowroom.errors import CalibrationError
from elbowroom.evaluate.calibrating.board_views import ring
from elbowroom.geometry.lens import project
from elbowroom.geometry.twist import exp
from elbowroom.sensing import Margin

CAMERA = ring(1)[0]


def covariance(seed: int, turn: float = 5e-4, way: float = 1e-3):
    random = np.random.default_rng(seed)
    root = random.normal(0, 1, (6, 6)) * np.array([turn] * 3 + [way] * 3)[:, None] / np.sqrt(6)
    return root @ root.T


def displaced(camera, error, margin):
    """The greatest displacement over its bound, by moving points and projecting them."""
    k = camera.intrinsics
    places = [(u, v, z) for u in (0, 0.5, 1) for v in (0, 0.5, 1) for z in (1.0, 2.0, 6.0)]
    worst = 0.0
    for share_u, share_v, depth in places:
        u, v = share_u * camera.width - 0.5, share_v * camera.height - 0.5
        point = np.array([(u - k.cx) / k.fx, (v - k.cy) / k.fy, 1.0]) * depth
        off = (exp(error) @ np.append(point, 1.0))[:3]
        pixel = project(k, off[None])[0][0]
        planar = camera.depth_kind == "planar"
        moved = off[2] - depth if planar else np.linalg.norm(off) - np.linalg.norm(point)
        along = margin.bias_m + margin.range_linear * (depth if planar else np.linalg.norm(point))
        worst = max(worst, np.abs(pixel - (u, v)).max() / margin.lateral_px, abs(moved) / along)
    return worst


@pytest.mark.parametrize("kind", ["planar", "radial"])
@pytest.mark.parametrize("seed", range(2))
def test_the_stated_share_of_errors_displaces_nothing_by_more_than_the_margin(seed, kind):
    camera = replace(CAMERA, depth_kind=kind)
    stated = covariance(seed)
    margin = pose_margin(camera, stated, confidence=0.95)
    random = np.random.default_rng(seed + 100)
    errors = random.multivariate_normal(np.zeros(6), stated, 2000)
    held = np.mean([displaced(camera, error, margin) <= 1.005 for error in errors[:400]])
    # 400 draws: three sigmas of the share are 3.3 %; points are fewer than the margin's
    assert 0.917 <= held <= 0.99
    linear = np.mean([is_within(camera, error, margin) for error in errors])
    # 2000 draws: three sigmas of the share are 1.5 %
    assert linear == pytest.approx(0.95, abs=0.015)


@given(st.integers(0, 1000), st.sampled_from([0.5, 0.9, 0.95, 0.99, 0.9999]))
@settings(max_examples=60)
def test_no_margin_exceeds_that_of_any_linear_function(seed, confidence):
    stated = covariance(seed)
    found = pose_margin(CAMERA, stated, confidence=confidence)
    # bias: planar depth changes by t_z alone
    sigmas = found.bias_m / np.sqrt(stated[5, 5])
    assert sigmas <= np.sqrt(chi2.ppf(confidence, 6)) * (1 + 1e-9)
    assert sigmas >= norm.ppf((1 + confidence) / 2) * 0.999


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
