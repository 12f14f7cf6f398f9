"""The most memory that a process has held."""

import subprocess
import sys

import numpy as np

from elbowroom.files import peak_memory
from elbowroom.files.peak_memory import peak_memory_mb


def test_it_rises_by_what_is_taken_and_never_falls():
    before = peak_memory_mb()
    taken = np.ones(40_000_000)
    during = peak_memory_mb()
    del taken
    # the system counts in batches a thread, and so to within some pages
    assert during >= 320 and peak_memory_mb() >= during - 1 >= before - 1


def test_a_small_process_that_a_large_one_starts_is_small():
    taken = np.ones(40_000_000)
    code = "from elbowroom.files.peak_memory import peak_memory_mb; print(peak_memory_mb())"
    child = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert 5 < float(child.stdout) < taken.nbytes / 2e6


def test_a_system_without_proc_says_it_by_another_way(monkeypatch, tmp_path):
    monkeypatch.setattr(peak_memory, "STATUS", tmp_path / "none")
    assert peak_memory_mb() >= 30


def test_a_system_that_does_not_say_gives_none(monkeypatch, tmp_path):
    monkeypatch.setattr(peak_memory, "STATUS", tmp_path / "none")
    monkeypatch.setitem(sys.modules, "resource", None)
    assert peak_memory_mb() is None
