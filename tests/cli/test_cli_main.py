"""Help shows examples, errors are one line, codes are 0, 2 and 130."""

import json
import subprocess
import sys
import warnings

import pytest

from elbowroom.cli import run
from elbowroom.cli.app import app

COMMANDS = ["monitor", "reconstruct", "check", "bench", "evaluate", "site"]


def one_line(capsys) -> str:
    captured = capsys.readouterr()
    assert captured.out == ""
    assert captured.err.count("\n") == 1 and captured.err.startswith("elbowroom: ")
    return captured.err


def test_all_commands_are_there(capsys):
    assert run([]) == 0
    text = capsys.readouterr().out
    assert all(f" {command} " in text for command in COMMANDS)


def test_a_group_of_commands_alone_shows_its_help_and_no_error(capsys):
    assert run(["site"]) == 2
    captured = capsys.readouterr()
    assert "check" in captured.out and captured.err == ""


@pytest.mark.parametrize("command", ["monitor", "reconstruct", "check", "bench"])
def test_help_shows_an_example(capsys, command):
    assert run([command, "--help"]) == 0
    text = capsys.readouterr().out
    assert f"elbowroom {command}" in text.split("Example")[-1]
    assert "--json" in text


def test_version_is_printed(capsys):
    assert run(["--version"]) == 0
    assert capsys.readouterr().out.startswith("elbowroom 0.")


@pytest.mark.parametrize(
    ("argv", "words"),
    [
        (["fly"], "No such command"),
        (["monitor", "--frobnicate"], "--frobnicate"),
        (["monitor", "--cameras", "0"], "--cameras"),
        (["monitor", "--rule", "two"], "'three'"),
        (["monitor", "--resolution", "big"], "such as 160x120"),
        (["monitor", "no_such_room.yaml"], "no_such_room.yaml"),
        (["monitor", "--threads", "1000000"], "this process may use"),
        (["monitor", "--json", "no/such/folder/out.json"], "name a folder that exists"),
        (["monitor", "--voxel-size", "-1"], "voxel_size_m is -1.0"),
        (["reconstruct", "no_such_room.yaml", "--out", "somewhere"], "no_such_room.yaml"),
        (["reconstruct", "--out", "somewhere"], "Missing argument 'SITE'"),
        (["check", "no_such_room.yaml", "--joint", "larm", "--direction", "up"], "allowed are + and -"),
        (["check", "no_such_room.yaml", "--joint", "larm", "--direction", "-"], "no_such_room.yaml"),
    ],
)
def test_errors_are_one_line(capsys, argv, words):
    assert run(argv) == 2
    assert words in one_line(capsys)


@pytest.mark.parametrize(
    ("raised", "code", "words"),
    [
        (KeyboardInterrupt(), 130, ""),
        (PermissionError(13, "Permission denied", "/proc/x"), 2, "elbowroom: /proc/x: Permission denied"),
        (MemoryError(), 2, "choose larger voxels"),
    ],
)
def test_what_the_system_says_is_one_line(capsys, monkeypatch, raised, code, words):
    def fails(**_):
        raise raised

    monkeypatch.setattr(type(app), "__call__", lambda *_, **__: fails())
    assert run(["monitor"]) == code
    assert words in capsys.readouterr().err


TERMINATED = """
import os, signal, sys, time
from pathlib import Path
from elbowroom.cli import main
from elbowroom.cli.app import app
from elbowroom.files.json_rows import json_rows

def measures(*_, **__):
    with json_rows(Path(sys.argv[1])) as add:
        add({"turn": 1})
        os.kill(os.getpid(), signal.SIGTERM)
        time.sleep(60)

type(app).__call__ = measures
main([])
"""


def test_what_the_system_ends_keeps_its_rows_as_after_ctrl_c(tmp_path):
    out = tmp_path / "run.json"
    ended = subprocess.run([sys.executable, "-c", TERMINATED, out], capture_output=True, text=True)
    assert ended.returncode == 130
    assert "interrupted; the 1 rows until then are in" in ended.stderr
    assert json.loads((tmp_path / "run.part.json").read_text())["rows"] == [{"turn": 1}]


@pytest.mark.filterwarnings("default")
def test_warnings_are_notes_of_one_line(capsys, monkeypatch):
    def warns(*_, **__):
        warnings.warn("a pose was\noff a rotation", UserWarning, stacklevel=1)

    monkeypatch.setattr(type(app), "__call__", warns)
    assert run([]) == 0
    assert capsys.readouterr().err == "note: a pose was off a rotation\n"


def test_the_command_line_starts_without_the_heavy_parts():
    code = (
        "import sys, elbowroom.cli.app; "
        "print([m for m in ('numba', 'trimesh', 'pydantic', 'PIL', 'scipy') if m in sys.modules])"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"
