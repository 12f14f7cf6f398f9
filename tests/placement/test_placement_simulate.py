"""Random scenes carved with the real code, and the map of detection capability."""

import itertools
import math
from dataclasses import replace

import numpy as np
import pytest

from elbowroom.errors import InputError
from elbowroom.geometry import VoxelGrid, bits
from elbowroom.motion import Level
from elbowroom.placement.charts import steps_mm
from elbowroom.placement.detection import capability, intrusion_mm, save_capability
from elbowroom.placement.rehearsal import Settings, evidence_by_camera, rehearse
from elbowroom.placement.scenes import random_scenes
from elbowroom.placement.verification import verify
from elbowroom.reconstruct import Terms, merge, reconstruct, resolve
from elbowroom.sensing import NoiseModel
from elbowroom.simulate import render, true_occupancy, wall_cameras
from elbowroom.site import Site
from elbowroom.site.site import THESIS_ROOM
from reference.placement_rooms import camera_at, room_of

GRID = VoxelGrid((-2.0, -2.0, 0.0), (20, 20, 13), 0.2)

NARROW = VoxelGrid((-0.6, -0.6, 0.0), (6, 6, 10), 0.2)


@pytest.fixture(scope="module")
def site():
    return Site.simulated_room()


@pytest.fixture(scope="module")
def moments(site):
    return list(random_scenes(site, GRID, None, 2, seed=3))


@pytest.fixture(scope="module")
def settings(site):
    machine = site.machine()
    return Settings(GRID, Terms(margin=site.margin()), machine, site.motions(machine)[:2])


@pytest.fixture(scope="module")
def cameras():
    return wall_cameras(5, width=48, height=36)


def test_scenes_are_the_same_for_the_same_seed_and_differ_between_seeds(site, moments):
    again = list(random_scenes(site, GRID, None, 1, seed=3))
    other = next(random_scenes(site, GRID, None, 1, seed=4))
    assert again[0].joints == moments[0].joints != other.joints


def test_scenes_of_any_room_hold_people_table_and_machine_that_share_no_place(site):
    thesis = Site.load(THESIS_ROOM)
    (moment,) = random_scenes(thesis, GRID, room_of(), 1, people=4, seed=1)
    names = [solid.name for solid in moment.solids]
    assert names.count("table") == 1 and sum("hair" in name for name in names) == 4
    assert {"floor", "wall +x"} <= set(names) and not moment.joints
    fine = VoxelGrid((-2.0, -2.0, 0.0), (50, 50, 31), 0.08)
    moving = [s for s in moment.solids if not s.is_static and "hair" not in s.name]
    for a, b in itertools.combinations(moving, 2):
        both = [true_occupancy(fine, type(moment)(0.0, (solid,), {})).occupied for solid in (a, b)]
        assert not (both[0] & both[1]).any(), (a.name, b.name)


def test_evidence_camera_by_camera_decides_as_reconstruct_does(cameras, moments, settings):
    moment = moments[0]
    parts = evidence_by_camera(cameras, moment, settings, seed=5)
    merged = resolve(
        merge(parts), cameras, margin=settings.terms.margin, machine=settings.machine, joints=moment.joints
    )
    whole = reconstruct(
        GRID,
        cameras,
        render(cameras, moment, seed=5),
        settings.machine,
        moment.joints,
        margin=settings.terms.margin,
        explain_tolerance_m=settings.terms.explain_tolerance_m,
    )
    assert (merged.free_words == whole.free_words).all()


def test_what_a_camera_is_worth_is_what_leaving_it_out_and_losing_it_do(cameras, moments, settings):
    done = rehearse(cameras, moments[:1], settings)
    (scene,) = done.scenes
    moment = moments[0]
    frames = render(cameras, moment, seed=1)
    truth = true_occupancy(GRID, moment)
    truly = ~truth.occupied & ~truth.machine

    def found(of, seen):
        space = reconstruct(GRID, of, seen, settings.machine, moment.joints, margin=settings.terms.margin)
        return 100 * (space.free & truly).sum() / truly.sum()

    whole = found(cameras, frames)
    assert scene.free_pct == pytest.approx(whole)
    for n in (0, 3):
        rest, rest_frames = (
            [c for i, c in enumerate(cameras) if i != n],
            [f for i, f in enumerate(frames) if i != n],
        )
        name = cameras[n].name
        assert scene.loss_pct[name] == pytest.approx(whole - found(cameras, rest_frames))
        assert scene.contributes_pct[name] == pytest.approx(whole - found(rest, rest_frames), abs=0.05)


def test_cameras_side_by_side_are_rehearsed_as_the_one_witness_that_they_are(cameras, moments, settings):
    pose = cameras[0].world_from_camera.copy()
    pose[:3, 3] += 0.03 * pose[:3, 0]
    near = [*cameras, replace(cameras[0], name="beside", world_from_camera=pose)]
    scene = rehearse(near, moments[:1], settings).scenes[0]
    frames = render(near, moments[0], seed=1)
    same = {"margin": settings.terms.margin, "looks": False}

    def found(of, given):
        return reconstruct(GRID, of, given, settings.machine, moments[0].joints, **same).free_words

    truth = true_occupancy(GRID, moments[0])
    truly_free = bits.pack(~truth.occupied & ~truth.machine, GRID)

    def percent(words):
        return (
            100.0
            * np.unpackbits((words & truly_free).view(np.uint8)).sum()
            / np.unpackbits(truly_free.view(np.uint8)).sum()
        )

    assert scene.free_pct == pytest.approx(percent(found(near, frames)))
    without = percent(found(near[:-1], frames[:-1]))
    assert scene.contributes_pct["beside"] == pytest.approx(scene.free_pct - without)


def test_losing_a_camera_never_finds_more(cameras, moments, settings):
    done = rehearse(cameras, moments, settings)
    assert all(loss >= 0 for scene in done.scenes for loss in scene.loss_pct.values())
    assert 0 < done.free_pct <= 100 and done.free_error_pct >= 0 and done.occupied_pct > 95
    stops = done.false_stops()
    assert set(stops) == {motion.name for motion in settings.motions}
    assert all(0 <= false <= of <= 2 for false, of in stops.values())
    for scene in done.scenes:
        assert all(found.rank <= true.rank for found, true in scene.levels.values())
        assert all(isinstance(level, Level) for pair in scene.levels.values() for level in pair)


def test_without_a_machine_there_are_no_motions(cameras):
    thesis = Site.load(THESIS_ROOM)
    scenes = list(random_scenes(thesis, GRID, room_of(), 1, people=1, table=False))
    done = rehearse(cameras, scenes, Settings(GRID), by_camera=False)
    assert done.false_stops() == {} and done.scenes[0].loss_pct == {} and math.isnan(done.free_error_pct)


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (lambda s: list(random_scenes(s, GRID, None, 0)), "0 scenes"),
        (lambda s: list(random_scenes(s, GRID, None, 1, people=-1)), "-1 people"),
        (lambda s: rehearse([], [], Settings(GRID)), "no camera"),
        (lambda s: rehearse(wall_cameras(1), [], Settings(GRID)), "no scene"),
        (
            lambda s: list(random_scenes(Site.load(THESIS_ROOM), NARROW, None, 1, people=30, table=False)),
            "no place for person",
        ),
    ],
)
def test_scenes_that_cannot_be_are_refused(site, call, words):
    with pytest.raises(InputError, match=words):
        call(site)


def test_intrusion_is_the_standards_formula():
    sizes = np.array([5, 14, 20, 40, 40.1, 70, 70.1, np.inf])
    np.testing.assert_allclose(intrusion_mm(sizes), [0, 0, 48, 208, 850, 850, np.inf, np.inf])


def test_capability_is_three_pitches_at_the_range_or_six_sigmas_and_never_below_the_diagonal():
    grid = VoxelGrid((-2.0, -0.1, 0.9), (20, 1, 1), 0.2)
    exact = camera_at("exact", (-2.5, 0.0, 1.0), (2, 0.0, 1.0), width=640, height=480)
    result = capability(verify(grid, [exact]))
    depth = grid.centre_of(np.argwhere(np.ones(grid.shape, dtype=bool)))[:, 0] + 2.5
    np.testing.assert_allclose(result.pitch_mm[:, 0, 0], 3000 * depth / 320, rtol=1e-5)
    np.testing.assert_allclose(result.smallest_mm, 200 * np.sqrt(3), rtol=1e-5)
    fine = VoxelGrid((-2.0, -0.005, 0.995), (400, 1, 1), 0.01)
    noisy = camera_at(
        "n", (-2.5, 0.0, 1.0), (2, 0.0, 1.0), width=640, height=480, noise=NoiseModel(0.004, 0.0, 0.002)
    )
    one = capability(verify(fine, [noisy]))
    depth = fine.centre_of(np.argwhere(np.ones(fine.shape, dtype=bool)))[:, 0] + 2.5
    wanted = np.maximum.reduce(
        [3000 * depth / 320, 6000 * noisy.noise.sigma(depth), np.full(400, 10 * np.sqrt(3))]
    )
    np.testing.assert_allclose(one.smallest_mm[:, 0, 0], wanted, rtol=1e-4)
    two = capability(verify(fine, [noisy, exact]), 2)
    np.testing.assert_allclose(two.smallest_mm, one.smallest_mm, rtol=1e-6)


def test_more_cameras_never_see_less_and_more_views_never_more(grid, ring, tmp_path):
    few, many = capability(verify(grid, ring[:3])), capability(verify(grid, ring))
    assert (many.smallest_mm <= few.smallest_mm).all()
    three = capability(verify(grid, ring), 3)
    assert (three.smallest_mm >= many.smallest_mm).all()
    assert (np.isinf(three.smallest_mm) == (verify(grid, ring).counts < 3)).all()
    assert many.share_pct(1e6) >= many.share_pct(500) and many.percentile_mm(50) <= many.percentile_mm(99)
    with np.load(save_capability(tmp_path / "c.npz", many), allow_pickle=False) as file:
        np.testing.assert_array_equal(file["smallest_mm"], many.smallest_mm)
        assert file["views"] == 1 and file["intrusion_mm"].shape == grid.shape
    with pytest.raises(InputError, match="8 views, there are 7 cameras"):
        capability(verify(grid, ring), 8)


def test_planes_of_bits_are_counted_right():
    from elbowroom.placement.rehearsal import _count

    mask = np.random.default_rng(0).random(GRID.shape) < 0.3
    assert _count(bits.pack(mask, GRID)) == mask.sum()


@pytest.mark.parametrize(
    ("sizes", "wanted"),
    [
        ([36.0, 44.0], (40, 45)),
        ([np.inf], (14,)),
        ([5.0], (14,)),
        ([5000.0], (1000,)),
        ([90.0] * 5 + [400.0] * 5 + [np.inf], (90, 100, 120, 150, 250, 300, 400)),
    ],
)
def test_steps_of_the_map_part_what_is_seen(sizes, wanted):
    assert steps_mm(np.array(sizes)) == wanted
