"""What looks after distances while a run lasts: it measures reaction times and says the margins of each pass."""

import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import Self

from elbowroom.monitor.result import CycleResult
from elbowroom.monitor.separation.figures import Figures, figures_of
from elbowroom.monitor.separation.margins import Margins
from elbowroom.monitor.separation.reaction import ReactionWatch
from elbowroom.sensing import Snapshot
from elbowroom.sources import Room


@dataclass(frozen=True, slots=True, eq=False)
class Separating:
    """Margins of each pass; what it remembers is the reaction time.

    Args:
        figures: of the site.
        watch: measures.
        clock_ns: by which it is measured; it never goes back [ns].
    """

    figures: Figures
    watch: ReactionWatch
    clock_ns: Callable[[], int] = time.perf_counter_ns

    @classmethod
    def of(cls, room: Room) -> Self:
        """For a room whose machine's motions are judged; raises as `figures_of`."""
        return cls(figures_of(room), ReactionWatch(room.terms.max_age_ns))

    def judged(
        self, snapshot: Snapshot, result: CycleResult, pass_ms: float, output_ms: float
    ) -> Margins | None:
        """The margins of a pass; None: it failed, so that no distance is known.

        Args:
            snapshot: what it was about.
            result: what it came to.
            pass_ms: from its beginning to its verdicts, as the clock has it [ms].
            output_ms: from its verdicts to its decision [ms].
        """
        reaction = self.watch.add(snapshot, pass_ms, output_ms)
        worst = self.watch.worst
        if result.distances is None:
            return None
        return Margins(result.distances, self.figures, reaction, None if worst is None else worst.total_ms)
