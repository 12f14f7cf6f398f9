"""The way of a site file to the running monitor is the one that docs/architecture.md tells."""

import re
import sys
from pathlib import Path
from types import FrameType
from typing import Any

from elbowroom.cli import run
from reference.small_room import SMALL_ROOM

PROJECT = Path(__file__).resolve().parents[2]
SOURCE = PROJECT / "src" / "elbowroom"
OPTIMIZED = 0x01
"""Of code: a function's, not that of a module or of a class."""
MOST_FILES, MOST_RETURNS = 15, 8


def told() -> str:
    page = (PROJECT / "docs" / "architecture.md").read_text(encoding="utf-8")
    return page.partition("\n## From a site file to a running monitor\n")[2].partition("\n## ")[0]


def files_told() -> list[str]:
    return re.findall(r"^\d+\. `([\w/]+\.py)`", told(), re.MULTILINE)


def test_a_run_enters_the_files_in_the_order_that_is_told(tmp_path: Path) -> None:
    site = tmp_path / "room.yaml"
    site.write_text(SMALL_ROOM)
    on_the_way = {str(SOURCE / name): name for name in files_told()}
    entered: dict[str, None] = {}

    def note(frame: FrameType, event: str, _: Any) -> None:
        name = on_the_way.get(frame.f_code.co_filename)
        if event == "call" and name is not None and frame.f_code.co_flags & OPTIMIZED:
            entered.setdefault(name)

    sys.setprofile(note)
    try:
        assert run(["monitor", str(site), "--seconds", "0"]) == 0
    finally:
        sys.setprofile(None)
    assert list(entered) == files_told()


def test_the_way_is_as_short_as_is_told() -> None:
    text = told()
    returns = text[text.index("\n1. ") :].count("↩")
    assert f"{len(files_told())} files, {returns} returns" in text
    assert len(files_told()) <= MOST_FILES and returns <= MOST_RETURNS
