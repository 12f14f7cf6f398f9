"""`elbowroom bench start`: new processes, this tree and another in turns."""

import json

import pytest

from elbowroom.cli import run
from elbowroom.errors import InputError
from elbowroom.evaluate.speed import start

STEPS = ("import", "values", "first", "second", "to_answer")
KEYS = tuple(f"{step}_ms" for step in STEPS)


def test_a_process_answers_and_its_times_add_up():
    times = start._started("alone", start.HERE)
    assert all(times[key] > 0 for key in KEYS)
    assert times["to_answer_ms"] == pytest.approx(sum(times[key] for key in KEYS[:3]))


def test_a_process_that_fails_is_named_with_its_last_line(tmp_path):
    (tmp_path / "elbowroom.py").write_text("raise RuntimeError('no such package')")
    with pytest.raises(InputError, match=r"ended with 1: RuntimeError: no such package"):
        start._started("alone", tmp_path)


@pytest.fixture
def started(monkeypatch):
    calls = []

    def answer(what, tree):
        calls.append((what, tree.name))
        ms = 100.0 if tree == start.HERE else 400.0
        return dict.fromkeys(
            [f"{step}{kind}_ms" for step in STEPS for kind in ("", "_cpu")], ms + len(calls) / 100
        )

    monkeypatch.setattr(start, "_started", answer)
    return calls


def test_trees_take_turns_and_a_first_call_is_due_in_a_third(started, tmp_path):
    rows = list(start.start_rows(3, tmp_path))
    assert [what for what, _ in started] == ["alone", "machine", "readme"] * 2 * 4
    assert {row["rounds"] for row in rows} == {3}
    for row in rows:
        assert 100 < row["median_ms"] <= row["p99_ms"] <= row["max_ms"] < 101 < row["before_ms"] < 401
        asked = [due for due in start.DUE if due.of(row)]
        assert bool(asked) == row["case"].startswith("first call")
        assert all(due.met(row) for due in asked)


def test_the_command_shows_what_is_due_where_there_is_something_to_compare_with(started, tmp_path, capsys):
    out = tmp_path / "out.json"
    argv = ["bench", "start", "--quick", "--json", str(out)]
    assert run(argv) == 0
    rows = json.loads(out.read_text())["rows"]
    assert rows[0]["case"] == "import elbowroom" and rows[0]["before_ms"] is None
    assert "first call of er.reconstruct" in capsys.readouterr().out
    assert run([*argv, "--against", str(tmp_path)]) == 0
    assert "133 ms" in capsys.readouterr().out
