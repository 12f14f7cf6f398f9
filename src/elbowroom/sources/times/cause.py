"""Why times that should meet do not: another unit, another epoch, a time zone, another time scale."""

from dataclasses import dataclass

from elbowroom.sources.times.series import are_dates, length_text
from elbowroom.sources.times.stamp import NS, WORDS

ZONE_S = 900
"""Zones are multiples of a quarter of an hour, up to 14 hours [s]."""
SCALES_S = {37: "PTP clocks count TAI, 37 s ahead of UTC", 18: "GPS time is 18 s ahead of UTC"}
"""Differences of time scales [s]."""
NEAR_S = 1.5


@dataclass(frozen=True, slots=True)
class Span:
    """From a first time to a last.

    Args:
        first_ns, last_ns: [ns].
    """

    first_ns: int
    last_ns: int

    @property
    def are_dates(self) -> bool:
        """Whether they lie between the years 2000 and 2100."""
        return are_dates(self.first_ns, self.last_ns)

    def covers(self, other: "Span", factor: float = 1.0) -> bool:
        """Whether they overlap if this one's numbers are multiplied.

        Args:
            other: another span.
            factor: for this one's times.
        """
        return self.first_ns * factor <= other.last_ns and other.first_ns <= self.last_ns * factor


def cause_text(odd: Span, others: Span) -> str:
    """The likely cause, as the end of a sentence.

    Args:
        odd: what does not meet the others.
        others: what it should meet.
    """
    # an epoch that is a date is a strong sign; spans that begin near zero overlap in any unit
    for unit, factor in NS.items():
        if factor > 1 and others.first_ns > 0 and odd.covers(others, factor) and odd.first_ns > 0:
            return f"they look like {WORDS[unit]} where the others are nanoseconds"
        if factor > 1 and others.first_ns > 0 and odd.covers(others, 1 / factor) and odd.first_ns > 0:
            return f"the others look like {WORDS[unit]} where these are nanoseconds"
    if odd.are_dates != others.are_dates:
        these, those = ("these", "the others") if others.are_dates else ("the others", "these")
        return f"{these} count from a start, {those} from 1970"
    away_s = abs(odd.first_ns - others.first_ns) / 1e9
    for length_s, words in SCALES_S.items():
        if abs(away_s - length_s) < NEAR_S:
            return f"{away_s:.1f} s apart: {words}"
    zones = round(away_s / ZONE_S)
    if 0 < zones <= 56 and abs(away_s - zones * ZONE_S) < NEAR_S:
        return f"{length_text(away_s * 1e9)} apart: local time of another zone, or summer time"
    return f"another clock, {length_text(away_s * 1e9)} off, or another recording"
