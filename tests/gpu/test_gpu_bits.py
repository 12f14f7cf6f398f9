"""Carve and sweep by threads of numba's GPU simulator: the bits of the processor."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

from elbowroom.errors import PackageError
from elbowroom.gpu.device import cuda

SCRIPT = Path(__file__).parents[1] / "reference" / "gpu_simulated.py"


def test_the_simulators_threads_leave_the_same_bits_and_end_at_the_same_blocks():
    # the simulator has to be asked for before numba is imported
    done = subprocess.run(
        [sys.executable, SCRIPT, "3"],
        env={**os.environ, "NUMBA_ENABLE_CUDASIM": "1"},
        capture_output=True,
        text=True,
        timeout=300,
    )
    assert done.returncode == 0, done.stderr[-2000:]
    compared = dict(line.split() for line in done.stdout.splitlines())
    assert int(compared["bits"]) > 500 and int(compared["blocks"]) > 1


def test_without_numba_cuda_it_is_said_what_to_install(monkeypatch):
    monkeypatch.setitem(sys.modules, "numba_cuda", None)
    cuda.cache_clear()
    with pytest.raises(PackageError, match="running on a GPU needs numba-cuda"):
        cuda()
