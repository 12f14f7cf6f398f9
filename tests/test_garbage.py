"""What collections of garbage leave alone, and when there are none."""

import gc
import weakref

import pytest

from elbowroom.garbage import uncollected, what_is_here_stays


class Knot:
    """Refers to itself, so that only a collection finds that nobody else does."""

    def __init__(self):
        self.own = self


@pytest.fixture(autouse=True)
def collecting():
    gc.enable()
    yield
    gc.enable()


def test_nothing_is_collected_within_and_all_is_afterwards():
    with uncollected():
        assert not gc.isenabled()
    assert gc.isenabled()


def test_who_collects_no_garbage_is_left_so():
    gc.disable()
    with uncollected(), uncollected():
        assert not gc.isenabled()
    assert not gc.isenabled()


def test_an_error_ends_it_too():
    with pytest.raises(ValueError), uncollected():
        raise ValueError
    assert gc.isenabled()


def test_what_is_here_stays_and_what_comes_goes():
    here = weakref.ref(Knot())
    with what_is_here_stays():
        came = weakref.ref(Knot())
        gc.collect()
        assert here() is not None and came() is None
    gc.collect()
    assert here() is None
