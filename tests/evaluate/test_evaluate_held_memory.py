"""Memory that grows is told from memory that only moves."""

import mmap

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from elbowroom.evaluate.held_memory import (
    BLOCK_S,
    FEWEST,
    SETTLES,
    Watched,
    resident_mb,
    slope_of,
    words_of_slope,
)

TIMES_S = np.arange(1800.0)


@settings(max_examples=30)
@given(st.floats(5.0, 500.0), st.integers(0, 2**32 - 1))
def test_a_leak_is_found_and_its_size_is_within_the_interval(mb_per_hour, seed):
    held = 500 + TIMES_S / 3600 * mb_per_hour + np.random.default_rng(seed).normal(size=1800) * 0.2
    found = slope_of(TIMES_S, held)
    assert found is not None and found.low > 0
    assert found.mb_per_hour == pytest.approx(mb_per_hour, rel=0.15)


@settings(max_examples=30)
@given(st.floats(0.0, 300.0), st.sampled_from([3.7, 11.3, 29.1, 61.7]), st.integers(0, 2**32 - 1))
def test_what_fills_at_first_or_goes_up_and_down_is_no_leak(fill_mb, period_s, seed):
    filling = fill_mb * np.minimum(TIMES_S / (SETTLES * TIMES_S[-1]), 1)
    teeth = 20 * (TIMES_S % period_s) / period_s
    noise = np.random.default_rng(seed).normal(size=1800)
    found = slope_of(TIMES_S, 400 + filling + teeth + noise)
    assert found is not None and abs(found.mb_per_hour) < 4 and found.low < 1


def test_a_run_that_is_too_short_says_nothing():
    short = np.arange((FEWEST - 1) * BLOCK_S)
    assert slope_of(short, 500 + short) is None and slope_of([], []) is None
    assert words_of_slope({"slope_mb_per_hour": None}) == ""


def test_looks_are_a_second_apart_and_the_row_says_what_came_of_them():
    watched = Watched(100.0)
    assert watched.newest_mb is None
    kept = []
    for now_s in np.arange(0, 10, 0.1):
        watched.look(float(now_s))
        if now_s > 5 and not kept:
            kept.append(
                mmap.mmap(-1, 50_000_000)
            )  # of the system: an allocator may have some left, of other tests
            np.frombuffer(kept[0], np.uint8)[:] = 1
    held = resident_mb()
    if held is None:
        pytest.skip("this system does not say what a process holds")
    assert watched._many == 10
    table = watched._table[:10]
    assert table[9, 1] - table[3, 1] == pytest.approx(50, abs=15)
    assert watched.row()["resident_mb"] == watched.newest_mb and watched.row()["grows"] is None
