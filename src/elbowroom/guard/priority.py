"""How a process steps back for the one that judges."""

import os
from contextlib import suppress


def step_back(nice: int) -> None:
    """Takes processor time that nobody else wants, and of that less than others.

    Args:
        nice: by how much.
    """
    if hasattr(os, "nice"):
        os.nice(nice)
    if hasattr(os, "SCHED_IDLE"):  # Linux: who judges is interrupted by none of them
        with suppress(OSError):
            os.sched_setscheduler(0, os.SCHED_IDLE, os.sched_param(0))
