"""`elbowroom bench parts`: the machine's parts of a pass, this tree and another in turns."""

import json

import numpy as np
import pytest

from elbowroom.cli import run
from elbowroom.errors import InputError
from elbowroom.evaluate.speed import parts
from elbowroom.evaluate.speed.bench_case import Scene
from elbowroom.evaluate.speed.parts_case import parts_of
from elbowroom.sensing import NOISE_PRESETS

CASES = ("explain", "body out", "eight motions", "distances", "path of 200 points")


def test_parts_of_a_small_scene_answer(tmp_path):
    parts.save_scenes(tmp_path / "scene.npz", 3, "qqvga", True)
    found = parts_of(Scene.load(tmp_path / "scene.npz", NOISE_PRESETS["tof"]), 0.2)
    assert tuple(found) == CASES
    assert all(image.any() for image in found["explain"](0).model_depth.values())
    assert found["body out"](1).any() and len(found["eight motions"](1)) == 8
    assert found["distances"](0).links
    assert len(found["path of 200 points"](1).path.times_s) == 200


def test_a_process_that_ends_is_an_error(tmp_path):
    scene = tmp_path / "scene.npz"
    np.savez(scene)
    with pytest.raises(InputError, match="ended with 1"), parts._started(parts.HERE, scene, 1) as process:
        parts._said(process, parts.HERE)


class Looked:
    """A process that is none: it answers with a time of its tree's."""

    def __init__(self, tree):
        self.tree = tree

    def __enter__(self):
        return self

    def __exit__(self, *_):
        pass


@pytest.fixture
def looked(monkeypatch):
    calls = []

    def answer(process, tree):
        calls.append(tree.name)
        return dict.fromkeys(CASES, (2.0 if tree == parts.HERE else 6.0, 1.0))

    monkeypatch.setattr(parts, "save_scenes", lambda *_: None)
    monkeypatch.setattr(parts, "_started", lambda tree, *_: Looked(tree))
    monkeypatch.setattr(parts, "_said", lambda *_: "ready")
    monkeypatch.setattr(parts, "_asked", answer)
    return calls


def test_trees_take_turns_and_are_beside_each_other(looked, tmp_path):
    rows = list(parts.parts_rows(3, 2, tmp_path))
    one, other = parts.HERE.name, tmp_path.name
    assert looked == [one, other, other, one, one, other]
    assert [row["case"] for row in rows] == list(CASES)
    assert all((row["median_ms"], row["before_ms"], row["before_cpu_ms"]) == (2.0, 6.0, 1.0) for row in rows)
    asked = {row["case"] for row in rows if any(due.of(row) for due in parts.DUE)}
    assert asked == {"explain", "eight motions", "path of 200 points"}


def test_the_command_writes_its_rows(looked, tmp_path, capsys):
    out = tmp_path / "out.json"
    assert run(["bench", "parts", "--quick", "--threads", "2", "--json", str(out)]) == 0
    rows = json.loads(out.read_text())["rows"]
    assert len(rows) == len(CASES) and rows[0]["before_ms"] is None
    assert "eight motions" in capsys.readouterr().out
