"""What ages and own links cost a pass: four cases by turns, each beside the one with neither."""

from elbowroom.evaluate.speed.laws import CASES, DUE, law_rows
from elbowroom.evaluate.speed.questions import HEADLINE, Asked


def test_each_case_stands_beside_the_one_with_neither():
    asked = Asked(HEADLINE, voxel_size_m=0.1, cameras=3, width=32, height=24)
    rows = list(law_rows(asked, rounds=2))
    assert [row["case"] for row in rows] == [case.name for case in CASES]
    assert rows[0]["share"] == 1.0
    for row in rows:
        assert row["share"] == row["median_ms"] / rows[0]["median_ms"] and row["p99_ms"] <= row["max_ms"]
    assert [bool(DUE[0].of(row)) for row in rows] == [False, False, False, True]
