"""What is typed after `elbowroom placement` arrives under its own name."""

from pathlib import Path

import pytest

from elbowroom.cli import run
from elbowroom.cli.placement import capability, in_use, optimise, simulate, sweep, verify
from elbowroom.cli.placement.options import (
    CapabilityOptions,
    OptimiseOptions,
    Required,
    SimulateOptions,
    SweepOptions,
    VerifyOptions,
)


@pytest.fixture
def told(monkeypatch):
    """told(module, name, words): the options with which the run of that name is called."""

    def called(module, name, words):
        calls = []
        monkeypatch.setattr(module, name, lambda options, json_file: calls.append((options, json_file)))
        assert run(["placement", *words.split(), "--json", "rows.json"]) == 0
        ((options, json_file),) = calls
        assert json_file == Path("rows.json")
        return options

    return called


def test_verify(told):
    words = "verify a.yaml --views 2 --angle 90 --voxel-size 0.1 --worst 4 --out pictures"
    assert told(verify, "run_verify", words) == VerifyOptions(
        site=Path("a.yaml"), required=Required(2, 90.0), voxel_size_m=0.1, worst=4, out=Path("pictures")
    )


def test_sweep(told):
    words = (
        "sweep a.yaml --sensor vga --sensor thesis --cameras 4-9 --walls 5 --walls 6 --height 2 --height 0.5"
    )
    words += " --aim 0.4 --share 97 --views 2 --angle 80 --voxel-size 0.2 --out pictures"
    assert told(sweep, "run_sweep", words) == SweepOptions(
        site=Path("a.yaml"),
        sensors=("vga", "thesis"),
        counts="4-9",
        walls_m=(5.0, 6.0),
        heights_m=(2.0, 0.5),
        aim_m=0.4,
        share_pct=97.0,
        required=Required(2, 80.0),
        voxel_size_m=0.2,
        out=Path("pictures"),
    )


@pytest.mark.parametrize(
    ("scenes", "module", "name"), [(0, optimise, "run_optimise"), (3, in_use, "run_in_use")]
)
def test_optimise_by_the_empty_room_or_by_scenes(told, scenes, module, name):
    words = (
        f"optimise a.yaml --share 97 --cameras 9 --price --keep --scenes {scenes} --seconds 5 --points 400"
    )
    words += " --people 2 --no-table --views 2 --angle 80 --seed 7 --write new.yaml --out pictures"
    assert told(module, name, words) == OptimiseOptions(
        site=Path("a.yaml"),
        share_pct=97.0,
        cameras=9,
        by_price=True,
        keep=True,
        motions=False,
        scenes=scenes,
        people=2,
        table=False,
        seconds=5.0,
        points=400,
        required=Required(2, 80.0),
        seed=7,
        write=Path("new.yaml"),
        out=Path("pictures"),
    )


def test_optimise_by_motions_looks_at_scenes_in_use(told):
    options = told(in_use, "run_in_use", "optimise a.yaml --motions")
    assert options.motions and options.scenes > 0


def test_simulate(told):
    words = "simulate a.yaml --scenes 4 --people 2 --no-table --voxel-size 0.1 --no-by-camera --seed 6"
    assert told(simulate, "run_simulate", words) == SimulateOptions(
        site=Path("a.yaml"), scenes=4, people=2, table=False, voxel_size_m=0.1, by_camera=False, seed=6
    )


def test_capability(told):
    words = "capability a.yaml --views 3 --voxel-size 0.1 --out maps"
    assert told(capability, "run_capability", words) == CapabilityOptions(
        site=Path("a.yaml"), views=3, voxel_size_m=0.1, out=Path("maps")
    )
