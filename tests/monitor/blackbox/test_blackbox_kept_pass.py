"""Passes as they are kept: the memory of those that are let go is the system's again."""

import sys

import pytest

from elbowroom.evaluate.held_memory import resident_mb
from elbowroom.monitor.blackbox.kept_pass import together

PIECE = 700_000
"""As large as a packed image [bytes]."""


def test_pieces_lie_together_as_they_were():
    pieces = [b"one", b"", b"three" * 1000]
    found = together(pieces)
    assert found == pieces
    assert all(one.readonly for one in found)
    assert together([]) == [] and together([b"", b""]) == [b"", b""]


@pytest.mark.skipif(sys.platform != "linux", reason="asks Linux what it holds")
def test_what_is_let_go_is_given_back_at_once():
    before, kept, between = resident_mb(), [], []
    for _ in range(20):
        kept.append(together([b"x" * PIECE] * 20))
        between.append(b"y" * 3000)
    held = resident_mb()
    kept.clear()
    after = resident_mb()
    assert held - before > 0.9 * 20 * 20 * PIECE / 1e6
    assert after - before < 0.1 * (held - before)
