"""A recording of a few passes of the simulated room, made once a process."""

import tempfile
from functools import cache
from pathlib import Path

from elbowroom.evaluate.recording.sample import record_sample

PASSES = 12


@cache
def sample_run() -> bytes:
    """The bytes of the file."""
    with tempfile.TemporaryDirectory() as folder:
        return record_sample(Path(folder) / "run.mcap", PASSES).read_bytes()
