"""The most memory that a process has held."""

import sys

import numpy as np

from elbowroom.files.peak_memory import peak_memory_mb


def test_it_rises_by_what_is_taken_and_never_falls():
    before = peak_memory_mb()
    taken = np.ones(40_000_000)
    during = peak_memory_mb()
    del taken
    assert during >= 320 and peak_memory_mb() >= during >= before


def test_a_system_that_does_not_say_gives_none(monkeypatch):
    monkeypatch.setitem(sys.modules, "resource", None)
    assert peak_memory_mb() is None
