"""Whether the next image is overdue, counted pass by pass."""

from hypothesis import given
from hypothesis import strategies as st

from elbowroom.monitor.health.streams.arrivals import MOST_A_PASS_NS, OVERDUE_NS, OVERDUE_STEPS, Arrivals

MS = 1_000_000


def heard(steps_ms, passes_ms=10):
    """A source that gave something after each of these times, looked at every so often."""
    arrivals = Arrivals()
    for step_ms in (passes_ms, *steps_ms):
        for at_ms in range(passes_ms, step_ms + 1, passes_ms):
            arrivals = arrivals.passing(passes_ms * MS, at_ms == step_ms)
            yield arrivals


@given(st.lists(st.integers(4, 9).map(lambda n: 10 * n), min_size=8, max_size=60))
def test_images_that_come_with_jitter_are_never_overdue(steps_ms):
    assert not any(arrivals.is_overdue or arrivals.is_gone for arrivals in heard(steps_ms))


@given(st.integers(1, 40).map(lambda n: 10 * n), st.integers(4, 20))
def test_what_stops_is_overdue_after_the_limit_and_gone_after_a_longer_one(step_ms, many):
    *_, arrivals = heard([step_ms] * many)
    limit_ns = max(OVERDUE_NS, OVERDUE_STEPS * step_ms * MS)
    gone = False
    for _ in range(600):
        arrivals = arrivals.passing(10 * MS, False)
        assert arrivals.is_overdue == (arrivals.waited_ns > limit_ns)
        assert arrivals.is_gone >= gone
        gone = arrivals.is_gone
    assert gone


@given(st.integers(1_000, 10**9), st.integers(4, 20))
def test_where_the_monitor_stalled_and_the_image_is_there_nothing_is_late(stall_ms, many):
    *_, arrivals = heard([60] * many)
    after = arrivals.passing(stall_ms * MS, True)
    assert not after.is_overdue and after.waited_ns == 0
    # a single pass however long is no second of silence: the source is given another pass
    assert not arrivals.passing(stall_ms * MS, False).is_gone or MOST_A_PASS_NS >= 1_000 * MS


def test_gaps_never_become_the_rule():
    *_, arrivals = heard([60] * 10 + [400] * 50)
    assert arrivals.usual_ns == 60 * MS


@given(st.integers(-(10**18), 10**18))
def test_a_clock_that_goes_back_or_far_ahead_makes_nothing_late_by_more_than_a_pass(went_ns):
    *_, arrivals = heard([60] * 6)
    assert 0 <= arrivals.passing(went_ns, False).waited_ns <= MOST_A_PASS_NS
