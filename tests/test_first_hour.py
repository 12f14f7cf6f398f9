"""The page of the first hour: its commands run in order, its cell is the one that ships, and most of it is not stop."""

import re
import shlex
import shutil
from collections import Counter
from pathlib import Path

import numpy as np
import pytest
import yaml

from elbowroom.cli import run
from elbowroom.monitor import Cycle
from elbowroom.motion import Level
from elbowroom.site import Site
from elbowroom.sources import moments, open_room

PROJECT = Path(__file__).resolve().parents[1]
PAGE = PROJECT / "docs" / "first_hour.md"
EXAMPLE = PROJECT / "examples" / "arm_on_a_table"
SMALLER = (("width: 200", "width: 100"), ("height: 150", "height: 75"), ("121.0", "60.5"), ("99.5", "49.5"))
MOST_BYTES = 3_000_000


def commands(page: Path) -> list[list[str]]:
    lines = re.findall(r"^    (elbowroom .*)$", page.read_text(encoding="utf-8"), re.MULTILINE)
    return [shlex.split(line)[1:] for line in lines]


def cell_of_the_page() -> str:
    (block,) = re.findall(r"```yaml\n(.*?)```", PAGE.read_text(encoding="utf-8"), re.DOTALL)
    return block


def test_the_cell_of_the_page_is_the_one_that_ships():
    assert yaml.safe_load(cell_of_the_page()) == yaml.safe_load((EXAMPLE / "cell.yaml").read_text())


def test_the_pages_commands_run_in_their_order(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    shutil.copy(EXAMPLE / "arm.urdf", tmp_path)
    small = cell_of_the_page().replace("74.5", "37.0").replace("voxel_size_m: 0.04", "voxel_size_m: 0.1")
    for large, less in SMALLER:
        small = small.replace(large, less)
    done = []
    for argv in commands(PAGE):
        fewer = [
            "3" if word == "10" else "1" if argv[0] == "placement" and word == "3" else word for word in argv
        ]
        fewer = [
            "2" if before == "--moment" else word for before, word in zip(["", *fewer], fewer, strict=False)
        ]
        assert run(fewer) == 0, capsys.readouterr().err
        done.append(" ".join(argv[:2]))
        if argv[:2] == ["site", "new"]:
            (tmp_path / argv[2]).write_text(small)
    assert done[:3] == ["site new", "site check", "simulate cell.yaml"]
    assert {"reconstruct cell.yaml", "monitor cell.yaml", "check cell.yaml"} <= set(done)
    said = capsys.readouterr().out
    assert "no folder" in said and "18 images of 3 moments" in said


@pytest.fixture(scope="module")
def levels():
    """Of each moment of the shipped recording, the levels of all motions."""
    room = open_room(Site.load(EXAMPLE / "cell.yaml"))
    machine, motions = room.machine_and_motions()
    # a clock that stands still: a busy computer makes no verdict stale
    cycle = Cycle(room.grid, room.cameras, machine, motions, room.terms, clock_ns=lambda: 0)
    results = [cycle.run(snapshot) for snapshot in room.source]
    assert all(result.fault is None for result in results)
    return [[verdict.level for verdict in result.verdicts] for result in results]


def test_most_verdicts_of_the_shipped_recording_are_not_stop_and_a_person_who_is_near_stops_some(levels):
    every = Counter(level for moment in levels for level in moment)
    assert every[Level.STOP] < 0.5 * every.total()
    assert every[Level.CLEAR] > 0.5 * every.total()
    stopped = [moment.count(Level.STOP) for moment in levels]
    assert max(stopped) >= 6 and stopped[0] == stopped[-1] == 0


def test_the_shipped_recording_is_light_noisy_and_made_as_it_says():
    assert sum(path.stat().st_size for path in EXAMPLE.rglob("*") if path.is_file()) < MOST_BYTES
    site = Site.load(EXAMPLE / "cell.yaml")
    assert all(camera.noise is not None for camera in site.cameras()) and 4 <= len(site.cameras()) <= 6
    all_moments = list(moments(site))
    assert len(all_moments) == 10 and all(len(moment.frames) == len(site.cameras()) for moment in all_moments)
    # the table under the arm is where it is, give or take the noise
    camera = next(c for c in site.cameras() if c.name == "nw")
    frame = next(f for f in all_moments[0].frames if f.camera == "nw")
    points = camera.points_in_world(frame.depth_m)
    aside = (np.abs(points[..., 0] + 0.4) < 0.1) & (np.abs(points[..., 1] - 0.2) < 0.15)
    table = points[aside & (np.abs(points[..., 2] - 0.75) < 0.1)][:, 2]
    assert len(table) > 50 and np.median(table) == pytest.approx(0.75, abs=0.01) and table.std() > 0.002


def test_the_readme_of_the_example_names_the_command_that_made_it():
    assert ["simulate", *commands(PAGE)[2][2:]] == [
        "simulate",
        *next(argv for argv in commands(EXAMPLE / "README.md") if argv[0] == "simulate")[2:],
    ]
