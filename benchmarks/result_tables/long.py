"""What shows only after long: memory that grows, and input that nobody thought of."""

from collections.abc import Sequence

from elbowroom.evaluate.held_memory import words_of_slope
from elbowroom.evaluate.malformed import campaign
from elbowroom.evaluate.soak import soak
from result_tables.cells import Cell, Row, of, table

SOAK: dict[str, Cell] = {
    "cameras": of("cameras"),
    "ran [s]": of("seconds", 0),
    "passes": of("passes"),
    "late": of("late"),
    "median [ms]": of("median_ms", 0),
    "99 % [ms]": of("p99_ms", 0, due=soak.DUE),
    "worst [ms]": of("max_ms", 0),
    "the worst": soak.words_of_worst,
    "lost": of("lost", due=soak.DUE),
    "recorder, of a core": of("recorder_core_share", 2),
    "holds [MB]": of("resident_mb", 0),
    "memory grows by": words_of_slope,
    "grows": of("grows", due=soak.DUE),
}
MALFORMED: dict[str, Cell] = {
    "reader": of("target"),
    "processor [s]": of("cpu_s", 0),
    "inputs": of("inputs"),
    "branches": of("branches"),
    "crashes": of("crashes", due=campaign.DUE),
    "hangs": of("hangs", due=campaign.DUE),
    "allocations": of("allocations", due=campaign.DUE),
}


def soak_tables(rows: Sequence[Row]) -> list[str]:
    """A row for each run."""
    return table(rows, SOAK)


def malformed_tables(rows: Sequence[Row]) -> list[str]:
    """A row for each reader."""
    return table(rows, MALFORMED)
