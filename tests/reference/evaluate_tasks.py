"""Small work for tests of who does it: importable by other processes."""

import os
from pathlib import Path

from elbowroom.evaluate.shares.task import Outcome


def square(number: int) -> Outcome:
    return Outcome([{"number": number, "square": number * number}], {f"p{number}": bytes([number])})


def dies_once(number: int, mark: str) -> Outcome:
    """The first time the process that does it is gone, as if killed."""
    if not Path(mark).exists():
        Path(mark).touch()
        os._exit(9)
    return square(number)
