"""Each example runs as a newcomer runs it, and says what it should."""

import subprocess
import sys
from pathlib import Path

import pytest

EXAMPLES = Path(__file__).resolve().parents[1] / "examples"
SAYS = {
    "01_first_free_space": ["% of the voxels", "is unseen", "sees through it"],
    "02_room_and_truth": ["called free: 0", "without 3 cameras", " 0 voxels became free"],
    "03_verdict_and_why": ["long      +", "most cautious: ", "measured a surface in it"],
    "04_own_robot": [
        "shoulder +1: 42.7 degrees of 80",
        "shoulder -1: 80.0 degrees of 80",
        "fold, then turn: clear",
    ],
    "05_own_recording": ["0 ms: 3 images", "100 ms: 3 images"],
    "06_many_times_a_second": ["cycle 0", "level"],
    "07_two_computers": ["the same voxels", "0 voxels more"],
    "08_where_cameras_hang": ["21 cameras", "worst places"],
    "09_calibration": ["the board was found in", "cam03: "],
}
"""Pieces of what each prints."""


def test_every_example_is_tried_and_listed() -> None:
    names = sorted(path.stem for path in EXAMPLES.glob("*.py"))
    assert names == sorted(SAYS)
    listed = (EXAMPLES / "README.md").read_text(encoding="utf-8")
    for name in names:
        assert f"`{name}.py`" in listed


@pytest.mark.parametrize("name", SAYS)
def test_an_example_runs_and_says_what_it_should(name: str, tmp_path: Path) -> None:
    done = subprocess.run(
        [sys.executable, EXAMPLES / f"{name}.py"], cwd=tmp_path, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    for piece in SAYS[name]:
        assert piece in done.stdout
