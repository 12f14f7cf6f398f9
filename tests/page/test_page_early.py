"""The page's process begins early; it ends where nobody tells it what to show, and a run does not wait for it."""

import time
from importlib.util import find_spec

import pytest

from elbowroom.cli.page_note import PageNote
from elbowroom.page import early
from elbowroom.page.early import Early, early_page


def test_a_process_that_nobody_tells_anything_ends_by_itself():
    begun = Early.begun()
    begun.process.stdin.close()
    assert begun.process.wait(60) == 0 and begun.process.stdout.read() == ""
    assert (begun.folder / early.LOG).read_text() == ""
    begun.process.stdout.close()


def test_without_its_packages_nothing_is_begun(monkeypatch):
    monkeypatch.setattr(early, "find_spec", lambda name: None if name == "viser" else find_spec(name))
    with early_page() as begun:
        assert begun is None


def test_one_that_was_begun_for_nothing_is_ended_at_once_and_leaves_nothing():
    with pytest.raises(ValueError, match="another language"), early_page() as begun:
        assert begun is not None and begun.process.poll() is None
        raise ValueError("another language")
    assert begun.process.poll() is not None and begun.process.stdout.closed
    assert not begun.folder.exists()


class Hung:
    """A page that does not say where it is."""

    def said(self) -> str:
        time.sleep(2.0)
        return "page: late"


def test_a_run_waits_for_no_page_that_hangs_and_says_later_where_it_is():
    notes: list[str] = []
    begun_s = time.monotonic()
    note = PageNote(notes.append, Hung())
    note.wait(0.2)
    assert time.monotonic() - begun_s < 1.5 and notes == []
    note.wait(10.0)
    assert notes == ["page: late"]
