import math
from dataclasses import replace

import numpy as np
import pytest

from elbowroom.errors import CameraError
from elbowroom.page.plan.figures import SHARE_PCT, Reckoner, no_more_than
from elbowroom.page.plan.layout import Layout, PlacedPerson
from elbowroom.page.plan.planner import Planner
from elbowroom.page.plan.price import bill_of
from elbowroom.page.plan.stale import Stale
from elbowroom.placement import Settings, capability, rehearse, verify


def fresh(ground, layout):
    return Reckoner(ground, True).figures(layout)


def layouts(ground):
    """A plan as hands change it, step by step."""
    planner = Planner(ground)
    yield planner.layout
    pose = planner.layout.camera("a").camera.world_from_camera.copy()
    pose[2, 3] -= 0.7
    planner.place_camera("a", pose)
    yield planner.layout
    planner.add_person((0.2, -0.3))
    yield planner.layout
    planner.move("person 1", (-0.4, -0.2), 1.0)
    yield planner.layout
    planner.add_thing("cabinet")
    planner.move("cabinet 1", (-0.3, 0.4), 0.4)
    yield planner.layout
    planner.choose_sensor("b", "wide")
    yield planner.layout
    planner.add_camera("wide")
    yield planner.layout
    planner.remove_camera("c")
    planner.remove("cabinet 1")
    yield planner.layout
    planner.undo()
    yield planner.layout


def test_exact_figures_are_those_of_verify_capability_and_rehearse(ground) -> None:
    planner = Planner(ground)
    planner.add_person((0.2, -0.3))
    planner.add_thing("box")
    layout, reckoner = planner.layout, Reckoner(ground, True)
    figures = reckoner.figures(layout)
    cameras = [placed.camera for placed in layout.cameras]
    fixed = ground.fixed_with(layout)
    found = verify(reckoner.grid, cameras, fixed, ground.requirement)
    assert figures.valid_pct == found.valid_pct and figures.seen_pct == found.seen_pct(1)
    assert figures.smallest_mm == pytest.approx(capability(found, 1).percentile_mm(SHARE_PCT), rel=1e-6)
    settings = Settings(reckoner.grid, ground.terms)
    used = rehearse(cameras, [ground.moment_of(layout, fixed)], settings, by_camera=False)
    assert figures.free_pct == used.free_pct
    assert 0 < figures.valid_pct < figures.seen_pct and 0 < figures.free_pct < 100
    assert figures.is_exact and figures.voxel_size_m == ground.grid.voxel_size_m


@pytest.mark.parametrize("is_exact", [True, False])
def test_what_is_kept_from_one_layout_to_the_next_changes_no_figure(ground, is_exact) -> None:
    kept, seen = Reckoner(ground, is_exact), set()
    for layout in layouts(ground):
        figures = kept.figures(layout)
        assert figures == Reckoner(ground, is_exact).figures(layout)
        seen.add((figures.valid_pct, figures.free_pct, figures.price))
    assert len(seen) >= 6  # each of these deeds changes something, undo apart


def test_the_price_is_that_of_the_bill(ground) -> None:
    planner = Planner(ground)
    rows = bill_of(ground, planner.layout)
    assert [row["sensor_price"] for row in rows] == [100, 100, 100, 100, 400]
    pose = planner.layout.camera("a").camera.world_from_camera.copy()
    pose[:3, 3] = (0.0, 0.0, 2.1)
    planner.place_camera("a", pose)
    (at_beam, *_) = bill_of(ground, planner.layout)
    assert (at_beam["mount_price"], at_beam["cable_m"], at_beam["price"]) == (7, 3, 100 + 7 + 2 * 3)
    planner.choose_sensor("a", "wide")
    assert fresh(ground, planner.layout).price == pytest.approx(
        sum(row["price"] for row in bill_of(ground, planner.layout)[:-1])
    )


def test_a_plan_without_cameras_sees_nothing(ground) -> None:
    figures = fresh(ground, Layout())
    assert (figures.seen_pct, figures.valid_pct, figures.free_pct, figures.cameras) == (0, 0, 0, 0)
    assert math.isinf(figures.smallest_mm)


def test_a_camera_inside_furniture_is_refused_by_name_and_what_follows_is_right_again(ground) -> None:
    planner, reckoner = Planner(ground), Reckoner(ground, True)
    before = reckoner.figures(planner.layout)
    pose = planner.layout.camera("d").camera.world_from_camera.copy()
    pose[:3, 3] = (0.8, 0.8, 0.8)
    planner.place_camera("d", pose)
    with pytest.raises(CameraError, match=r"d: .*shelf"):
        reckoner.figures(planner.layout)
    planner.undo()
    assert reckoner.figures(planner.layout) == before


def test_work_that_nobody_wants_is_given_up_and_can_be_done_later(ground) -> None:
    planner, reckoner = Planner(ground), Reckoner(ground, True)
    asked = iter([False, True])
    with pytest.raises(Stale):
        reckoner.figures(planner.layout, lambda: next(asked))
    assert reckoner.figures(planner.layout) == fresh(ground, planner.layout)


def test_someone_in_the_way_lessens_what_is_found_free(ground) -> None:
    empty = Planner(ground).layout
    people = tuple(PlacedPerson(f"p{n}", x, y) for n, (x, y) in enumerate([(0.0, 0.0), (-0.5, 0.3)]))
    assert fresh(ground, replace(empty, people=people)).free_pct < fresh(ground, empty).free_pct


def test_voxels_are_made_larger_only_where_there_are_too_many(ground) -> None:
    assert no_more_than(8000, ground.grid) is ground.grid
    coarse = no_more_than(1000, ground.grid)
    np.testing.assert_allclose([coarse.lower_m, coarse.upper_m], [ground.grid.lower_m, ground.grid.upper_m])
    assert np.prod(coarse.shape) <= 1000 * 1.3
