"""Attacks on the control service of a running monitor: of each kind, and none is let in."""

import pytest

from elbowroom.evaluate.service import rows
from elbowroom.evaluate.service.attacker import attacks


def stretch(against: str, worst_ms: float, let_in: int = 0):
    answers = {} if against == "nobody" else {"wrong token": {"401": 5, "200": let_in}}
    shared = {"passes": 9, "median_ms": 8.0, "p99_ms": 9.0, "answers": answers}
    return {**shared, "against": against, "worst_ms": worst_ms, "let_in": let_in}


def test_what_is_let_in_and_how_much_later_passes_are_is_counted() -> None:
    given = [("nobody", 10.0), ("closing", 17.0), ("service", 18.5), ("service", 9.0, 1)]
    attack, total = rows.service_summary([stretch(*one) for one in given])
    assert (attack["requests"], attack["let_in"], total["let_in"], total["later_ms"]) == (11, 1, 1, 8.5)
    # what the attacker takes itself stays in the figure that is due, and is told apart beside it
    assert (total["attacker_later_ms"], total["service_later_ms"]) == (7.0, 1.5)
    assert [due.met(total) for due in rows.DUE] == [False, False, True]
    assert rows.service_summary([stretch("nobody", 10.0)]) == []


def test_every_attack_that_is_due_is_among_them() -> None:
    kinds = attacks(8088, b"{}", "t" * 32)
    due = (
        "wrong token",
        "foreign origin",
        "foreign host",
        "WebSocket of another site",
        "replayed",
        "oversized",
    )
    assert set(due) <= set(kinds) and len(set(kinds.values())) == len(kinds)


def test_a_monitor_that_is_attacked_lets_nobody_in() -> None:
    pytest.importorskip("h11")
    found = list(rows.service_rows(1, 1.0, 200.0))
    assert [row["against"] for row in found] == list(rows.AGAINST) and all(row["passes"] > 3 for row in found)
    total = rows.service_summary(found)[-1]
    assert total["requests"] > 50 and total["let_in"] == 0
