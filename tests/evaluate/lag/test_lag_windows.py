"""Windows in which a motion should have stopped, beside when it did."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from elbowroom.evaluate.lag.windows import Window, needless_of, runs_of, share_pct, windows_of

MASKS = st.lists(st.booleans(), max_size=40).map(lambda given: np.array(given, dtype=bool))


def mask(text):
    return np.array([c == "#" for c in text])


@given(MASKS)
def test_runs_are_all_that_is_true_without_gaps(given_mask):
    again = np.zeros_like(given_mask)
    for first, last in runs_of(given_mask):
        assert last > first and (first == 0 or not given_mask[first - 1])
        again[first:last] = True
    assert (again == given_mask).all()


def test_a_window_is_missed_if_it_is_not_stopped_after_a_reaction_time():
    should = mask("..######..")
    for stopped, lag, is_missed in (
        ("..######..", 0, False),
        ("....####..", 2, False),
        (".....###..", 3, True),
        ("..##.###..", 0, False),
        ("..######..", 0, False),
        ("..####.#..", 0, True),
        ("..........", None, True),
        ("######....", 0, True),
    ):
        assert windows_of(should, mask(stopped), 3 if stopped == "..##.###.." else 2) == [
            Window(2, 8, lag, is_missed)
        ], stopped


def test_what_is_over_before_anybody_can_react_is_not_missed():
    assert windows_of(mask(".##."), mask("...."), 2) == [Window(1, 3, None, False)]
    assert windows_of(mask(".###"), mask("...."), 2) == [Window(1, 4, None, True)]


@given(MASKS, st.integers(0, 5), st.integers(0, 9999))
def test_who_stops_more_misses_no_more(should, reaction, seed):
    stopped = np.random.default_rng(seed).random(should.size) < 0.5
    more = stopped | (np.random.default_rng(seed + 1).random(should.size) < 0.3)
    for one, other in zip(
        windows_of(should, stopped, reaction), windows_of(should, more, reaction), strict=True
    ):
        assert other.is_missed <= one.is_missed
    assert not any(window.is_missed for window in windows_of(should, should, reaction))
    assert not needless_of(should, should, reaction)


def test_stops_for_nothing_are_those_that_nothing_was_in_the_way_of():
    should, stopped = mask("...##......"), mask("#.####..##.")
    # what ends later than it should have is no stop for nothing
    assert needless_of(should, stopped, 2) == [(0, 1), (8, 10)]
    # nor is what begins within a reaction time after it should have
    assert needless_of(mask("##....."), mask("...##.."), 2) == []
    assert needless_of(mask("##....."), mask("...##.."), 1) == [(3, 5)]
    assert share_pct([(0, 1), (8, 10)], 10) == 30
