"""Who meets whom: never farther apart than the limit, nor than a few of the camera's own steps, in any unit."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from elbowroom.sources.times.meeting import Meeting, gap_ns
from elbowroom.sources.times.series import Series, length_text, span_text

MS = 1_000_000
STAMPS = st.lists(st.integers(0, 1000), min_size=1, max_size=12, unique=True).map(sorted)


def meeting(max_skew_ns: int, **stamps) -> Meeting:
    return Meeting(tuple(Series(name, np.array(row)) for name, row in stamps.items()), max_skew_ns)


def naive(made: Meeting) -> list[list[int]]:
    """Image by image: the nearest, the earlier of two, if it is near enough."""
    found = []
    for row in made.series:
        index = []
        for lead in made.lead.stamps_ns.tolist():
            away = [abs(int(stamp) - lead) for stamp in row.stamps_ns]
            near = away.index(min(away)) if away else -1
            index.append(near if near >= 0 and away[near] <= made.limit_ns(row) else -1)
        found.append(index)
    return found


@given(STAMPS, STAMPS, STAMPS, st.integers(0, 300))
def test_of_each_camera_the_nearest_image_is_taken_if_it_is_near_enough(one, two, three, skew):
    made = meeting(skew, one=one, two=two, three=three)
    assert made.taken().tolist() == naive(made)
    assert (made.skews_ns() <= 2 * skew).all()


@given(STAMPS, STAMPS, st.integers(0, 300), st.sampled_from([1, 1_000, 1_000_000]))
def test_with_a_limit_that_says_nothing_the_unit_makes_no_difference(one, two, skew, unit):
    """What a limit in the wrong unit lets through, the cameras' own steps still keep out."""
    small, large = (
        Meeting(
            (Series("one", np.array(one) * factor), Series("two", np.array(two) * factor)),
            10**12 * factor,
            True,
        )
        for factor in (1, unit)
    )
    assert np.array_equal(small.taken(), large.taken())


def test_a_camera_that_died_is_no_part_of_what_came_later_though_the_limit_would_let_it():
    """Three cameras died at 5 s, the fourth went on; stamps and limit are a thousand times too short."""
    us = 1_000
    died = [0, 2_500 * us, 5_000 * us]
    made = meeting(50 * MS, ne=died, nw=died, sw=[*died, 27_000 * us, 29_500 * us], se=died)
    assert made.taken()[[0, 1, 3]].tolist() == [[0, 1, 2, -1, -1]] * 3
    assert made.too_many_steps(made.series[0]) == 2 and made.too_many_steps(made.lead) == 0


def test_where_the_unit_is_not_sure_an_image_is_of_its_nearest_moment_alone():
    """Microseconds with ten seconds between images look like nanoseconds of a camera with 100 images a second."""
    live, died = [n * 10 * MS for n in range(6)], [n * 10 * MS for n in range(3)]
    assert meeting(50 * MS, one=live, two=died).taken()[1].tolist() == [0, 1, 2, -1, -1, -1]
    later = 10**11
    sure = meeting(50 * MS, one=[later + n for n in live], two=[later + n for n in died])
    assert sure.taken()[1].tolist() == [0, 1, 2, 2, 2, 2]
    # half a step apart they still meet, and a camera half as fast meets all
    assert meeting(50 * MS, one=live, two=[n + 5 * MS for n in live]).taken()[1].tolist() == [
        0,
        0,
        1,
        2,
        3,
        4,
    ]
    assert (meeting(50 * MS, one=live, two=live[::2]).taken() >= 0).all()


def test_a_camera_without_images_is_no_part_of_any_moment():
    assert meeting(5, one=[1, 2], none=[]).taken().tolist() == [[0, 1], [-1, -1]]


def test_a_gap_is_longer_than_what_is_usual():
    assert gap_ns(None) == gap_ns(33 * MS) == 5_000 * MS
    assert gap_ns(1_000 * MS) == 20_000 * MS
    assert gap_ns(60_000 * MS) == 60_000 * MS
    assert meeting(0, one=[0, 500 * MS, 3_600_000 * MS]).gap_ns == 10_000 * MS


def test_times_are_said_as_people_say_them():
    assert span_text(5_000 * MS, 5_500 * MS) == "5.000 s to 5.500 s"
    epoch = 1_700_000_000_000 * MS
    assert span_text(epoch, epoch + 500 * MS) == "2023-11-14 22:13:20.000 to 22:13:20.500 UTC"
    assert span_text(epoch, epoch) == "2023-11-14 22:13:20.000 UTC"
    assert [length_text(ns) for ns in (8 * MS, 12_500 * MS, 3_599_500 * MS, epoch)] == [
        "8 ms", "12.5 s", "60 min 0 s", "54 years",
    ]  # fmt: skip
