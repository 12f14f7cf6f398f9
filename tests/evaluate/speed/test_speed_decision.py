"""Exposure to decision: measured through the whole monitor, with the cause of the worst."""

from elbowroom.evaluate.speed.decision import DUE, decision_rows, words_of_worst


def test_a_short_run_measures_the_whole_way():
    together = next(decision_rows(0.5, cameras=2, size=(32, 24)))
    assert together["case"] == "exposed together" and together["passes"] >= 2
    assert 0 < together["median_ms"] <= together["p99_ms"] <= together["max_ms"]
    assert {"age_ms", "carve", "motion", "distances"} <= together["worst"].keys()
    # the small room has nothing that is due, the whole one has
    assert not DUE[0].of(together)
    assert DUE[0].of({**together, "cameras": 21, "width": 640, "height": 480})
    assert (
        words_of_worst({"worst": {"age_ms": 12.3, "carve": 40.0, "watch": 0.2, "late": None}})
        == "carve 40, age 12"
    )
