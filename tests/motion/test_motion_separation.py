"""Separation distances: plain sums of their terms."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from elbowroom.errors import InputError
from elbowroom.motion.separation import ARM_M, Separation, intrusion_of

ARM = Separation(
    speeds_m_s={"hand": 1.5, "base": 0.2},
    stopping_m={"hand": 0.3, "base": 0.05},
    stopping_time_s=0.5,
    intrusion_m=0.85,
    person_m=0.04,
    machine_m=0.01,
)


def test_the_terms_of_iso_10218_2_add_up():
    # S_h = 1.6 (0.2 + 0.5), S_r = 1.5 0.2, S_s = 0.3, C = 0.85, Z = 0.05
    assert ARM.from_person_m("hand", 0.2) == pytest.approx(1.12 + 0.3 + 0.3 + 0.85 + 0.05)
    assert ARM.from_standing_m("hand", 0.2) == pytest.approx(0.3 + 0.3 + 0.05)
    assert ARM.from_standing_m("base", 0.2) == pytest.approx(0.04 + 0.05 + 0.05)


def test_the_terms_of_iso_13855_add_up():
    assert ARM.fixed_m(0.2, 1.6) == pytest.approx(1.6 * 0.7 + 0.85 + 0.05)
    assert ARM.required_fixed_m(0.2) == pytest.approx(1.6 * 0.7 + 0.9)
    quick = Separation(stopping_time_s=0.05, intrusion_m=0.0)
    assert quick.required_fixed_m(0.1) == pytest.approx(2.0 * 0.15)
    # by hands just above half a metre, by bodies below it: half a metre
    assert quick.required_fixed_m(0.21) == 0.5


@given(st.floats(0, 2), st.floats(0, 2))
def test_whoever_reacts_later_has_to_stay_farther(one, other):
    early, late = sorted((one, other))
    for of in (ARM.from_standing_m, ARM.from_person_m):
        assert of("hand", early) <= of("hand", late)
    assert ARM.from_standing_m("hand", early) < ARM.from_person_m("hand", early)
    assert ARM.required_fixed_m(early) <= ARM.required_fixed_m(late)


def test_a_hand_that_is_noticed_reaches_less_far_than_an_arm():
    assert intrusion_of(0.014) == intrusion_of(0.001) == 0
    assert intrusion_of(0.03) == pytest.approx(0.128)
    assert intrusion_of(0.041) == ARM_M == 0.85


@pytest.mark.parametrize(
    "wrong",
    [{"walking_m_s": 0.0}, {"reaching_m_s": float("nan")}, {"intrusion_m": -0.1}, {"person_m": float("inf")}],
)
def test_figures_that_cannot_be_are_refused(wrong):
    with pytest.raises(InputError, match=next(iter(wrong))):
        Separation(**wrong)
