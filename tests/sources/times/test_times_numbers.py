"""Numbers in names order images as numbers, and those of one moment agree."""

from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from elbowroom.errors import SiteError
from elbowroom.sources.times.numbers import counters, natural, padding_findings, require_agreement

SITE = Path("room.yaml")


def row(*names) -> list[Path]:
    return [Path(str(name)).with_suffix(".png") for name in names]


def refusal(**rows) -> str:
    with pytest.raises(SiteError) as caught:
        require_agreement(SITE, rows)
    assert "\n" not in str(caught.value)
    return str(caught.value)


@given(st.lists(st.integers(0, 10**12), unique=True, min_size=1), st.sampled_from(["", "depth_", "cam1_"]))
def test_numbers_are_in_order_as_numbers(numbers, prefix):
    paths = [Path(f"{prefix}{number}.png") for number in numbers]
    assert sorted(paths, key=natural) == [Path(f"{prefix}{number}.png") for number in sorted(numbers)]


def test_padded_names_are_in_the_order_that_they_had():
    paths = [Path(f"rec/cam1_{n:03d}.depth.png") for n in range(120)]
    assert sorted(paths, key=natural) == sorted(paths)


def test_what_counts_is_the_number_that_changes():
    assert counters(row("cam1_07", "cam1_08")).tolist() == [7, 8]
    assert counters(row("a", "b")) is None and counters(row("7")) is None
    assert counters(row("a1_b1", "a2_b2")) is None
    dates = row("2023-11-14_22-13-20_999", "2023-11-14_22-13-21_032")
    assert (counters(dates)[1] - counters(dates)[0]) == 33_000


@pytest.mark.parametrize(
    "other",
    [
        row("00", "01", "02", "09", "10"),
        row(*(f"b{n}" for n in (0, 1, 2, 9, 10))),
        row(*"vwxyz"),
    ],
)
def test_names_that_agree_are_not_refused(other):
    require_agreement(SITE, {"one": row(0, 1, 2, 9, 10), "two": other})


def test_times_in_names_may_differ_by_less_than_half_a_step():
    stamps = [1_700_000_000_000 + 33 * n for n in range(10)]
    require_agreement(SITE, {"one": row(*stamps), "two": row(*(stamp + 12 for stamp in stamps))})
    assert "these look like times: say layout: folder" in refusal(
        one=row(*stamps), two=row(*(stamp + 33 for stamp in stamps))
    )
    dates = row(*(f"20231114_2213{20 + n}_500" for n in range(5)))
    require_agreement(SITE, {"one": dates, "two": row(*(f"20231114_2213{20 + n}_483" for n in range(5)))})


@pytest.mark.parametrize(
    ("one", "two", "words"),
    [
        (row(0, 1, 2), row(1, 2, 3), "images of moment 0 are 0.png of camera one and 1.png of camera two: one counts"),
        (row(0, 1, 2, 3), row(0, 1, 3, 4), "moment 2 are 2.png of camera one and 3.png of camera two: two lacks 2"),
        (row(0, 1, 2, 3), row(0, 1, 3), "frames per camera are one 4, two 3; without times they must be as many: two"),
        (row(8, "08", 9), row(7, 8, 9), "8.png and 08.png of camera one have one number"),
    ],
)  # fmt: skip
def test_names_that_disagree_are_refused_with_camera_and_image(one, two, words):
    assert words in refusal(one=one, two=two)


def test_what_is_listed_one_by_one_belongs_together_by_the_site_s_word():
    require_agreement(SITE, {"one": row(0, 1, 2), "two": row(5, 6, 7)}, listed=["two"])


def test_another_padding_is_said():
    (finding,) = padding_findings({"one": row(8, 9, 10), "two": row("08", "09", "10")})
    assert "writes" in finding.text and not finding.stops
    assert padding_findings({"one": row(8, 9, 10), "two": row(*(f"b{n}" for n in (8, 9, 10)))}) == ()
