import threading
import time

import pytest

from elbowroom.geometry.parallel import default_threads, spread, thread_count, threads


@pytest.mark.parametrize("count", [None, 1, 2, 5])
def test_results_come_in_order_whatever_the_threads(count):
    with threads(count):
        assert spread(lambda n: n * n, list(range(20))) == [n * n for n in range(20)]


def test_so_many_threads_hold_within_and_no_longer_and_none_leaves_them():
    assert thread_count() == default_threads()
    with threads(3):
        assert thread_count() == 3
        with threads(None):
            assert thread_count() == 3
        with pytest.raises(ValueError, match="away"), threads(1):
            raise ValueError("away")
        assert thread_count() == 3
    assert thread_count() == default_threads()


def test_who_works_for_another_works_with_his_threads_and_other_threads_do_not_hear_of_it():
    seen = []
    with threads(3):
        assert spread(lambda _: (time.sleep(0.01), thread_count())[1], range(9)) == [3] * 9
        stranger = threading.Thread(target=lambda: seen.append(thread_count()))
        stranger.start()
        stranger.join()
    assert seen == [default_threads()]


def test_as_many_threads_work_as_are_asked_for_and_the_caller_is_one_of_them():
    together = threading.Barrier(3, timeout=10)

    def work(_):
        together.wait()
        return threading.get_ident()

    with threads(3):
        seen = spread(work, range(3))
    assert len(set(seen)) == 3
    assert threading.get_ident() in seen


@pytest.mark.parametrize("count", [1, 2, 4])
def test_an_error_is_raised_and_nothing_is_begun_after_it(count):
    begun = []

    def work(n):
        begun.append(n)
        if n == 3:
            raise ValueError("three")
        time.sleep(0.01)
        return n

    with pytest.raises(ValueError, match="three"), threads(count):
        spread(work, range(100))
    assert len(begun) < 4 + 2 * count
    with threads(count):
        assert spread(lambda n: n, range(10)) == list(range(10))


def test_work_may_be_spread_within_work():
    with threads(2):
        inner = spread(lambda n: sum(spread(lambda m: n * m, range(5))), range(8))
    assert inner == [10 * n for n in range(8)]


def test_no_work_is_no_result():
    assert spread(lambda n: n, []) == []
    assert default_threads() >= 1
