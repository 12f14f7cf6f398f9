"""`elbowroom monitor` opens the page and says where, or what to install; without it nothing else changes."""

import re
import urllib.request
from pathlib import Path

import pytest

from elbowroom.cli import run
from elbowroom.page import opened
from reference.small_room import SMALL_ROOM


@pytest.fixture
def site(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> str:
    monkeypatch.delenv("ELBOWROOM_NO_PAGE")
    (tmp_path / "room.yaml").write_text(SMALL_ROOM)
    return str(tmp_path / "room.yaml")


def test_the_page_is_opened_and_said_where(site, monkeypatch, capsys):
    seen = []
    said = opened.OpenedPage.said

    def asked(page, *given):
        line = said(page, *given)
        seen.append(urllib.request.urlopen(line.removeprefix("page: "), timeout=30).read().decode())
        return line

    monkeypatch.setattr(opened.OpenedPage, "said", asked)
    assert run(["monitor", site, "--seconds", "0.3", "--page-port", "0", "--language", "de"]) == 0
    assert re.search(r"note: page: http://127\.0\.0\.1:\d+", capsys.readouterr().out)
    assert '<html lang="de">' in seen[0] and "Warum" in seen[0]


def test_what_is_missing_is_said_with_what_installs_it(site, monkeypatch, capsys):
    monkeypatch.setattr(opened, "find_spec", lambda name: None)
    assert run(["monitor", site, "--seconds", "0.1"]) == 0
    assert "note: no page: it needs viser; install it with" in capsys.readouterr().out


def test_no_page_is_opened_where_nobody_wants_one(site, monkeypatch, capsys):
    monkeypatch.setattr(opened, "OpenedPage", None)
    assert run(["monitor", site, "--seconds", "0.1", "--no-page"]) == 0
    assert "page" not in capsys.readouterr().out


def test_an_unknown_language_is_refused(site, capsys):
    assert run(["monitor", site, "--seconds", "0.1", "--language", "xx"]) == 2
    assert "languages are en, de" in capsys.readouterr().err
