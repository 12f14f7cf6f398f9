"""Free is a claim about a time: what a camera saw some time ago holds for what nothing can have reached since."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from elbowroom.errors import InputError
from elbowroom.geometry import VoxelGrid, bits, parallel
from elbowroom.geometry.margin import Margin
from elbowroom.geometry.noise import NoiseModel
from elbowroom.reconstruct import LAWFUL, merge, reconstruct
from elbowroom.reconstruct.ages import aged_m
from elbowroom.reconstruct.carve import carve_aged
from elbowroom.reconstruct.point_report import Sight
from elbowroom.reconstruct.terms import PEOPLE_SPEED_M_S, Terms
from elbowroom.sensing import DepthFrame, Snapshot
from reference import reconstruct_scenes as scenes
from reference.reconstruct_aged import is_clear_by_points, sees_through_grown
from reference.reconstruct_pixel import THROUGH, say_of_voxel
from reference.reconstruct_views import images_of, says_of

NOW = 1_000_000_000
SPEED = PEOPLE_SPEED_M_S
FEW = settings(derandomize=True, max_examples=25)
rooms = st.integers(0, 10**6)
ages_ms = st.lists(st.integers(0, 200), min_size=6, max_size=6)
SMALL = (24, 18)


def a_room(seed, **more):
    """A random room; in half of the rooms cameras have noise and filter flying pixels."""
    noise = NoiseModel(0.003, 0.0, 0.002) if seed % 2 else None
    rng, grid, cameras, _, frames = scenes.random_room(seed, noise=noise, **more)
    return rng, grid, cameras, frames


def old(frames, ages):
    """The frames, each some milliseconds old at NOW."""
    return [
        DepthFrame(frame.camera, NOW - age * 10**6, frame.depth_m)
        for frame, age in zip(frames, ages, strict=False)
    ]


@pytest.mark.parametrize("seed", [0, 1, 2, 3, 4, 5, 7, 9])
def test_an_aged_claim_is_each_grown_voxel_against_all_pixels(seed):
    rng, _, _, _ = a_room(seed)
    grid = VoxelGrid(tuple(rng.uniform(-1, 1, 3)), tuple(int(n) for n in rng.integers(4, 9, 3)), 0.06)
    noise = NoiseModel(0.003, 0.0, 0.002) if seed % 2 else None
    cameras = scenes.random_cameras(rng, grid, 3, size=SMALL, focal=float(rng.uniform(10, 40)), noise=noise)
    scene = scenes.random_scene(rng, grid, balls=1, boxes=1, cameras=cameras)
    frames = [scenes.frame_of(camera, scene) for camera in cameras]
    margin = Margin(lateral_px=float(rng.choice((0, 0.5))), bias_m=float(rng.choice((0, 0.01))))
    images = images_of(grid, cameras, frames, margin)
    through = 0
    for camera, image, frame, far_m in zip(cameras, images, frames, (0.004, 0.03, 0.15), strict=True):
        aged = carve_aged(grid, [camera], [frame], {camera.name: far_m}, margin=margin)
        says = says_of(
            grid, [image], lambda im, centre, edge, far_m=far_m: sees_through_grown(im, centre, edge, far_m)
        )[0].astype(bool)
        np.testing.assert_array_equal(bits.unpack(aged.through[0], grid), says)
        through += says.sum()
    assert through


@pytest.mark.parametrize("detail", ["footprint", "pixel", "point"])
@FEW
@given(seed=rooms, far_m=st.floats(0.001, 0.3))
def test_what_still_counts_as_seen_through_is_clear_of_all_that_may_have_come(detail, seed, far_m):
    """By brute force: points of the voxel grown by the ball, each against the pixel that it falls into."""
    rng, grid, cameras, frames = a_room(seed)
    image = images_of(grid, cameras[:1], frames[:1], Margin(lateral_px=0.0))[0]
    aged = carve_aged(
        grid,
        cameras[:1],
        frames[:1],
        detail=detail,
        margin=Margin(lateral_px=0.0),
        aged_m={cameras[0].name: far_m},
    )
    voxels = np.argwhere(bits.unpack(aged.through[0], grid))
    for index in rng.permutation(voxels)[:20]:
        assert is_clear_by_points(image, grid.centre_of(index), grid.voxel_size_m, far_m)


def test_little_more_than_what_must_be_lost_is_lost():
    """Of what is clear of half as much again by brute force, a camera keeps nearly all; of the rest most is to go."""
    kept = clear = 0
    for seed in range(30):
        _, grid, cameras, frames = a_room(2 * seed, kind="planar")
        (image,) = images_of(grid, cameras[:1], frames[:1], Margin(lateral_px=0.0))
        aged = carve_aged(
            grid, cameras[:1], frames[:1], margin=Margin(lateral_px=0.0), aged_m={cameras[0].name: 0.1}
        )
        seen = bits.unpack(aged.through[0], grid)
        rng = np.random.default_rng(seed)
        for index in rng.permutation(list(np.ndindex(grid.shape)))[:40]:
            if is_clear_by_points(image, grid.centre_of(index), grid.voxel_size_m, 0.15, many=100):
                clear += 1
                kept += bool(seen[tuple(index)])
    assert clear > 50
    assert kept > 0.9 * clear


@pytest.mark.parametrize("detail", ["footprint", "pixel", "point"])
@pytest.mark.parametrize("rule", LAWFUL)
@FEW
@given(seed=rooms, ages=ages_ms, more=ages_ms)
def test_an_older_frame_only_frees_less(detail, rule, seed, ages, more):
    _, grid, cameras, frames = a_room(seed)
    same = {"rule": rule, "detail": detail, "now_ns": NOW, "looks": False}
    before = reconstruct(grid, cameras, old(frames, ages), **same)
    older = [age + extra * (number % 2) for number, (age, extra) in enumerate(zip(ages, more, strict=True))]
    after = reconstruct(grid, cameras, old(frames, older), **same)
    assert not (after.free & ~before.free).any()
    # who disputes still does
    np.testing.assert_array_equal(
        after.disputed_words | ~after.blocked_words | before.free_words,
        before.disputed_words | ~after.blocked_words | before.free_words,
    )


@pytest.mark.parametrize("detail", ["footprint", "pixel"])
@FEW
@given(seed=rooms, ages=ages_ms)
def test_what_is_free_with_ages_is_free_without(detail, seed, ages):
    _, grid, cameras, frames = a_room(seed)
    same = {"detail": detail, "now_ns": NOW, "looks": False}
    aged = reconstruct(grid, cameras, old(frames, ages), **same)
    still = reconstruct(grid, cameras, old(frames, ages), people_speed_m_s=0.0, nothing_moves=True, **same)
    of_the_moment = reconstruct(grid, cameras, old(frames, [0] * 6), **same)
    assert not (aged.free & ~still.free).any()
    np.testing.assert_array_equal(still.free_words, of_the_moment.free_words)
    np.testing.assert_array_equal(still.disputed_words, of_the_moment.disputed_words)


@FEW
@given(
    seed=rooms, ages=ages_ms, detail=st.sampled_from(["footprint", "pixel", "point"]), complete=st.booleans()
)
def test_ages_in_any_order_and_grouping_leave_the_same_bits(seed, ages, detail, complete):
    rng, grid, cameras, frames = a_room(seed)
    far = {camera.name: SPEED * age / 1e3 for camera, age in zip(cameras, ages, strict=False)}
    same = {"detail": detail, "complete": complete, "aged_m": far}
    with parallel.threads(1):
        whole = carve_aged(grid, cameras, frames, **same)
    order = rng.permutation(len(cameras))
    split = int(rng.integers(len(cameras) + 1))
    with parallel.threads(3):
        again = carve_aged(grid, [cameras[n] for n in order], frames[::-1], **same)
    groups = [order[:split], order[split:]]
    merged = merge(
        [carve_aged(grid, [cameras[n] for n in g], [frames[n] for n in g], **same) for g in groups if len(g)]
    )
    for other in (again, merged):
        np.testing.assert_array_equal(other.planes, whole.planes)
        if complete:
            np.testing.assert_array_equal(other.counts.through, whole.counts.through)
            np.testing.assert_array_equal(other.counts.disputes, whole.counts.disputes)


@pytest.mark.parametrize("rule", ["three", "majority", "veto", "any"])
@pytest.mark.parametrize("detail", ["footprint", "pixel"])
@FEW
@given(seed=rooms, ages=ages_ms)
def test_no_voxel_that_a_ball_on_its_way_touches_is_free(rule, detail, seed, ages):
    """A ball that every camera resolves, at its greatest speed; each camera saw it where it was at the time."""
    rng = np.random.default_rng(seed)
    grid = VoxelGrid((-0.6, -0.6, -0.6), (20, 20, 20), 0.06)
    cameras = scenes.random_cameras(rng, grid, 6, size=(96, 72), focal=70.0)
    # not so near that a pixel is more than a third of it
    cameras = [c for c in cameras if np.linalg.norm(c.centre_in_world) > 0.8]
    way = rng.normal(size=3)
    way /= np.linalg.norm(way)
    place = rng.uniform(-0.3, 0.3, 3)
    frames = []
    for camera, age in zip(cameras, ages, strict=False):
        then = place - way * SPEED * age / 1e3
        scene = scenes.Scene(balls=np.array([[*then, 0.12]]))
        frames.append(scenes.frame_of(camera, scene, NOW - age * 10**6))
    margin = Margin(range_linear=0.1 / 70.0)
    space = reconstruct(
        grid, cameras, frames, rule=rule, detail=detail, margin=margin, now_ns=NOW, looks=False
    )
    now = scenes.Scene(balls=np.array([[*place, 0.12]]))
    assert not (space.free & scenes.touched(grid, now)).any()


def test_what_pixel_detail_sees_of_the_moment_is_the_limit_of_what_it_sees_a_little_later():
    grid = VoxelGrid((0.5, -0.2, -0.2), (6, 5, 5), 0.1)
    cameras = [scenes.camera_at("c", (-0.4, 0.1, 0.2), (1, 0, 0), size=SMALL, focal=18.0)]
    frames = [scenes.frame_of(cameras[0], scenes.Scene(balls=np.array([[0.8, 0.0, 0.0, 0.15]])))]
    images = images_of(grid, cameras, frames, Margin())
    says = says_of(grid, images, say_of_voxel)[0] & THROUGH
    barely = carve_aged(grid, cameras[:1], frames[:1], aged_m={cameras[0].name: 1e-9})
    np.testing.assert_array_equal(bits.unpack(barely.through[0], grid), says.astype(bool))
    assert says.any()


def test_the_age_counts_from_exposure_to_the_end_of_the_pass_with_the_clocks_bound():
    camera = scenes.camera_at("c", (0, 0, 0), (1, 0, 0), clock_bound_ns=5_000_000)
    frame = scenes.frame_of(camera, scenes.Scene(), NOW - 30_000_000)
    terms = Terms(people_speed_m_s=2.0, pass_ns=15_000_000)
    assert aged_m([camera], Snapshot((frame,), now_ns=NOW), terms) == {"c": pytest.approx(0.1)}
    # one that lies after the moment is as far from it as one before
    later = DepthFrame("c", NOW + 30_000_000, frame.depth_m)
    assert aged_m([camera], Snapshot((later,), now_ns=NOW), terms) == {"c": pytest.approx(0.1)}


def test_without_the_time_now_the_newest_frame_is_the_moment():
    frames = [
        DepthFrame(name, stamp, np.ones((4, 4), np.float32)) for name, stamp in (("a", 0), ("b", 10**7))
    ]
    assert aged_m([], Snapshot(tuple(frames)), Terms()) == {"a": pytest.approx(0.02), "b": 0.0}
    stampless = DepthFrame("a", None, np.ones((4, 4), np.float32))
    assert aged_m([], Snapshot((stampless,)), Terms()) == {"a": 0.0}


@pytest.mark.parametrize(
    ("more", "match"),
    [
        ({"people_speed_m_s": 0.0}, "nothing_moves"),
        ({"people_speed_m_s": -1.0}, "at least 0"),
        ({"people_speed_m_s": float("nan")}, "at least 0"),
        ({"nothing_moves": True}, "people_speed_m_s 0 alone"),
        ({"pass_ns": -1}, "pass_ns"),
    ],
)
def test_a_speed_of_nobody_needs_somebodys_word(more, match):
    with pytest.raises(InputError, match=match):
        Terms(**more)


def test_a_voxel_that_was_seen_through_too_long_ago_is_explained_so():
    grid = VoxelGrid((0.5, -0.2, -0.2), (4, 4, 4), 0.1)
    camera = scenes.camera_at("c", (-0.4, 0.0, 0.0), (1, 0, 0))
    frame = scenes.frame_of(camera, scenes.Scene(boxes=np.array([[0.95, -1, -1, 1.2, 1, 1]])), NOW)
    place = grid.centre_of((3, 1, 1))
    (now,) = reconstruct(grid, [camera], [frame], now_ns=NOW, looks=False).explain(place).cameras
    (later,) = reconstruct(grid, [camera], [frame], now_ns=NOW + 10**8, looks=False).explain(place).cameras
    assert (now.sight, later.sight) == (Sight.THROUGH, Sight.AGED)


def test_what_was_measured_of_a_clock_is_part_of_the_age():
    frames = tuple(DepthFrame(name, NOW, np.ones((2, 2), np.float32)) for name in "ab")
    bounded = Snapshot(frames, now_ns=NOW, clock_bounds_ns={"a": 50_000_000})
    plain = aged_m([], Snapshot(frames, now_ns=NOW), Terms())
    found = aged_m([], bounded, Terms())
    assert found["b"] == plain["b"] and found["a"] - plain["a"] == pytest.approx(0.05 * SPEED)
