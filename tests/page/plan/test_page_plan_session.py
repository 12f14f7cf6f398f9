"""What is clicked is done in its order: the server hands clicks on in threads of their own."""

import threading
import time

import pytest

from elbowroom.page.plan.opened import open_plan
from elbowroom.page.plan.session import Session
from elbowroom.page.words import words_of


@pytest.fixture
def session(tmp_path, ground):
    opened = open_plan(ground, words_of("en"), tmp_path / "planned.yaml", port=0)
    yield opened
    opened.stop()
    opened.page.stop()


def test_who_clicks_again_while_a_deed_is_done_does_the_next_one_after_it(session, monkeypatch):
    """On a busy computer drawing takes long: a person was there who was not chosen yet, and stayed when removed."""
    drawn, show = threading.Event(), Session._show

    def slowly(self, layout):
        if layout.people:
            drawn.set()
            time.sleep(0.2)
        show(self, layout)

    monkeypatch.setattr(Session, "_show", slowly)
    placing = threading.Thread(
        target=session._tried, args=(lambda _: session.choose(session.planner.add_person()),)
    )
    placing.start()
    assert drawn.wait(10.0)
    session._tried(lambda _: session.planner.remove(session._other()))
    placing.join()
    assert not session.planner.layout.people
