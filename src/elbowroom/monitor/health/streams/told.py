"""What is sick as rows: when it comes, each second while it lasts, and when it is over."""

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any

from elbowroom.monitor.health.streams.cause import HealthCause, Sick

AGAIN_S = 1.0
"""What lasts is said again after so long [s]."""


def sick_row(sick: Sick) -> dict[str, Any]:
    """As a row of a pass holds it."""
    return {
        "cause": sick.cause.word,
        "source": sick.source,
        "text": sick.text,
        "clears": sick.clears,
        "lasts_s": sick.lasts_s,
        "left_out": sick.leaves_out,
        "stops": sick.stops,
        "latches": sick.latches,
    }


def sick_lines(sick: Sequence[Sick]) -> list[str]:
    """What an operator reads: of each source what is wrong, and that it is left out, or that all is stop."""
    return [
        f"{'Left out' if each.leaves_out else 'Stop'}: {each.text} (until {each.clears}; {each.lasts_s:.1f} s)"
        for each in sick
    ]


@dataclass(slots=True, eq=False)
class SickRows:
    """Rows of kind "sick".

    Args:
        clock_s: the time [s].
    """

    clock_s: Callable[[], float] = time.monotonic
    _told_s: dict[tuple[HealthCause, str], float] = field(default_factory=dict, init=False)

    def rows(self, sick: Sequence[Sick]) -> list[dict[str, Any]]:
        """What is to be told of a pass: what is new, what was not told for a second, and what is over.

        Args:
            sick: all that is there now.
        """
        now_s, rows = self.clock_s(), []
        for each in sick:
            of = each.cause, each.source
            if now_s - self._told_s.get(of, float("-inf")) >= AGAIN_S:
                self._told_s[of] = now_s
                rows.append({"kind": "sick", "is_there": True, **sick_row(each)})
        there = {(each.cause, each.source) for each in sick}
        for cause, source in [of for of in self._told_s if of not in there]:
            del self._told_s[cause, source]
            rows.append({"kind": "sick", "is_there": False, "cause": cause.word, "source": source})
        return rows
