"""Every command of every page: those of blocks are run in their order, small; the program takes all others as typed."""

import re
import shlex
import shutil
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import pytest
import trimesh
import typer
import yaml

from elbowroom.cli import run, simulate_run
from elbowroom.cli.app import app
from elbowroom.view.draw.colour import colour_picture
from reference.page_commands import block_commands, inline_commands, parse

PROJECT = Path(__file__).resolve().parents[1]
PAGES = [
    *PROJECT.glob("*.md"),
    *(PROJECT / "docs").glob("*.md"),
    *(PROJECT / "examples").rglob("*.md"),
]

MEASURES = ("evaluate", "bench")
"""Groups whose commands take minutes even small, and have tests of their own: only what is typed is checked."""

TYPED_ALONE = {
    "placement sweep --walls 4 --walls 5 --sensor vga --sensor square": "the line before it is run",
    "placement optimise my_room.yaml --price --share 95": "seconds each; the first and the fourth are run",
    "placement optimise my_room.yaml --cameras 12 --write placed.yaml": "as the line before it",
    "placement optimise my_room.yaml --scenes 5 --cameras 12 --write placed.yaml": "carves each candidate",
    "calibrate refine examples/piv_table_2cam.yaml --hold cam1 --sure-to 50,3 --out refined.yaml": "needs a "
    "recording that is not part of the project",
    "calibrate simulate board --size thesis --noise tof --out tiny": "a smaller capture than this hangs not together",
    "calibrate extrinsics tiny --out calibrated.yaml --report report": "as the line before it",
    "monitor my_room.yaml --gate my_gate": "a gate stops for good, and has tests of its own",
    "gate status my_gate": "as the line before it",
    "gate reset my_gate": "as the line before it",
    "monitor my_room.yaml --record run.mcap": "writes into the folder; its own tests run it",
    "monitor my_room.yaml --black-box stops": "as the line before it",
    "replay run.mcap": "as the line before it",
    "replay run.mcap --from 1200": "as the line before it",
    "replay run.mcap --why 1200": "as the line before it",
    "export run.mcap images": "as the line before it",
    "replay run.mcap --page": "stays until Ctrl-C; its own tests run it",
    "export run.mcap --report incident.html --stop 1 --seconds 20": "as the line before it",
    "plan": "stays until Ctrl-C; its own tests run it",
    "plan my_room.yaml --out planned.yaml": "as the line before it",
    "plan setup1": "as the line before it",
    "view my_room.yaml --picture room.png": "takes some seconds; its own tests run it",
    "view my_room.yaml --picture above.png --view top --hide sweeps": "as the line before it",
    "view my_room.yaml --picture near.png --from 2,-2,1.8 --to 0,0,1 --size 1600x1200 --sweep larm+": "as the line "
    "before it",
    "monitor my_room.yaml --foxglove": "takes a port that others may have; its own tests run it",
    "replay run.mcap --foxglove": "as the line before it",
    "gate token my_token": "writes into the folder; its own tests run it",
    "monitor my_room.yaml --gate my_gate --service 8088 --token my_token": "as the line before it",
    "site topics my_bag": "needs a bag, which tests of bags write",
    "site from-bag my_bag --out my_room.yaml": "as the line before it",
    "placement optimise my_room.yaml --motions --cameras 12 --write placed.yaml": "needs a machine with speeds: "
    "its own tests run it",
    "monitor --knock cam03:20mmz@5": "as the line before it",
    "monitor --knock larm:2deg@5": "as the line before it",
}
"""Commands of blocks that are not run, and why; the program must take their words."""

SMALLER = {
    "calibrate simulate board --out capture": "--cameras 4 --poses 10 --seed 2 --size qqvga --noise exact",
    "calibrate simulate board --near --lens --focal 2 --out near": "--cameras 1 --poses 5 --size qqvga --noise exact",
    "monitor calibrated.yaml": "--voxel-size 0.2 --seconds 0.5",
    "calibrate simulate machine --out moving": "--cameras 3 --poses 5 --size qqvga",
    "calibrate commission my_room.yaml --out my_room_watched.yaml": "--frames 5",
    "monitor": "--seconds 0.5 --cameras 3 --resolution 40x30 --voxel-size 0.2",
    "monitor --knock cam03:1deg@5": "--seconds 0.5 --cameras 4 --resolution 40x30 --voxel-size 0.2",
    "monitor my_room_watched.yaml": "--seconds 0.5",
    "monitor my_room.yaml": "--seconds 0.5",
    "placement sweep my_room.yaml --out pictures --json sweep.json": "--cameras 9-10 --voxel-size 0.5",
    "placement optimise my_room.yaml --share 98.9 --seconds 60 --write placed.yaml --out pictures": "--share 70 "
    "--seconds 1 --points 200",
    "placement optimise placed.yaml --keep --share 99": "--share 75 --seconds 1 --points 200",
    "placement simulate placed.yaml --scenes 20 --json simulate.json": "--scenes 1 --no-by-camera",
    "simulate placed.yaml --moving person --out rehearsed": "--moments 1",
    "simulate --room setup1 --out room1": "--cameras 2 --size thesis",
    "simulate --room my.glb --out my_room": "--cameras 2 --size thesis --no-machine",
    "monitor examples/arm_on_a_table/cell.yaml --out sections": "--voxel-size 0.1 --seconds 0.5",
}
"""What is added to a command of a block, so that it takes less; it says nothing else than the command does."""

ROOM = {"walls": {"lower_m": [-2.5, -2.5, 0.0], "upper_m": [2.5, 2.5, 2.9]}}


def small_room(path: Path) -> None:
    """Makes the room that `site new` wrote small, and adds the recording that the page asks for next."""
    content = yaml.safe_load(path.read_text(encoding="utf-8"))
    content["grid"]["voxel_size_m"] = 0.2
    content["camera_defaults"] |= {"width": 64, "height": 48, "fx": 32.0, "fy": 32.0, "cx": 31.5, "cy": 23.5}
    content |= {"room": ROOM, "recording": {"layout": "folder", "folder": "recording"}}
    path.write_text(yaml.safe_dump(content), encoding="utf-8")
    assert run(["simulate", str(path), "--moments", "2"]) == 0


def watched_room(folder: Path) -> None:
    """A simulated room of few cameras, to be commissioned."""
    content = {
        "grid": {"origin_m": [-2, -2, 0], "upper_m": [2, 2, 2.5], "voxel_size_m": 0.2},
        "simulated": {"cameras": 4, "resolution": "64x48"},
        "machine": {"builtin": "ceiling_c_arm"},
        "joints": {"larm": {"max_speed_deg_s": 12, "braking_time_s": 0.5}},
    }
    (folder / "my_room.yaml").write_text(yaml.safe_dump(content), encoding="utf-8")


def room_to_place_in(folder: Path) -> None:
    """The room that the page of placement describes, with a sensor and few places for it."""
    page = (PROJECT / "docs" / "placement.md").read_text(encoding="utf-8")
    (described,) = re.findall(r"```yaml\n(.*?)```", page, re.DOTALL)
    content = yaml.safe_load(described)
    content["grid"] = {"origin_m": [-2, -2, 0], "upper_m": [2, 2, 2.5], "voxel_size_m": 0.25}
    content["camera_defaults"] = {"width": 64, "height": 48, "fx": 32.0, "fy": 32.0, "cx": 31.5, "cy": 23.5}
    content["placement"]["mounts_along"] = {"wall_spacing_m": 1.25, "heights_m": [2.4]}
    content["placement"]["aims_m"] = [[0.0, 0.0, 0.5], [0.0, 0.0, 1.0]]
    (folder / "my_room.yaml").write_text(yaml.safe_dump(content), encoding="utf-8")


def room_of_ones_own(folder: Path) -> None:
    table = trimesh.creation.box((1.0, 0.8, 0.6), trimesh.transformations.translation_matrix((0, 0.3, 0)))
    floor = trimesh.creation.box((5.0, 0.1, 5.0), trimesh.transformations.translation_matrix((0, -0.05, 0)))
    (folder / "my.glb").write_bytes(trimesh.Scene({"table": table, "floor": floor}).export(file_type="glb"))


def examples(folder: Path) -> None:
    shutil.copytree(PROJECT / "examples" / "arm_on_a_table", folder / "examples" / "arm_on_a_table")


BEFORE: dict[str, Callable[[Path], None]] = {
    "calibration.md": watched_room,
    "bags.md": watched_room,
    "placement.md": room_to_place_in,
    "evaluation.md": room_of_ones_own,
    "arm_on_a_table/README.md": examples,
}
"""What a page takes to be there."""

AFTER: dict[str, Callable[[], None]] = {"site new my_room.yaml": lambda: small_room(Path("my_room.yaml"))}
"""What its reader does between two commands of a page."""


@pytest.fixture
def small_pictures(monkeypatch):
    """Colour pictures of rooms, which nobody looks at here, are small."""

    def small(solids, view):
        return colour_picture(solids, replace(view, width=view.width // 4, height=view.height // 4), smooth=1)

    monkeypatch.setattr(simulate_run, "colour_picture", small)


def name_of(page: Path) -> str:
    return page.name if page.parent in (PROJECT, PROJECT / "docs") else f"{page.parent.name}/{page.name}"


def commands(page: Path) -> list[str]:
    """The commands of the program in a page's blocks."""
    return [line.removeprefix("elbowroom ") for line in block_commands(page) if line.startswith("elbowroom ")]


RUN = [page for page in PAGES if page.name != "first_hour.md" and commands(page)]
"""Pages with blocks of commands; test_first_hour.py runs that one's, with the cell that it builds."""


def is_run(command: str) -> bool:
    return command not in TYPED_ALONE and command.split()[0] not in MEASURES


@pytest.mark.parametrize("page", [page for page in RUN if any(map(is_run, commands(page)))], ids=name_of)
def test_the_commands_of_a_page_run_in_their_order(page, tmp_path, monkeypatch, capsys, small_pictures):
    monkeypatch.chdir(tmp_path)
    BEFORE.get(name_of(page), lambda folder: None)(tmp_path)
    for command in commands(page):
        if not is_run(command):
            continue
        words = [*shlex.split(command), *shlex.split(SMALLER.get(command, ""))]
        assert run(words) == 0, f"{page.name}: elbowroom {command}: {capsys.readouterr().err}"
        AFTER.get(command, lambda: None)()


@pytest.mark.parametrize("page", RUN, ids=name_of)
def test_the_program_takes_every_command_of_a_block_as_it_is_typed(page):
    for command in commands(page):
        parse(shlex.split(command))


@pytest.mark.parametrize("page", [page for page in PAGES if inline_commands(page)], ids=name_of)
def test_the_program_takes_every_command_amid_the_text(page):
    for command in inline_commands(page):
        parse(shlex.split(command.removeprefix("elbowroom "), comments=True), whole=False)


def test_the_program_takes_the_examples_that_its_help_shows():
    def all_commands(command):
        below = getattr(command, "commands", {}).values()
        return [command, *(found for each in below for found in all_commands(each))]

    shown = [
        line
        for command in all_commands(typer.main.get_command(app))
        for line in re.findall(r"elbowroom [^\n]+", command.epilog or "")
    ]
    assert len(shown) > 40
    for line in shown:
        parse(shlex.split(line.strip())[1:])


def test_other_programs_that_blocks_call_are_there():
    for page in PAGES:
        for line in block_commands(page):
            for script in re.findall(r"^(?:python )?(\.?[\w/]+/\w+(?:\.py)?)", line):
                assert (PROJECT / script).is_file(), f"{page.name}: {line}"


def test_the_tables_of_this_file_name_commands_that_a_page_has():
    there = {command for page in PAGES for command in commands(page)}
    assert set(SMALLER) <= there and set(TYPED_ALONE) <= there and set(AFTER) <= there
    assert not set(SMALLER) & set(TYPED_ALONE)
    assert set(BEFORE) <= {name_of(page) for page in PAGES}
