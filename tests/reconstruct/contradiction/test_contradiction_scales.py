"""Focal lengths and depths that are off by a tenth or more, of all cameras or of one, are told; right ones are not."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from elbowroom.geometry.twist import exp
from elbowroom.reconstruct.contradiction.findings import contradictions
from elbowroom.reconstruct.contradiction.scales import KIND, misfit, scale_findings
from elbowroom.reconstruct.contradiction.views import Views
from elbowroom.sensing import NOISE_PRESETS
from reference.contradiction_room import MARGIN, room_cameras, room_site

RIGHT = {name: room_site(room_cameras(NOISE_PRESETS.get(name))) for name in ("exact", "realsense_d435")}


def zoomed(camera, factor):
    k = camera.intrinsics
    return replace(camera, intrinsics=replace(k, fx=k.fx * factor, fy=k.fy * factor))


def said(cameras, frames, margin=MARGIN):
    return scale_findings(Views.of(cameras, frames, margin))


@pytest.mark.parametrize("noise", RIGHT)
@pytest.mark.parametrize("factor", (1.15, 1.25, 0.8))
def test_focal_lengths_of_all_are_told_with_their_factor(noise, factor):
    site = RIGHT[noise]
    (found,) = said([zoomed(camera, factor) for camera in site.cameras], site.snapshot.frames)
    words = f"focal lengths look {max(factor, 1 / factor):.1f}"
    assert found.kind == KIND and found.stops and len(found.about) == 4
    assert words in found.text and ("too long" if factor > 1 else "too short") in found.text


def test_of_one_camera_it_is_that_one_that_is_named():
    site = RIGHT["exact"]
    cameras = [zoomed(c, 1.2) if c.name == "sw" else c for c in site.cameras]
    (found,) = said(cameras, site.snapshot.frames)
    assert found.about == ("sw",) and found.stops


def test_depths_in_a_unit_a_fifth_off_are_told_as_depths():
    site = RIGHT["exact"]
    frames = [replace(frame, depth_m=frame.depth_m * np.float32(0.8)) for frame in site.snapshot.frames]
    (found,) = said(site.cameras, frames)
    assert "depths look 1.2" in found.text and "too small" in found.text and found.stops


@settings(max_examples=15)
@given(st.sampled_from(sorted(RIGHT)), st.integers(0, 10_000), st.floats(0.97, 1.03))
def test_what_a_calibration_leaves_open_is_not_told(noise, seed, factor):
    rng, site = np.random.default_rng(seed), RIGHT[noise]
    off = [np.concatenate([rng.normal(0, 0.003, 3), rng.normal(0, 0.006, 3)]) for _ in site.cameras]
    cameras = [
        replace(zoomed(camera, factor), world_from_camera=camera.world_from_camera @ exp(twist))
        for camera, twist in zip(site.cameras, off, strict=True)
    ]
    assert said(cameras, site.snapshot.frames) == ()


def test_it_is_one_of_the_looks_and_says_nothing_where_a_mistake_is_named():
    site = RIGHT["exact"]
    longer = [zoomed(camera, 1.2) for camera in site.cameras]
    assert [f.kind for f in contradictions(longer, site.snapshot.frames, MARGIN)] == [KIND]
    twice = [zoomed(camera, 2.0) for camera in site.cameras]
    assert KIND not in [f.kind for f in contradictions(twice, site.snapshot.frames, MARGIN)][:-1]


def test_surfaces_that_are_the_same_lie_on_each_other_and_one_camera_has_none_to_compare():
    views = Views.of(RIGHT["exact"].cameras, RIGHT["exact"].snapshot.frames, MARGIN)
    right = misfit(views, dict(enumerate(views.eyes)))
    wrong = misfit(views, {n: replace(eye, scale=1.2) for n, eye in enumerate(views.eyes)})
    assert 2 * right.mean < wrong.mean and right.places > 500
    assert said(RIGHT["exact"].cameras[:1], RIGHT["exact"].snapshot.frames[:1]) == ()


def test_a_squeezed_image_is_told_by_its_side_and_not_by_a_pose_of_some_cameras():
    site = RIGHT["exact"]
    wide = [replace(c, intrinsics=replace(c.intrinsics, fx=c.intrinsics.fx * 1.2)) for c in site.cameras]
    (found,) = contradictions(wide, site.snapshot.frames, MARGIN)
    assert found.kind == KIND and "fx looks 1.19 times" in found.text and "too long" in found.text


def test_poses_in_feet_are_told_as_such():
    site = RIGHT["exact"]
    feet = []
    for camera in site.cameras:
        pose = camera.world_from_camera.copy()
        pose[:3, 3] /= 0.3048
        feet.append(replace(camera, world_from_camera=pose))
    (found,) = contradictions(feet, site.snapshot.frames, MARGIN)
    assert found.stops and "in feet" in found.text
