"""Whether recordings keep up, open wherever they are cut off, and are judged again to the same bits."""

from collections.abc import Sequence

from elbowroom.evaluate.held_memory import words_of_slope
from elbowroom.evaluate.recording import again, cut, rate
from result_tables.cells import Cell, Row, of, table

RECORD: dict[str, Cell] = {
    "case": of("case"),
    "cameras": of("cameras"),
    "ran [s]": of("seconds", 0),
    "raw [MB/s]": of("raw_mb_s", 0),
    "file [MB/s]": of("file_mb_s", 0),
    "lost": of("lost", due=rate.DUE),
    "of a core": of("core_share", 2, due=rate.DUE),
    "raw, a core [MB/s]": of("raw_mb_s_of_a_core", 0),
    "not as given": of("not_as_given", due=rate.DUE),
    "handed over in, at worst [ms]": of("handed_over_ms", 1),
    "memory grows by [MB/h]": words_of_slope,
}
CUT: dict[str, Cell] = {
    "case": of("case"),
    "times": of("times"),
    "not opened": of("not_opened", due=cut.DUE),
    "passes lost, at most": of("most_lost", due=cut.DUE),
    "passes not as they were": of("other", due=cut.DUE),
    "cuts unsaid": of("unsaid"),
}
BITS: dict[str, Cell] = {
    "case": of("case"),
    "times": of("times"),
    "unnoticed": of("unnoticed", due=cut.DUE),
}
REPLAY: dict[str, Cell] = {
    "room": of("room"),
    "way": of("way"),
    "cycles": of("cycles"),
    "verdicts": of("verdicts"),
    "different": of("different", due=again.DUE),
}


def record_tables(rows: Sequence[Row]) -> list[str]:
    """A row for each run."""
    return table(rows, RECORD)


def cut_tables(rows: Sequence[Row]) -> list[str]:
    """Cuts, then bits."""
    cuts = table([row for row in rows if row["case"] == "cut off"], CUT)
    return [*cuts, "", *table([row for row in rows if row["case"] != "cut off"], BITS)]


def replay_tables(rows: Sequence[Row]) -> list[str]:
    """A row for each way."""
    return table(rows, REPLAY)
