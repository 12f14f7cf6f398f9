"""Things that move past cameras of unlike age: what is measured of them."""

import numpy as np
import pytest

from elbowroom.evaluate.skew import moving, price
from elbowroom.evaluate.skew.exposures import NOW_S, ages_ms, exposed, falsely_free, free_between_rays
from elbowroom.simulate import wall_cameras


@pytest.fixture(scope="module")
def scenes():
    ball, other, walker, faster = moving._scenes(1, 3)
    return {"ball": ball, "other": other, "walker": walker, "faster": faster}


def test_things_go_as_fast_as_is_said_and_limbs_faster(scenes):
    assert scenes["ball"].fastest_m_s == pytest.approx(1.6, rel=1e-3)
    assert scenes["other"].fastest_m_s == pytest.approx(2.0, rel=1e-3)
    assert 1.6 < scenes["walker"].fastest_m_s < 6.0
    one, two = (scenes["faster"].at(NOW_S + step)[0].world_from_solid[:3, 3] for step in (0.0, 0.5))
    assert np.linalg.norm(two - one) == pytest.approx(0.8)


def test_ages_are_evenly_spread_from_none_to_all():
    ages = ages_ms(5, 100.0, 3)
    np.testing.assert_allclose(sorted(ages), (0, 25, 50, 75, 100))
    assert list(ages) != sorted(ages)


def test_what_moves_is_declared_free_without_the_law_and_never_with_it(scenes):
    cameras = wall_cameras(8, (2.4, 0.4))
    ages = ages_ms(8, 100.0, 1)
    rows = list(falsely_free(scenes["ball"], cameras, exposed(scenes["ball"], cameras, ages, False), ages))
    false = {
        law: sum(r["false_free_voxels"] for r in rows if r["law_m_s"] == law) for law in (0.0, 1.6, 2.0, 5.5)
    }
    assert false[0.0] > 100 and false[1.6] == false[2.0] == false[5.5] == 0
    due = moving.DUE[0]
    said = {"what": "ball", "speed_m_s": 1.6, "fastest_m_s": 1.6, "noise": False, "spread_ms": 100.0}
    summary = moving.moving_summary([{**said, **row} for row in rows])
    assert all(due.met(row) for row in summary if due.of(row)) and any(due.of(row) for row in summary)


def test_what_lies_between_rays_is_free_without_a_margin_to_the_side_alone(scenes):
    cameras = wall_cameras(8, (2.4, 0.4))
    frames = exposed(scenes["walker"], cameras, np.zeros(8), False)
    rows = list(free_between_rays(scenes["walker"], cameras, frames))
    said = {"what": "walker", "speed_m_s": 1.2, "fastest_m_s": 4.0}
    summary = moving.moving_summary([{**said, **row} for row in rows])
    assert [row["lateral_px"] for row in summary] == [0.0, 0.25, 0.5]
    due = moving.DUE[1]
    assert [due.of(row) for row in summary] == [False, True, True]
    assert all(due.met(row) for row in summary[1:]) and not moving.DUE[0].of(summary[1])


def test_the_price_is_points_of_found_that_ages_take():
    rows = list(price.price_rows(0.2, draws=1, spreads_ms=(17.0, 133.0)))
    assert {row["room"] for row in rows} == {"simulated room"}
    by_spread = {
        r["spread_ms"]: r["price_points"] for r in rows if r["detail"] == "pixel" and r["law_m_s"] == 1.6
    }
    assert 0 <= by_spread[17.0] <= by_spread[133.0]
    assert by_spread[133.0] > 0
