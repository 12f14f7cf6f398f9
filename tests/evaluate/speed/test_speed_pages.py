"""What docs/benchmarks.md says of `elbowroom bench --all`."""

import sys
from pathlib import Path

import pytest

from elbowroom.evaluate.speed.questions import Asked, all_asked


@pytest.fixture
def asked(monkeypatch):
    monkeypatch.syspath_prepend(str(Path(__file__).parents[3] / "benchmarks"))
    from result_tables import asked

    yield asked
    for name in [name for name in sys.modules if name.partition(".")[0] == "result_tables"]:
        monkeypatch.delitem(sys.modules, name)


def row_of(case, median_ms):
    row = {key: getattr(case, key) for key in Asked.__slots__}
    row |= {"median_ms": median_ms, "p99_ms": median_ms + 1, "max_ms": median_ms + 2, "cause": "carve +2 ms"}
    balls = {"voxels": int(1000 * case.half_m**3), "surface_voxels": 10 * case.balls}
    return row | {"stages_ms": {"carve": 1.0}, "peak_rss_mb": 300.0} | (balls if case.balls else {})


def test_a_power_is_found(asked):
    assert asked.power_of([1, 2, 4, 8], [3, 6, 12, 24]) == pytest.approx(1)
    assert asked.power_of([1, 4, 16], [5, 10, 20]) == pytest.approx(0.5)


def test_the_page_says_what_is_due_and_how_cost_grows(asked):
    rows = [row_of(case, 10.0 * case.cameras) for case in all_asked()]
    rows.append(
        {"question": "others", "case": "OctoMap", "median_ms": 1.0, "times_as_long": 900.0, "rounds": 1}
    )
    text = "\n".join(asked.asked_tables(rows))
    assert "**211.0** (due ≤ 33: missed)" in text
    assert "**900.0** (due ≥ 1500: missed)" in text
    assert "Cost grows with cameras to the power of 1.00" in text
    assert "carve +2 ms" in text


def test_curves_are_a_picture(asked):
    rows = [row_of(case, 10.0 * case.cameras) for case in all_asked()]
    picture = asked.curves(rows)
    assert picture.lstrip().startswith(b"<?xml")
