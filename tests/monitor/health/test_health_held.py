"""A cause comes with its evidence, and goes with its own evidence alone."""

from hypothesis import given
from hypothesis import strategies as st

from elbowroom.monitor.health.held import Held

SIGNS = st.lists(st.sampled_from([True, False, None]), max_size=60)
COUNTS = st.integers(1, 5)


def naive(signs, after, clears_after):
    """Whether the cause is there after each sign, by a look at all signs that could tell."""
    there, told, answers = False, [], []
    for sign in signs:
        if sign is not None:
            told.append(sign)
        if sign and len(told) >= after and all(told[-after:]):
            there = True
        if sign is False and len(told) >= clears_after and not any(told[-clears_after:]):
            there = False
        answers.append(there)
    return answers


@given(SIGNS, COUNTS, COUNTS)
def test_it_is_there_as_a_plain_look_at_all_signs_says(signs, after, clears_after):
    held, answers = Held(after, clears_after), []
    for sign in signs:
        held = held.hearing(sign)
        answers.append(held.is_there)
    assert answers == naive(signs, after, clears_after)


@given(SIGNS, COUNTS, COUNTS)
def test_what_cannot_tell_changes_nothing(signs, after, clears_after):
    held = Held(after, clears_after)
    for sign in signs:
        held = held.hearing(sign)
    assert held.hearing(None) == held


@given(COUNTS, st.lists(st.sampled_from([True, None]), max_size=20))
def test_without_one_good_sign_it_never_goes(clears_after, signs):
    held = Held(1, clears_after).hearing(True)
    for sign in signs:
        held = held.hearing(sign)
        assert held.is_there
