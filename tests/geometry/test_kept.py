"""Values kept per object: made once, also by many threads, and gone with the object."""

import gc
import threading
import weakref

import pytest

from elbowroom.geometry.kept import kept


class Owner:
    pass


class Made:
    pass


def test_a_value_is_made_once_for_each_object_and_key():
    made = []

    @kept
    def value(owner, key):
        made.append((owner, key))
        return Made()

    one, other = Owner(), Owner()
    assert value(one, 1) is value(one, 1)
    assert len({id(value(owner, key)) for owner in (one, other) for key in (1, 2)}) == 4
    assert len(made) == 4


def test_a_value_goes_with_its_object():
    @kept
    def value(owner):
        return Made()

    owner = Owner()
    there = weakref.ref(value(owner))
    gc.collect()
    assert there() is not None
    del owner
    gc.collect()
    assert there() is None


def test_threads_wait_for_the_one_that_makes_it():
    begun, made = threading.Barrier(4), []

    @kept
    def value(owner):
        made.append(threading.current_thread())
        return Made()

    def ask(owner, values):
        begun.wait()
        values.append(value(owner))

    owner, values = Owner(), []
    threads = [threading.Thread(target=ask, args=(owner, values)) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert len(made) == 1
    assert len({id(v) for v in values}) == 1


def test_what_cannot_be_made_is_tried_again():
    tries = []

    @kept
    def value(owner):
        tries.append(owner)
        if len(tries) == 1:
            raise ValueError("not yet")
        return 5

    owner = Owner()
    with pytest.raises(ValueError, match="not yet"):
        value(owner)
    assert value(owner) == 5
