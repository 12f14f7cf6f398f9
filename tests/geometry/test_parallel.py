import threading
import time

import pytest

from elbowroom.geometry.parallel import default_threads, spread


@pytest.mark.parametrize("threads", [None, 1, 2, 5])
def test_results_come_in_order_whatever_the_threads(threads):
    assert spread(lambda n: n * n, list(range(20)), threads) == [n * n for n in range(20)]


def test_as_many_threads_work_as_are_asked_for_and_the_caller_is_one_of_them():
    together = threading.Barrier(3, timeout=10)

    def work(_):
        together.wait()
        return threading.get_ident()

    seen = spread(work, range(3), 3)
    assert len(set(seen)) == 3
    assert threading.get_ident() in seen


@pytest.mark.parametrize("threads", [1, 2, 4])
def test_an_error_is_raised_and_nothing_is_begun_after_it(threads):
    begun = []

    def work(n):
        begun.append(n)
        if n == 3:
            raise ValueError("three")
        time.sleep(0.01)
        return n

    with pytest.raises(ValueError, match="three"):
        spread(work, range(100), threads)
    assert len(begun) < 4 + 2 * threads
    assert spread(lambda n: n, range(10), threads) == list(range(10))


def test_work_may_be_spread_within_work():
    inner = spread(lambda n: sum(spread(lambda m: n * m, range(5), 2)), range(8), 2)
    assert inner == [10 * n for n in range(8)]


def test_no_work_is_no_result():
    assert spread(lambda n: n, [], 4) == []
    assert default_threads() >= 1
