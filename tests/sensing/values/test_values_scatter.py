"""How much depths scatter is measured, and held against the margin that the site trusts them to."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from elbowroom.geometry.margin import Margin
from elbowroom.geometry.noise import NoiseModel
from elbowroom.sensing import DepthFrame
from elbowroom.sensing.values import thinned
from elbowroom.sensing.values.scatter import look_at_scatter, scatter_of
from reference import values_room as room

ROOM = {camera.name: room.depth_of(camera) for camera in room.cameras()}


def frames(noise, seed=0):
    random = np.random.default_rng(seed)
    return [
        DepthFrame(
            name, 0, (depth + noise.sigma(depth) * random.standard_normal(depth.shape)).astype(np.float32)
        )
        for name, depth in ROOM.items()
    ]


@settings(max_examples=12)
@given(st.floats(0.003, 0.06), st.floats(0.0, 0.006), st.integers(0, 99))
def test_the_scatter_of_a_room_is_measured_within_a_third(constant_m, quadratic, seed):
    noise = NoiseModel(constant_m, 0.0, quadratic)
    for camera, frame in zip(room.cameras(), frames(noise, seed), strict=True):
        sigma_m, at_m = scatter_of(thinned(camera, frame))
        assert sigma_m == pytest.approx(float(noise.sigma(at_m)), rel=0.34)


@settings(max_examples=12)
@given(st.floats(0.0, 0.05), st.floats(0.0, 0.006))
def test_noise_that_is_declared_or_within_the_margin_is_passed_in_silence(constant_m, quadratic):
    noise = NoiseModel(constant_m, 0.0, quadratic)
    seen = frames(noise)
    assert look_at_scatter(room.cameras(noise=noise), seen, Margin()) == ()
    assert look_at_scatter(room.cameras(), seen, Margin(bias_m=0.3)) == ()
    assert look_at_scatter(room.cameras(margin=Margin(bias_m=0.3)), seen, Margin()) == ()


def test_noise_that_nobody_declared_is_a_warning_of_all_cameras_with_its_size():
    (found,) = look_at_scatter(room.cameras(), frames(NoiseModel(0.02)), Margin())
    assert (found.kind, found.stops, len(found.about)) == ("noise", False, 4)
    assert "trusted to 0 mm" in found.text and "noise:" in found.text and "\n" not in found.text
    assert any(f"scatter by {mm} mm" in found.text for mm in (18, 19, 20, 21, 22))


def test_sigmas_of_none_leave_noise_unanswered():
    noise = NoiseModel(0.02)
    assert look_at_scatter(room.cameras(noise=noise), frames(noise), Margin(sigmas=0.0))


def test_exact_images_whole_millimetres_and_images_without_returns_are_passed_in_silence():
    exact = [DepthFrame(name, 0, depth) for name, depth in ROOM.items()]
    whole = [
        DepthFrame(name, 0, np.rint(depth * 1000).astype(np.float32) / 1000) for name, depth in ROOM.items()
    ]
    nothing = [DepthFrame(name, 0, np.zeros_like(depth)) for name, depth in ROOM.items()]
    for seen in (exact, whole, nothing):
        assert look_at_scatter(room.cameras(), seen, Margin()) == ()
