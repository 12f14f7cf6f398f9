"""Planes of depth points, the graph's parts, pictures: each beside something plain."""

import numpy as np
import pytest

from elbowroom.calibrate.boards.seen_plane import rays_of, seen_plane
from elbowroom.calibrate.extrinsics.disagreement import unseen_parts
from elbowroom.calibrate.pages.pictures import camera_graph, coverage, histogram, reprojection
from elbowroom.calibrate.result.change import pose_difference
from elbowroom.evaluate.calibrating.board_views import ring
from elbowroom.geometry import invert_rigid
from elbowroom.geometry.twist import exp


def test_pose_difference_is_that_of_the_motion():
    pose = exp(np.array([0.3, 0.2, -0.5, 1, 2, 3]))
    moved, turned = pose_difference(pose, pose @ exp(np.array([0, 0.01, 0, 0, 0, 0])))
    assert (moved, turned) == pytest.approx((0, 0.01), abs=1e-9)
    moved, turned = pose_difference(pose, exp(np.array([0, 0, 0, 0.3, 0, 0.4])) @ pose)
    assert (moved, turned) == pytest.approx((0.5, 0), abs=1e-9)


@pytest.mark.parametrize("kind", ["planar", "radial"])
def test_a_plane_is_found_in_spite_of_flying_pixels(kind):
    camera = ring(1, depth_kind=kind)[0]
    random = np.random.default_rng(2)
    pixels = random.uniform((200, 150), (420, 320), (800, 2))
    m = np.array([0.1, -0.2, 0.5])
    depth = 1 / (rays_of(camera, pixels) @ m)
    measured = depth + random.normal(0, 1, 800) * camera.noise.sigma(depth)
    measured[:60] += random.uniform(0.1, 1.0, 60)
    found = seen_plane(camera, pixels, measured)
    off = found.root @ (found.m - m)
    assert off @ off < 25
    # an offset and a scale error of depth move the plane as they are said to
    more = seen_plane(camera, pixels, measured + 1e-4)
    np.testing.assert_allclose((more.m - found.m) / 1e-4, found.by_bias, rtol=0.02, atol=2e-3)
    more = seen_plane(camera, pixels, measured * 1.0001)
    np.testing.assert_allclose((more.m - found.m) / 1e-4, found.by_scale, rtol=0.02, atol=2e-3)


def test_points_in_a_line_or_too_few_are_no_plane():
    camera = ring(1)[0]
    line = np.stack([np.linspace(100, 400, 40), np.full(40, 200.0)], axis=1)
    assert seen_plane(camera, line, np.full(40, 2.0)) is None
    assert seen_plane(camera, line[:5], np.full(5, 2.0)) is None


def test_unseen_parts_are_named():
    assert unseen_parts(90, 60, [np.array([[45.0, 30.0]])])[0] == "upper left"
    everywhere = np.array([(u, v) for u in (10.0, 45.0, 80.0) for v in (10.0, 30.0, 50.0)])
    assert unseen_parts(90, 60, [everywhere]) == []
    assert unseen_parts(90, 60, [everywhere[:-1]]) == ["lower right"]


def test_pictures_are_pictures():
    corners = np.random.default_rng(0).uniform(20, 60, (12, 2))
    grey = np.full((80, 100), 90, dtype=np.uint8)
    at = {"a": np.array([0.0, 0, 2]), "b": np.array([2.0, 1, 2])}
    for png in (
        reprojection(grey, corners, corners + 0.3),
        coverage(100, 80, [corners]),
        camera_graph(at, [np.zeros(3)], {("a", "b"): 3}, ["b"]),
        histogram(np.random.default_rng(0).normal(0, 1, 100), "px"),
    ):
        assert png.startswith(b"\x89PNG")
    assert invert_rigid(np.eye(4)).shape == (4, 4)
