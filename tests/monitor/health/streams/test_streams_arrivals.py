"""Whether the next image is overdue, counted pass by pass."""

from random import Random as random_of

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


@given(st.integers(1, 40).map(lambda n: 10 * n), st.integers(9, 20))
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


@given(st.integers(1_000, 10**9), st.integers(9, 20))
def test_where_the_monitor_stalled_and_the_image_is_there_nothing_is_late(stall_ms, many):
    *_, arrivals = heard([60] * many)
    after = arrivals.passing(stall_ms * MS, True)
    assert not after.is_overdue and after.waited_ns == 0
    # a single pass however long is no second of silence: the source is given another pass
    assert not arrivals.passing(stall_ms * MS, False).is_gone or MOST_A_PASS_NS >= 1_000 * MS


@given(st.integers(10, 20), st.integers(0, 8), st.integers(1, 3), st.integers(300, 2_000))
def test_stalls_of_the_monitor_lend_no_camera_more_time(many, at, stalls, stall_ms):
    """Whenever they were, also while it was learnt how often images come."""
    arrivals = Arrivals()
    for number in range(many):
        went_ms = stall_ms if at <= number < at + stalls else 60
        arrivals = arrivals.passing(went_ms * MS, True)
    assert arrivals.usual_ns == 60 * MS
    for waited_ms in range(10, 400, 10):
        arrivals = arrivals.passing(10 * MS, False)
        assert arrivals.is_overdue == (waited_ms * MS > OVERDUE_STEPS * 60 * MS)


def test_gaps_never_become_the_rule():
    *_, arrivals = heard([60] * 10 + [400] * 50)
    assert arrivals.usual_ns == 60 * MS


@given(st.integers(-(10**18), 10**18))
def test_a_clock_that_goes_back_or_far_ahead_makes_nothing_late_by_more_than_a_pass(went_ns):
    *_, arrivals = heard([60] * 9)
    assert 0 <= arrivals.passing(went_ns, False).waited_ns <= MOST_A_PASS_NS


@given(st.integers(0, 2**32 - 1), st.sampled_from([67, 100, 200]))
def test_single_images_that_are_lost_make_nothing_late_however_passes_fall(seed, step_ms):
    """As a bag is played: images with jitter, one in ten lost, never two in a row, and passes as long as they take."""
    random = random_of(seed)
    at_ms, next_ms, lost, arrivals = 0, step_ms, True, Arrivals()
    for _ in range(400):
        pass_ms = random.randint(5, 60)
        at_ms, is_new = at_ms + pass_ms, False
        while next_ms <= at_ms:
            lost = not lost and random.random() < 0.1
            is_new |= not lost
            next_ms += step_ms + random.randint(-2, 2)
        arrivals = arrivals.passing(pass_ms * MS, is_new)
        assert not arrivals.is_overdue


@given(st.integers(0, 2**32 - 1), st.integers(100, 30_000))
def test_a_stall_of_the_monitor_makes_no_camera_late(seed, stall_ms):
    """After it each camera's next image comes within a step, as ever."""
    random = random_of(seed)
    arrivals = Arrivals()
    for number in range(60):
        arrivals = arrivals.passing(33 * MS, number % 2 == 0)
    for _ in range(random.randint(0, 1)):
        arrivals = arrivals.passing(33 * MS, False)
    assert not arrivals.passing(stall_ms * MS, False).is_overdue
