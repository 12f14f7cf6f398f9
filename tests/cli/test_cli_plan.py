import json
import os
import signal
import subprocess
import sys
import time

import pytest

from elbowroom.cli import run


@pytest.mark.parametrize(
    ("options", "word"),
    [
        (["nowhere.yaml"], "nowhere.yaml"),
        (["--out", "plan.txt"], "--out"),
        (["--out", "no/such/folder/plan.yaml"], "--out"),
        (["--language", "xx"], "language"),
    ],
)
def test_what_cannot_be_planned_is_said(tmp_path, monkeypatch, capsys, options, word) -> None:
    monkeypatch.chdir(tmp_path)
    assert run(["plan", *options]) == 2
    assert word in capsys.readouterr().err
    assert not list(tmp_path.iterdir())


def test_a_kept_file_that_is_no_plan_is_not_written_over(tmp_path, monkeypatch, capsys) -> None:
    pytest.importorskip("viser")
    monkeypatch.chdir(tmp_path)
    kept = tmp_path / "thesis_planned.plan.json"
    kept.write_text("{}")
    assert run(["plan", "thesis", "--port", "0", "--voxel-size", "0.25"]) == 2
    assert "no plan" in capsys.readouterr().err
    assert kept.read_text() == "{}"


def test_ctrl_c_keeps_the_plan(tmp_path) -> None:
    pytest.importorskip("viser")
    words = [sys.executable, "-m", "elbowroom", "plan", "thesis", "--port", "0", "--voxel-size", "0.25"]
    environment = {**os.environ, "PYTHONUNBUFFERED": "1"}
    with subprocess.Popen(words, cwd=tmp_path, stdout=subprocess.PIPE, text=True, env=environment) as process:
        assert process.stdout is not None
        lines = []
        for line in process.stdout:
            lines.append(line)
            if line.startswith("plan: http://127.0.0.1:"):
                break
        time.sleep(0.3)
        process.send_signal(signal.SIGINT)
        lines += process.stdout.readlines()
        assert process.wait(20) == 0, lines
    kept = json.loads((tmp_path / "thesis_planned.plan.json").read_text())
    assert kept["kind"] == "elbowroom plan" and kept["cameras"] == []
