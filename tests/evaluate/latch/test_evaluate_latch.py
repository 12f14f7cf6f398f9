"""The experiment with the latch: it finds none lost, and it would find one."""

import random
from pathlib import Path

import pytest

from elbowroom.evaluate.due import due_of
from elbowroom.evaluate.latch import latch as experiment
from elbowroom.evaluate.latch.journal import is_kept, is_named, truth_after
from elbowroom.evaluate.latch.killing import row_of
from elbowroom.evaluate.latch.latch import DUE, latch_rows, latch_summary, wrong_rows
from elbowroom.guard import latch
from elbowroom.guard.fault import Fault
from elbowroom.guard.reason import Reason

LATE, BROKEN, UNCLEAN = Fault(Reason.STALE), Fault(Reason.FAULT), Fault(Reason.UNCLEAN_END)


def test_no_latch_is_lost() -> None:
    rows = list(latch_rows(25))
    summary = latch_summary(rows)
    assert [row["case"] for row in summary] == ["killed", "cut off", "one bit changed", "older"]
    for row in summary:
        assert row["times"] == row["kept"] == 25
        assert all(due_of(DUE, key).met(row) for key in ("lost", "unnamed"))
    assert summary[0]["after_latching"] > 2  # some had said what they had latched
    assert wrong_rows(rows) == []


def test_a_latch_that_forgets_is_found(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    def unlatched(path: Path, site: str) -> latch.Kept:
        return latch.Kept(())

    monkeypatch.setattr(experiment, "read_latch", unlatched)
    chance = random.Random(1)
    rows = [*experiment._files(tmp_path / "a", 20, chance), *experiment._older(tmp_path, 20, chance)]
    assert all(row["lost"] == 20 for row in latch_summary(rows))
    assert len(wrong_rows(rows)) == 60


@pytest.mark.parametrize(
    ("before", "lines", "kept", "is_right"),
    [
        ((), ["begun", "fault STALE"], (LATE,), True),
        ((), ["begun", "fault STALE"], (), False),
        ((), ["begun", "fault STALE", "fault FAULT"], (LATE,), False),
        ((), [], (), True),  # killed before it had begun: nothing could move
        ((), ["begun"], (), False),
        ((), ["begun"], (UNCLEAN,), True),
        ((LATE,), [], (LATE,), True),
        ((LATE,), [], (UNCLEAN,), False),
        ((LATE,), ["begun", "asked"], (UNCLEAN,), True),
        ((LATE,), ["begun", "asked"], (), False),
        ((LATE,), ["begun", "asked", "refused"], (UNCLEAN,), False),
        ((LATE,), ["begun", "asked", "reset"], (UNCLEAN,), True),
        ((LATE,), ["begun", "asked", "reset"], (), False),
        ((LATE,), ["begun", "asked", "reset", "ending"], (), True),
        ((LATE,), ["begun", "ending"], (), False),
        ((LATE,), ["begun", "asked", "reset", "ending", "ended"], (), True),
        ((LATE,), ["begun", "asked", "reset", "ending", "ended", "begun", "fault FAULT"], (BROKEN,), True),
        ((LATE,), ["begun", "asked", "reset", "ending", "ended", "begun", "fault FAULT"], (), False),
        ((LATE,), ["begun", "ending", "ended", "begun", "fault FAULT"], (BROKEN,), False),
    ],
)
def test_what_may_be_read_after_a_kill(
    before: tuple[Fault, ...], lines: list[str], kept: tuple[Fault, ...], is_right: bool
) -> None:
    row = row_of(before, lines, kept)
    assert (row["kept"] and row["named"]) == is_right


def test_doubt_is_over_when_the_reset_is_answered() -> None:
    assert is_named(truth_after((LATE,), ["begun", "asked"]), ())
    assert not is_named(truth_after((LATE,), ["begun", "asked", "refused"]), ())
    assert is_kept(truth_after((), ["begun", "ending"]), ())
    with pytest.raises(ValueError, match="no line"):
        truth_after((), ["hello"])
