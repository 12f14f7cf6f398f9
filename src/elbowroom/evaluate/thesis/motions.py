"""Motions (thesis 4.1, 5.1.2, Tables 3 and 4): the 35 movements and random ones, beside exact geometry.

The truth is exact mesh distance; apart from it, the same check in the volume of true voxels. A verdict is *s* if it
is in the same band (S, M, L or 0), *ts* if too safe by one band or two, *tts* by three, *u* if less safe than the
truth. Simulated cameras are where they are said to be, so figures are due without an allowance for lateral error;
those with half a pixel stand beside them. The random motions are those of random poses whose truth lies within L, so
that nobody chose them; a *false stop* is a stop where the truth is none.
"""

from collections.abc import Mapping, Sequence
from typing import Any

from elbowroom.evaluate.shares.task import Row, Settings, Task
from elbowroom.evaluate.thesis import movements, random_motions
from elbowroom.evaluate.thesis.movements import movement_blocks, movement_summary, movement_tasks
from elbowroom.evaluate.thesis.part import Part, about
from elbowroom.evaluate.thesis.random_motions import random_blocks, random_summary, random_tasks
from elbowroom.extras import package
from elbowroom.view.report.blocks import Block


def tasks(settings: Settings) -> list[Task]:
    """One for each setup's movements, and one for every 21 random motions.

    Raises:
        PackageError: coal is not installed.
    """
    package("coal")
    return movement_tasks(settings) + random_tasks(settings)


def summary(rows: Sequence[Row]) -> list[dict[str, Any]]:
    """Of each variant its verdicts counted; of the random motions shortfall and false stops by joint."""
    return movement_summary(rows) + random_summary(rows)


def show(rows: Sequence[Row], pictures: Mapping[str, bytes]) -> list[Block]:
    """Verdicts counted beside the thesis', its Table 4 with ours, the random motions."""
    return [about(__doc__), *movement_blocks(rows), *random_blocks(rows)]


PART = Part("motions", "Motions", tasks, summary, show, movements.DUE + random_motions.DUE)
