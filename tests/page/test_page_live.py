"""The page of a run: what a browser asks that is no question does not end the answers."""

import math
import queue
from types import SimpleNamespace
from typing import Any

import pytest

from elbowroom.page import live

NO_QUESTIONS: list[dict[str, Any]] = [
    {},
    {"type": "why"},
    {"type": "why", "motion": None},
    {"type": "why", "motion": "first"},
    {"type": "why", "motion": math.inf},
    {"type": "why", "motion": math.nan},
    {"type": "why", "motion": 10**400},
]


@pytest.mark.parametrize("asked", NO_QUESTIONS)
def test_what_is_no_question_does_not_end_the_answers(asked: dict[str, Any], monkeypatch) -> None:
    monkeypatch.setattr(live, "Reader", lambda board: None)
    questions: queue.Queue[Any] = queue.Queue()
    stage = SimpleNamespace(shows_clear=False)
    talk = SimpleNamespace(questions=questions)
    page: Any = SimpleNamespace(talk=talk, stage=stage, newest={"judged": {"verdicts": []}})
    board: Any = None
    questions.put((None, asked))
    questions.put((None, {"type": "ways", "all": True}))
    live.Live(page, board, questions.empty, lambda: None)._answer()
    assert stage.shows_clear is True
