"""What is typed after `elbowroom calibrate` arrives under its own name."""

from pathlib import Path

import pytest

from elbowroom.calibrate.simulated.start import Start
from elbowroom.cli import run
from elbowroom.cli.calibrate import extrinsics_run, intrinsics_run, machine_run, refine_run, simulate_run
from elbowroom.cli.calibrate.result import ResultOptions

RESULT = ["--out", "new.yaml", "--report", "page", "--confidence", "0.9", "--near", "0.7"]
RESULT_OPTIONS = ResultOptions(out=Path("new.yaml"), report=Path("page"), confidence=0.9, near_m=0.7)


@pytest.fixture
def told(monkeypatch):
    """told(module, name, words): the options with which the run of that name is called."""

    def called(module, name, words):
        calls = []
        monkeypatch.setattr(module, name, lambda options, json_file: calls.append((options, json_file)))
        assert run(["calibrate", *words, "--json", "rows.json"]) == 0
        ((options, json_file),) = calls
        assert json_file == Path("rows.json")
        return options

    return called


def test_simulate(told):
    words = "simulate board --out capture --cameras 7 --size qqvga --poses 9 --noise tof --board printed"
    words += (
        " --corners 6x4 --square 0.11 --border 0.05 --stands 3 --wrong-deg 1.5 --wrong-m 0.02 --focal 2.5"
    )
    words += " --lens --depth-scale 1.25 --depth-bias 0.004 --near --hand 0.001 --moved-pose 5 --knock cam03"
    words += " --knock-deg 0.6 --knock-m 0.03 --seed 8"
    assert told(simulate_run, "simulate_capture", words.split()) == simulate_run.CaptureOptions(
        kind="board",
        out=Path("capture"),
        cameras=7,
        size="qqvga",
        poses=9,
        noise="tof",
        seed=8,
        start=Start(1.5, 0.02, 2.5, True, 1.25, 0.004),
        board=simulate_run.BoardOptions("printed", "6x4", 0.11, 0.05, 3),
        motion=simulate_run.MotionOptions(near=True, hand_m=0.001, moved_pose=5),
        knock=simulate_run.KnockOptions("cam03", 0.6, 0.03),
    )


@pytest.mark.parametrize(
    ("words", "command"),
    [
        ("board --near", "calibrate intrinsics"),
        ("board", "calibrate extrinsics"),
        ("machine", "calibrate machine"),
        ("room", "calibrate refine"),
    ],
)
def test_simulate_says_what_the_capture_is_for(told, words, command):
    options = told(simulate_run, "simulate_capture", ["simulate", *words.split(), "--out", "capture"])
    assert options.next_command == command and options.knock is None


def test_extrinsics(told):
    words = ["extrinsics", "site.yaml", *RESULT, "--without-pose", "3", "--without-pose", "5"]
    options = told(extrinsics_run, "run_extrinsics", words)
    assert options == extrinsics_run.ExtrinsicsOptions(Path("site.yaml"), (3, 5), RESULT_OPTIONS)


def test_intrinsics(told):
    words = "intrinsics capture --out new.yaml --report page --camera a --camera b --distortion 8"
    options = told(intrinsics_run, "run_intrinsics", words.split())
    assert options == intrinsics_run.IntrinsicsOptions(
        site=Path("capture"), out=Path("new.yaml"), report=Path("page"), only=("a", "b"), coefficients=8
    )


def test_machine(told):
    words = ["machine", "site.yaml", *RESULT, "--camera", "a", "--base", "--hold", "b", "--model-mm", "3.5"]
    options = told(machine_run, "run_machine", words)
    assert options == machine_run.MachineOptions(
        site=Path("site.yaml"), only=("a",), base=True, hold=("b",), model_mm=3.5, result=RESULT_OPTIONS
    )


def test_refine(told):
    words = ["refine", "site.yaml", *RESULT, "--camera", "a", "--hold", "b", "--sure-to", "50,3"]
    options = told(refine_run, "run_refine", words)
    assert options == refine_run.RefineOptions(
        site=Path("site.yaml"), only=("a",), hold=("b",), sure_to="50,3", result=RESULT_OPTIONS
    )
