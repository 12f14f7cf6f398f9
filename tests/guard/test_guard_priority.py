"""Who steps back takes its turn after others, and interrupts nobody."""

import os
import subprocess
import sys

import pytest

ASK = """
import os
from elbowroom.guard.priority import step_back
step_back(7)
print(os.nice(0), os.sched_getscheduler(0))
"""


@pytest.mark.skipif(not hasattr(os, "SCHED_IDLE"), reason="no such schedules here")
def test_a_process_that_steps_back_is_nice_and_takes_what_nobody_wants():
    said = subprocess.run(
        [sys.executable, "-c", ASK], capture_output=True, text=True, check=True
    ).stdout.split()
    assert said == [str(min(os.nice(0) + 7, 19)), str(os.SCHED_IDLE)]
