"""What the cameras can resolve is never free: balls of at least three pixel pitches radius at their range."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from elbowroom.geometry import VoxelGrid
from elbowroom.geometry.margin import Margin
from elbowroom.reconstruct import reconstruct
from elbowroom.sensing import DepthFrame
from reference import reconstruct_scenes as scenes

SAGITTA_PX = 0.1
"""Between four rays the front of such a ball lies at most this far, in pixel pitches, before where they meet it."""


def pitch_of(camera, point):
    """How far apart neighbouring rays are at a point [m]."""
    lens = camera.intrinsics
    return np.linalg.norm(point - camera.centre_in_world) / min(lens.fx, lens.fy)


def room_of_balls(seed):
    """A grid, cameras around it, and overlapping balls that every camera resolves."""
    rng = np.random.default_rng(seed)
    grid = scenes.random_grid(rng)
    cameras = scenes.random_cameras(rng, grid, int(rng.integers(1, 7)))
    balls = []
    for _ in range(6):
        centre = grid.lower_m + rng.random(3) * (grid.upper_m - grid.lower_m)
        radius = 3 * max(pitch_of(camera, centre) for camera in cameras) * rng.uniform(1, 2)
        if all(np.linalg.norm(camera.centre_in_world - centre) > radius + 0.02 for camera in cameras):
            balls.append([*centre, radius])
    return grid, cameras, scenes.Scene(balls=np.array(balls).reshape(-1, 4))


@pytest.mark.parametrize("rule", ["three", "majority", "veto", "any"])
@settings(derandomize=True, max_examples=40)
@given(seed=st.integers(0, 10**6))
def test_no_voxel_touched_by_a_resolved_solid_is_free(rule, seed):
    grid, cameras, scene = room_of_balls(seed)
    frames = [scenes.frame_of(camera, scene) for camera in cameras]
    focal = min(min(camera.intrinsics.fx, camera.intrinsics.fy) for camera in cameras)
    margin = Margin(range_linear=SAGITTA_PX / focal)
    space = reconstruct(grid, cameras, frames, rule=rule, detail="footprint", margin=margin)
    assert not (space.free & scenes.touched(grid, scene)).any()


@pytest.mark.parametrize("detail", ["footprint", "pixel"])
@settings(derandomize=True, max_examples=40)
@given(seed=st.integers(0, 10**6), lost=st.sampled_from([0.0, 0.02, 0.2]))
def test_specks_that_are_passed_over_hide_no_resolved_solid(detail, seed, lost):
    grid, cameras, scene = room_of_balls(seed)
    cameras = [replace(camera, flying_pixels=True) for camera in cameras]
    rng = np.random.default_rng(seed)
    frames = []
    for camera in cameras:
        depth = scenes.frame_of(camera, scene).depth_m.copy()
        depth[rng.random(depth.shape) < lost] = 0
        frames.append(DepthFrame(camera.name, 0, depth))
    focal = min(min(camera.intrinsics.fx, camera.intrinsics.fy) for camera in cameras)
    margin = Margin(range_linear=SAGITTA_PX / focal)
    space = reconstruct(grid, cameras, frames, rule="any", detail=detail, margin=margin)
    assert not (space.free & scenes.touched(grid, scene)).any()


@settings(derandomize=True, max_examples=40)
@given(seed=st.integers(0, 10**6))
def test_without_a_margin_it_may_enter_a_voxel_by_a_tenth_of_a_pitch_and_no_more(seed):
    grid, cameras, scene = room_of_balls(seed)
    frames = [scenes.frame_of(camera, scene) for camera in cameras]
    sagitta = [SAGITTA_PX * max(pitch_of(camera, ball[:3]) for camera in cameras) for ball in scene.balls]
    shrunk = scenes.Scene(balls=scene.balls - np.array([[0, 0, 0, s] for s in sagitta]).reshape(-1, 4))
    space = reconstruct(grid, cameras, frames, rule="any", detail="footprint")
    assert not (space.free & scenes.touched(grid, shrunk)).any()


@pytest.mark.parametrize("kind", ["planar", "radial"])
@pytest.mark.parametrize("offset", [(0.0, 0.0), (0.5, 0.5), (0.25, 0.5)])
def test_a_ball_that_enters_a_voxel_from_behind_between_four_rays_blocks_it(kind, offset):
    """The worst place for its front: where the rays around it are farthest."""
    camera = scenes.camera_at("c", (0, 0, 0), (1, 0, 0), size=(64, 48), focal=60.0, kind=kind)
    lens = camera.intrinsics
    z = 2.0
    # the direction that lies `offset` pixels from a pixel near the middle
    in_camera = (
        np.array([(32 + offset[0] - lens.cx) / lens.fx, (24 + offset[1] - lens.cy) / lens.fy, 1.0]) * z
    )
    front = camera.world_from_camera[:3, :3] @ in_camera
    radius = 3 * z / 60.0
    ball = front + radius * np.array([1.0, 0.0, 0.0])
    scene = scenes.Scene(balls=np.array([[*ball, radius]]))
    size = 0.05
    into = SAGITTA_PX * z / 60.0
    grid = VoxelGrid((front[0] + into - size, front[1] - size / 2, front[2] - size / 2), (1, 1, 1), size)
    assert scenes.touched(grid, scene).all()
    frame = scenes.frame_of(camera, scene)
    assert not reconstruct(grid, [camera], [frame], detail="footprint").free.any()
    moved = VoxelGrid((front[0] - 2 * size, front[1] - size / 2, front[2] - size / 2), (1, 1, 1), size)
    assert reconstruct(moved, [camera], [frame], detail="pixel").free.all()
