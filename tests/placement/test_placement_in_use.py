"""Optimising by scenes: planes of each candidate alone decide as merged evidence does."""

import itertools
from dataclasses import replace

import numpy as np
import pytest

from elbowroom.errors import InputError
from elbowroom.geometry import VoxelGrid, bits
from elbowroom.placement.candidates import candidates_of
from elbowroom.placement.coarse import with_joined_pixels
from elbowroom.placement.fixed_room import FixedRoom
from elbowroom.placement.in_use import optimise_in_use
from elbowroom.placement.optimisation import Goal, Search
from elbowroom.placement.rehearsal import Settings, evidence_by_camera, rehearse
from elbowroom.placement.scenes import random_scenes
from elbowroom.placement.solver.scene_layout import SceneLayout, SceneModel
from elbowroom.reconstruct import Terms, merge, resolve
from elbowroom.simulate import true_occupancy
from elbowroom.site import Site
from elbowroom.site.site import THESIS_ROOM
from reference.placement_rooms import camera_at, room_of

GRID = VoxelGrid((-2.0, -2.0, 0.0), (16, 16, 10), 0.25)


@pytest.fixture(scope="module")
def site(tmp_path_factory):
    text = THESIS_ROOM.read_text().replace("width: 640", "width: 64").replace("height: 480", "height: 48")
    for old, new in (
        ("fx: 320.0", "fx: 32.0"),
        ("fy: 320.0", "fy: 32.0"),
        ("319.5", "31.5"),
        ("239.5", "23.5"),
    ):
        text = text.replace(old, new)
    text = text.replace("wall_spacing_m: 0.5", "wall_spacing_m: 2.5").replace(
        "    ceiling_spacing_m: 1.25\n", ""
    )
    path = tmp_path_factory.mktemp("in_use") / "room.yaml"
    path.write_text(text.replace("  prices", "  aims_m: [[0.0, 0.0, 0.5], [0.0, 0.0, 1.2]]\n  prices"))
    return Site.load(path)


@pytest.fixture(scope="module")
def scenes(site):
    return list(random_scenes(site, GRID, FixedRoom.of_site(site), 2, people=2, seed=1))


@pytest.fixture(scope="module")
def model(site, scenes):
    """Candidates of one scene, exactly as they are."""
    candidates = candidates_of(site, GRID, FixedRoom.of_site(site))
    cameras = [replace(with_joined_pixels(c.camera, 64), name=f"{n}") for n, c in enumerate(candidates)]
    parts = evidence_by_camera(cameras, scenes[0], Settings(GRID), seed=1)
    truth = true_occupancy(GRID, scenes[0])
    truly = bits.pack(~truth.occupied, GRID)
    planes = [np.array(rows) for rows in zip(*((p.through[0], p.disputed) for p in parts), strict=True)]
    count = int((~truth.occupied).sum())
    places = np.arange(len(parts)) // 2
    return SceneModel(planes[0], planes[1], truly, count, places, np.ones(len(parts))), cameras, parts


def test_planes_decide_as_merged_evidence_does(model):
    scene_model, cameras, parts = model
    for chosen in ([0], [1, 5], [0, 3, 7, 9], list(range(0, len(parts), 2))):
        space = resolve(merge([parts[c] for c in chosen]), [cameras[c] for c in chosen])
        truly = bits.unpack(scene_model.truly, GRID)
        layout = SceneLayout.of(scene_model, chosen)
        assert layout.valid == (space.free & truly).sum()
        assert layout.share == pytest.approx(layout.valid / truly.sum())


def test_gains_and_losses_are_what_adding_and_leaving_out_do(model):
    scene_model = model[0]
    layout = SceneLayout.of(scene_model, [0, 4, 9])
    gains = layout.gains()
    assert (gains[[0, 1, 4, 5, 8, 9]] == -1).all()
    for c in (2, 7, 12):
        assert gains[c] == SceneLayout.of(scene_model, [0, 4, 9, c]).valid - layout.valid
    for member, loss in zip(layout.chosen, layout.losses(), strict=True):
        assert loss == layout.valid - layout.without([member]).valid
    layout.add(2)
    assert layout.valid == SceneLayout.of(scene_model, [0, 4, 9, 2]).valid


def test_bounds_hold_for_every_pair_and_triple(model):
    scene_model = model[0]
    for size in (1, 2, 3):
        for some in itertools.islice(itertools.combinations(range(scene_model.candidates), size), 0, None, 7):
            share = SceneLayout.of(scene_model, some).share
            assert share <= scene_model.share_bound + 1e-12
            assert scene_model.camera_bound(share) <= size
    assert scene_model.camera_bound(1000.0) == np.inf


def test_a_number_of_cameras_finds_more_than_the_first_as_many(site, scenes):
    candidates = candidates_of(site, GRID, FixedRoom.of_site(site))
    done = optimise_in_use(candidates, scenes, Settings(GRID), Goal(cameras=4), search=Search(1.0))
    assert len(done.cameras) <= 4 and 0 < done.free_pct <= done.bound <= 100
    first = rehearse([c.camera for c in candidates[0:8:2]], scenes, Settings(GRID), by_camera=False)
    again = rehearse(done.cameras, scenes, Settings(GRID), by_camera=False)
    assert again.free_pct > first.free_pct
    assert again.free_pct == pytest.approx(done.free_pct, abs=0.5)


def test_a_share_is_reached_with_few_cameras_and_what_exists_is_kept(site, scenes):
    candidates = candidates_of(site, GRID, FixedRoom.of_site(site))
    there = camera_at("there", (2.3, 1.1, 2.4), (0, 0, 1))
    done = optimise_in_use(
        candidates, scenes, Settings(GRID), Goal(60.0), existing=[there], search=Search(1.0)
    )
    assert done.cameras[0] is there and done.free_pct >= 60.0 and done.bound <= len(done.cameras)


def test_pixels_are_joined_so_that_the_image_reaches_as_far():
    camera = camera_at("c", (2, 0, 2), (0, 0, 1), width=640, height=480)
    small = with_joined_pixels(camera, 96)
    assert (small.width, small.height, small.name) == (128, 96, "c")
    for side in (-0.5, 639.5):
        at = (side - camera.intrinsics.cx) / camera.intrinsics.fx
        assert ((side + 0.5) / 5 - 0.5 - small.intrinsics.cx) / small.intrinsics.fx == pytest.approx(at)


@pytest.mark.parametrize(
    ("settings", "goal", "drop", "words"),
    [
        (Settings(GRID, Terms("majority")), Goal(50.0), False, "knows rule three, the site has majority"),
        (Settings(GRID), Goal(100.0), False, "100 % is out of reach: all 16 candidates together see through"),
        (Settings(GRID), Goal(50.0), True, "no scene"),
    ],
)
def test_what_cannot_be_is_one_line(site, scenes, settings, goal, drop, words):
    candidates = candidates_of(site, GRID, room_of())
    with pytest.raises(InputError, match=words):
        optimise_in_use(candidates, [] if drop else scenes, settings, goal, search=Search(1.0))
