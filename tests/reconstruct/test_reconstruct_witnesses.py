"""Cameras that look from nearly one place are one witness: three of them are not three."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from elbowroom.errors import EvidenceError, InputError
from elbowroom.geometry import VoxelGrid, bits
from elbowroom.geometry.margin import Margin
from elbowroom.geometry.noise import NoiseModel
from elbowroom.reconstruct import Terms, carve, free_space_of, merge, resolve
from elbowroom.reconstruct.witnesses import merged_by_witness, witnesses
from elbowroom.sensing import DepthFrame, Snapshot
from elbowroom.simulate import wall_cameras
from reference import reconstruct_scenes as scenes
from reference.reconstruct_weaken import AGE, NOW, WAYS, some_margin, weakened

FEW = settings(derandomize=True, max_examples=8)
GRID = VoxelGrid((-1.0, -1.0, -1.0), (10, 10, 10), 0.2)
rooms = st.integers(0, 10**6)
ANGLE_DEG = 12.0


def beside(camera, name, way_m):
    """The camera once more, a little to its right."""
    pose = camera.world_from_camera.copy()
    pose[:3, 3] += way_m * pose[:3, 0]
    return replace(camera, name=name, world_from_camera=pose)


def crowded_room(seed):
    """A random room; beside the first and the last camera stand others, 2 cm away."""
    noise = NoiseModel(0.003, 0.0, 0.002) if seed % 2 else None
    rng, grid, group, scene, _ = scenes.random_room(seed, noise=noise, flying_pixels=seed % 3 != 0)
    near = [beside(group[0], "b0", 0.02), beside(group[0], "b1", -0.02), beside(group[-1], "b2", 0.02)]
    cameras = [*group, *near]
    frames = []
    for camera in cameras:
        exact = scenes.depth_of(camera, scene)
        exact[rng.random(exact.shape) < 0.01] = 0
        frames.append(DepthFrame(camera.name, NOW, exact))
    return rng, grid, cameras, frames


def space_of(grid, cameras, frames, margin, angle_deg=ANGLE_DEG, detail="pixel"):
    terms = Terms("three", detail, margin, AGE, witness_angle_deg=angle_deg)
    return free_space_of(grid, cameras, Snapshot(tuple(frames), now_ns=NOW), None, terms)


def at(*places):
    return tuple(
        scenes.camera_at(f"c{number}", place, (0.0, 0.0, 0.0)) for number, place in enumerate(places)
    )


def test_cameras_side_by_side_are_one_and_others_are_not():
    cameras = at((-3, 0, 0), (-3, 0.09, 0), (3, 0, 0), (0, 3, 0), (0, 3, 0.2))
    assert witnesses(GRID, cameras, 2.0) == ((0, 1),)
    assert witnesses(GRID, cameras, 5.0) == ((0, 1), (3, 4))
    assert witnesses(GRID, cameras, 0.0) == ()


def test_who_is_one_with_one_of_two_is_one_with_both():
    assert witnesses(GRID, at((-3, 0, 0), (-3, 0.1, 0), (-3, 0.2, 0)), 2.5) == ((0, 1, 2),)


def test_cameras_in_the_middle_of_the_grid_are_near_if_its_far_ends_say_so():
    assert witnesses(GRID, at((0.01, 0, 0), (0, 0.02, 0)), 2.0) == ((0, 1),)
    assert witnesses(GRID, at((0.5, 0, 0), (0, 0.5, 0)), 2.0) == ()


@pytest.mark.parametrize("count", [4, 8, 21])
def test_no_two_cameras_of_the_simulated_room_are_one(count):
    grid = VoxelGrid((-2.0, -2.0, 0.0), (20, 20, 12), 0.2)
    assert witnesses(grid, wall_cameras(count, (2.4, 0.4)), Terms().witness_angle_deg) == ()


@pytest.mark.parametrize("detail", ["footprint", "pixel", "point"])
@FEW
@given(seed=rooms)
def test_free_is_what_three_witnesses_see_through_or_one_and_nobody_disputes(detail, seed):
    rng, grid, cameras, frames = crowded_room(seed)
    margin = some_margin(rng)
    each = [
        carve(grid, [camera], [frame], detail=detail, margin=margin, complete=True)
        for camera, frame in zip(cameras, frames, strict=True)
    ]
    through = np.array([bits.unpack(one.through[0], grid) for one in each])
    disputed = np.array([bits.unpack(one.disputed, grid) for one in each]).any(axis=0)
    groups = witnesses(grid, tuple(cameras), ANGLE_DEG)
    grouped = {number for group in groups for number in group}
    one_by_one = [(number,) for number in range(len(cameras)) if number not in grouped]
    count = sum(through[list(group)].any(axis=0).astype(int) for group in (*groups, *one_by_one))
    free = (count >= 3) | ((count >= 1) & ~disputed)
    assert len(groups) >= 1
    np.testing.assert_array_equal(space_of(grid, cameras, frames, margin, detail=detail).free, free)


@pytest.mark.parametrize("detail", ["footprint", "pixel"])
@FEW
@given(seed=rooms, ways=st.sets(st.sampled_from(WAYS), min_size=1))
def test_less_evidence_never_adds_free_space(detail, seed, ways):
    rng, grid, cameras, frames = crowded_room(seed)
    margin = some_margin(rng)
    fewer, wider = weakened(rng, frames, margin, ways)
    full = space_of(grid, cameras, frames, margin, detail=detail)
    weak = space_of(grid, cameras, fewer, wider, detail=detail)
    assert not (weak.free & ~full.free).any()


@FEW
@given(seed=rooms)
def test_a_wider_angle_never_adds_free_space(seed):
    rng, grid, cameras, frames = crowded_room(seed)
    margin = some_margin(rng)
    before = None
    for angle_deg in (0.0, 2.0, 12.0, 45.0):
        free = space_of(grid, cameras, frames, margin, angle_deg).free
        assert before is None or not (free & ~before).any()
        before = free


def test_the_order_of_cameras_does_not_matter():
    rng, grid, cameras, frames = crowded_room(11)
    margin = some_margin(rng)
    other = space_of(grid, cameras[::-1], frames, margin)
    np.testing.assert_array_equal(space_of(grid, cameras, frames, margin).free, other.free)


def test_cameras_that_are_one_witness_must_be_carved_together():
    _, grid, cameras, frames = crowded_room(3)
    parts = [carve(grid, [camera], [frame]) for camera, frame in zip(cameras, frames, strict=True)]
    with pytest.raises(EvidenceError, match="are one witness: carve them in one group"):
        resolve(merge(parts), cameras)
    together = resolve(carve(grid, cameras, frames), cameras)
    np.testing.assert_array_equal(together.free, space_of(grid, cameras, frames, Margin(), 2.0).free)


@pytest.mark.parametrize("complete", [False, True])
@pytest.mark.parametrize("detail", ["footprint", "pixel"])
def test_parts_of_each_camera_can_be_merged_by_witness(detail, complete):
    for seed in range(6):
        _, grid, cameras, frames = crowded_room(seed)
        parts = [
            carve(grid, [camera], [frame], detail=detail, complete=complete)
            for camera, frame in zip(cameras, frames, strict=True)
        ]
        merged = merged_by_witness(parts, witnesses(grid, tuple(cameras), 2.0))
        together = carve(grid, cameras, frames, detail=detail, complete=complete)
        np.testing.assert_array_equal(merged.planes, together.planes)
        assert merged.as_one == together.as_one
        np.testing.assert_array_equal(resolve(merged, cameras).free, resolve(together, cameras).free)


def test_a_room_whose_cameras_are_all_one_witness_has_what_nobody_disputes():
    _, grid, cameras, frames = crowded_room(3)
    near = [cameras[0], beside(cameras[0], "b", 0.01), beside(cameras[0], "c", 0.02)]
    same = [DepthFrame(camera.name, NOW, frames[0].depth_m) for camera in near]
    evidence = carve(grid, near, same)
    assert not bits.unpack(evidence.through[1], grid).any()
    free = resolve(evidence, near).free
    np.testing.assert_array_equal(free, bits.unpack(evidence.through[0] & ~evidence.disputed, grid))


@pytest.mark.parametrize("angle_deg", [-1.0, 46.0, np.nan])
def test_an_angle_that_cannot_be_is_refused(angle_deg):
    with pytest.raises(InputError, match="witness_angle_deg"):
        Terms(witness_angle_deg=angle_deg)
