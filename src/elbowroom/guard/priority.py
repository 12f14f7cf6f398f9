"""How a process steps back for the one that judges."""

import os
from contextlib import suppress


def step_back(nice: int) -> None:
    """Takes less processor time than others where there is too little, and takes it from nobody who has just begun.

    Args:
        nice: by how much.
    """
    if hasattr(os, "nice"):
        os.nice(nice)
    if hasattr(os, "SCHED_BATCH"):  # Linux: who wakes up interrupts nobody
        with suppress(OSError):
            os.sched_setscheduler(0, os.SCHED_BATCH, os.sched_param(0))
