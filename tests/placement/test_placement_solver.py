"""The solver's own model, its search and its bound; every layout is judged again by `verify`."""

import itertools
import math
import sys
import threading
import time

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from elbowroom.errors import InputError, PackageError
from elbowroom.geometry import VoxelGrid
from elbowroom.placement.candidates import candidates_of
from elbowroom.placement.optimisation import Goal, Search, optimise, sample_points
from elbowroom.placement.requirement import TIE_RAD, Requirement
from elbowroom.placement.solver.bound import hard_points, price_bound, share_bound
from elbowroom.placement.solver.kernels import search as kernels
from elbowroom.placement.solver.layout import Layout
from elbowroom.placement.solver.model import Model, build_model
from elbowroom.placement.solver.search import prune, repair
from elbowroom.placement.solver.sectors import sector_layout
from elbowroom.placement.verification import verify
from elbowroom.site import Site
from elbowroom.site.site import THESIS_ROOM
from reference.placement_rooms import camera_at, room_of
from reference.placement_views import blocked_by_box, directions, in_view, largest_set

pytest.importorskip("ortools")
PILLAR = ((-0.3, -0.2, 0.0), (0.2, 0.4, 1.5))


def model_of(sees, azimuth_deg, *, views=3, angle=100.0, price=None, kept=()):
    """A model whose candidates each have a place of their own."""
    sees = np.array(sees, dtype=np.uint8)
    azimuth = np.radians(np.broadcast_to(np.array(azimuth_deg, dtype=float), sees.T.shape).T)
    price = np.ones(len(sees)) if price is None else np.array(price, dtype=float)
    return Model(
        Requirement(views, angle), sees, np.mod(azimuth, 2 * math.pi), np.arange(len(sees)), price, kept
    )


@pytest.fixture
def site(tmp_path):
    """The thesis' room, coarse, with fewer candidates."""
    text = THESIS_ROOM.read_text().replace("voxel_size_m: 0.05", "voxel_size_m: 0.25")
    text = text.replace("wall_spacing_m: 0.5", "wall_spacing_m: 1.25").replace(
        "ceiling_spacing_m: 1.25", "ceiling_spacing_m: 2.5"
    )
    path = tmp_path / "room.yaml"
    path.write_text(text)
    return Site.load(path)


@given(st.lists(st.floats(0, 359.999), max_size=6), st.sampled_from([72.0, 100.0, 120.0, 180.0]))
@settings(max_examples=150)
def test_views_apart_are_what_trying_all_sets_gives(angles, least_deg):
    views = int(360 // least_deg)
    model = model_of(np.ones((len(angles), 1)), angles, views=views, angle=least_deg) if angles else None
    if model is not None:
        found = int(Layout.of(model, range(len(angles))).apart[0])
        assert found == min(largest_set(np.radians(angles), math.radians(least_deg)), views)


@given(st.integers(0, 10_000))
@settings(max_examples=30)
def test_gains_and_losses_are_what_adding_and_leaving_out_do(seed):
    rng = np.random.default_rng(seed)
    model = model_of(rng.random((8, 12)) < 0.7, rng.uniform(0, 360, 8))
    layout = Layout.of(model, [int(c) for c in rng.choice(8, 4, replace=False)])
    total = layout.worth[layout.apart].sum()
    gains = layout.gains()
    for c in range(8):
        if c in layout.chosen:
            assert gains[c] == -1
        else:
            more = Layout.of(model, [*layout.chosen, c])
            assert gains[c] == pytest.approx(more.worth[more.apart].sum() - total)
    for member, loss in zip(layout.chosen, layout.losses(), strict=True):
        less = layout.without([member])
        np.testing.assert_array_equal(
            less.apart, Layout.of(model, [c for c in layout.chosen if c != member]).apart
        )
        assert loss == pytest.approx(total - less.worth[less.apart].sum())


def test_the_least_arc_is_the_least_of_all():
    """What an arc holds changes only where one of its ends passes a direction: between these it is tried."""
    rng = np.random.default_rng(3)
    for _ in range(20):
        angles, weight = rng.uniform(0, 2 * np.pi, 6), rng.random(6)
        starts, sums = np.zeros(1), np.zeros(1)
        kernels.least_arcs(angles, np.argsort(angles), weight, 6, np.array([2.8]), starts, sums)
        changes = np.sort(np.mod(np.concatenate([angles, angles - 2.8]), 2 * np.pi))
        begins = (changes + np.append(changes[1:], changes[0] + 2 * np.pi)) / 2
        tried = [weight[np.mod(angles - begin, 2 * np.pi) <= 2.8].sum() for begin in begins]
        assert sums[0] == pytest.approx(min(tried))


@pytest.mark.parametrize("furniture", [(), (PILLAR,)], ids=["empty", "pillar"])
def test_the_model_sees_what_lines_of_sight_say(grid, ring, furniture):
    points = grid.centre_of(np.argwhere(np.ones(grid.shape, dtype=bool))[::13])
    room = room_of(furniture)
    model = build_model(ring, range(len(ring)), [1.0] * len(ring), points, room.triangles, Requirement())
    for c, camera in enumerate(ring):
        eye = camera.centre_in_world
        wanted = [
            in_view(camera, p) and not any(blocked_by_box(eye, p, *box) for box in furniture) for p in points
        ]
        assert model.sees[c].astype(bool).tolist() == wanted
    turn = np.array([directions(p, [c.centre_in_world for c in ring]) for p in points]).T
    np.testing.assert_allclose(model.azimuth, np.mod(turn, 2 * np.pi), atol=1e-12)


def test_model_and_verification_agree_though_they_share_no_code(grid, ring):
    """On voxel centres; they may differ where a centre lies on the very edge of an image."""
    room = room_of((PILLAR,))
    found = verify(grid, ring, room)
    index = np.argwhere(found.asked)
    model = build_model(ring, range(7), [1.0] * 7, grid.centre_of(index), room.triangles, Requirement())
    own = Layout.of(model, range(7)).apart >= 3
    assert (own != found.valid[tuple(index.T)]).mean() < 0.002


def test_range_and_missing_background_are_the_same_in_model_and_verification(grid):
    cameras = [
        camera_at(f"c{n}", (2.4, y, 1.2), (0, 0, 1.0), max_depth_m=4.4, depth_kind=kind)
        for n, (y, kind) in enumerate([(0.3, "planar"), (-0.8, "radial")])
    ]
    room = room_of()
    found = verify(grid, cameras, room)
    index = np.argwhere(found.asked)
    model = build_model(cameras, range(2), [1.0] * 2, grid.centre_of(index), room.triangles, Requirement())
    seen = found.seen[(slice(None), *index.T)]
    assert 0.05 < seen.mean() < 0.9
    assert (seen != model.sees.astype(bool)).mean() < 0.02


def smallest(model, share):
    """The fewest candidates that reach a share, by trying all choices."""
    for size in range(model.candidates + 1):
        for some in itertools.combinations(range(model.candidates), size):
            if Layout.of(model, some).share >= share:
                return size
    return None


@pytest.mark.parametrize("seed", range(4))
def test_bounds_hold_for_every_choice(seed):
    rng = np.random.default_rng(seed)
    model = model_of(rng.random((9, 20)) < 0.8, np.arange(9) * 40 + rng.uniform(-15, 15, 9))
    reach = Layout.of(model, range(9)).share
    until = time.perf_counter() + 20
    for share in (0.5 * reach, reach):
        assert price_bound(model, share, until) <= smallest(model, share) + 1e-6
    best = max(Layout.of(model, some).share for some in itertools.combinations(range(9), 4))
    assert share_bound(model, 4.0, until) >= best


def test_the_bound_knows_that_three_views_need_three_cameras_and_sectors_need_no_fewer():
    model = model_of(np.ones((6, 4)), np.arange(6) * 60.0)
    assert price_bound(model, 1.0, time.perf_counter() + 5) == pytest.approx(3.0)
    choice = sector_layout(model, 1.0, 5.0)
    assert choice is not None and Layout.of(model, choice.chosen).share == 1.0
    assert len(choice.chosen) == 3 and choice.bound == pytest.approx(3.0)


def test_sectors_of_no_width_are_left_to_the_search():
    assert sector_layout(model_of(np.ones((6, 4)), np.arange(6) * 60.0, angle=120.0), 1.0, 1.0) is None


def test_hard_points_are_those_that_few_places_see_from_behind():
    model = model_of(np.ones((36, 1300)), np.arange(36) * 10.0)
    model.sees[:20, 7] = 0
    assert 7 in hard_points(model)[:1]


def test_repair_reaches_the_share_and_prune_leaves_nothing_to_spare():
    rng = np.random.default_rng(5)
    model = model_of(
        rng.random((20, 300)) < 0.9, rng.uniform(0, 360, 20), price=rng.uniform(1, 5, 20), kept=(4,)
    )
    layout = prune(repair(Layout.of(model, range(9)), 0.95), 0.95)
    assert layout.share >= 0.95 and 4 in layout.chosen
    for member in layout.chosen:
        if member != 4:
            assert layout.without([member]).share < 0.95
    assert repair(Layout.of(model, ()), 1.0, budget=6.0).price <= 6.0


def test_an_optimised_layout_is_verified_and_needs_fewer_cameras_than_evenly_spread_ones(site):
    grid, room = site.grid(), room_of()
    done = optimise(grid, room, candidates_of(site, grid, room), goal=Goal(90.0), search=Search(3.0, 600))
    again = verify(grid, done.cameras, room)
    assert again.valid_pct == done.found.valid_pct >= 90.0
    assert 3 <= done.bound <= len(done.cameras) <= 12
    assert done.price == pytest.approx(sum(c.price for c in done.bought))
    counts = [count for _, count, _, _ in done.steps]
    assert counts and counts[-1] == len(done.cameras)
    assert len({c.mount.name for c in done.bought}) == len(done.bought)


def test_what_exists_is_kept_and_its_mount_is_taken(site):
    grid, room = site.grid(), room_of()
    candidates = candidates_of(site, grid, room)
    there = candidates[0].camera
    done = optimise(grid, room, candidates, goal=Goal(85.0), existing=[there], search=Search(2.0, 400))
    assert done.cameras[0] is there and len({c.name for c in done.cameras}) == len(done.cameras)
    assert all(np.linalg.norm(c.camera.centre_in_world - there.centre_in_world) > 0.1 for c in done.bought)


def test_a_number_of_cameras_gets_the_best_share_it_can_within_its_bound(site):
    grid, room = site.grid(), room_of()
    done = optimise(
        grid, room, candidates_of(site, grid, room), goal=Goal(cameras=7), search=Search(3.0, 400)
    )
    assert len(done.cameras) <= 7
    assert 60 < done.model_pct <= done.bound <= 100


def test_the_cheapest_layout_costs_no_more_than_the_one_of_fewest_cameras(site, tmp_path):
    text = site.path.read_text().replace(
        "    - {name: vga, price: 700}",
        "    - {name: wide, price: 900}\n    - {name: narrow, fx: 420.0, fy: 420.0, cx: 319.5, cy: 239.5, price: 100}",
    )
    (tmp_path / "two.yaml").write_text(text)
    two = Site.load(tmp_path / "two.yaml")
    grid, room = two.grid(), room_of()
    candidates = candidates_of(two, grid, room)
    assert {c.sensor.name for c in candidates} == {"wide", "narrow"}
    few = optimise(grid, room, candidates, goal=Goal(80.0), search=Search(2.0, 300))
    cheap = optimise(grid, room, candidates, goal=Goal(80.0, by_price=True), search=Search(2.0, 300))
    assert cheap.price <= few.price and cheap.bound <= cheap.price
    assert cheap.found.valid_pct >= 80.0


def test_a_requirement_out_of_reach_says_at_once_what_is_and_who_sees_nothing(site):
    grid = site.grid()
    room = room_of([((-0.9, -2.5, 0.0), (-0.85, 2.5, 2.9))])
    candidates = [c for c in candidates_of(site, grid, room) if c.mount.position_m[0] > -0.8]
    begun = time.perf_counter()
    with pytest.raises(InputError) as caught:
        optimise(grid, room, candidates, search=Search(600.0, 500))
    assert time.perf_counter() - begun < 10
    text = str(caught.value)
    assert (
        "98.9 % is out of reach" in text
        and "nobody can see, within x -1.88 to -1.12" in text
        and "\n" not in text
    )


def test_no_candidates_is_one_line(site):
    grid, room = site.grid(), room_of()
    candidates = candidates_of(site, grid, room)
    with pytest.raises(InputError, match="no candidates; every mount is taken by a camera"):
        optimise(grid, room, candidates, existing=[c.camera for c in candidates], search=Search(1.0))


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: Goal(0.0), "share is 0 %"),
        (lambda: Goal(101.0), "share is 101 %"),
        (lambda: Goal(cameras=0), "0 cameras"),
        (lambda: Goal(cameras=5, by_price=True), "not both"),
        (lambda: sample_points(VoxelGrid((0, 0, 0), (2, 2, 2), 1.0), None, 0, 1), "0 points"),
    ],
)
def test_goals_that_are_none_are_refused(make, words):
    with pytest.raises(InputError, match=words):
        make()


def test_without_cp_sat_the_error_says_what_to_install(site, monkeypatch):
    monkeypatch.setitem(sys.modules, "ortools.sat.python.cp_model", None)
    grid, room = site.grid(), room_of()
    with pytest.raises(PackageError, match=r"-m pip install 'ortools"):
        optimise(grid, room, candidates_of(site, grid, room), search=Search(1.0))


def test_ties_are_the_same_in_both():
    model = model_of(np.ones((3, 1)), [0.0, 100.0, 200.0])
    assert Layout.of(model, range(3)).share == 1.0
    assert TIE_RAD == 1e-9
    assert Layout.of(model_of(np.ones((3, 1)), [0.0, 99.999, 200.0]), range(3)).share == 0.0


def test_a_wish_to_stop_ends_with_the_best_layout_so_far(site):
    grid, room = site.grid(), room_of()
    asked = threading.Event()
    asked.set()
    begun = time.perf_counter()
    done = optimise(
        grid,
        room,
        candidates_of(site, grid, room),
        goal=Goal(cameras=7),
        search=Search(600.0, 400, stop=asked.is_set),
    )
    assert time.perf_counter() - begun < 60 and len(done.cameras) <= 7 and done.found.valid_pct > 0
