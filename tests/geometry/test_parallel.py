import pytest

from elbowroom.geometry.parallel import default_threads, spread


@pytest.mark.parametrize("threads", [None, 1, 2, 5])
def test_results_come_in_order_whatever_the_threads(threads):
    assert spread(lambda n: n * n, list(range(20)), threads) == [n * n for n in range(20)]


@pytest.mark.parametrize("threads", [1, 2])
def test_an_error_of_one_part_is_the_error_of_the_whole(threads):
    def work(n):
        if n == 3:
            raise ValueError("part 3")
        return n

    with pytest.raises(ValueError, match="part 3"):
        spread(work, list(range(5)), threads)


def test_no_work_is_no_result():
    assert spread(lambda n: n, [], 4) == []
    assert default_threads() >= 1
