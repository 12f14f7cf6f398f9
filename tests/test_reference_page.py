"""The reference is made from the docstrings, and shows all that is public."""

import importlib.util
import runpy
from pathlib import Path

import elbowroom

PROJECT = Path(__file__).resolve().parents[1]


def test_the_reference_has_a_page_for_each_module_and_every_public_name(tmp_path: Path) -> None:
    # of some modules; continuous integration makes the pages of all
    made = runpy.run_path(str(PROJECT / "docs" / "reference.py"))
    names = ("elbowroom", "elbowroom.reconstruct", "elbowroom.motion", "elbowroom.motion.verdict")
    assert set(names) < set(made["modules"]())
    made["write"](tmp_path, names)
    for name in names:
        assert (tmp_path / f"{name.replace('.', '/')}.html").is_file(), name
    page = (tmp_path / "elbowroom.html").read_text(encoding="utf-8")
    for public in elbowroom.__all__:
        # `reconstruct` is a folder too, which has a page of its own
        assert f'id="{public}"' in page or (tmp_path / "elbowroom" / f"{public}.html").is_file(), public
    verdict = (tmp_path / "elbowroom" / "motion" / "verdict.html").read_text(encoding="utf-8")
    assert "How far the motion may go" in verdict or "how far the motion may go" in verdict


def test_the_reference_leaves_out_compiled_loops() -> None:
    names = runpy.run_path(str(PROJECT / "docs" / "reference.py"))["modules"]()
    assert "elbowroom.reconstruct.carve" in names
    assert not [name for name in names if ".kernels" in name]
    assert all(importlib.util.find_spec(name) for name in names)
