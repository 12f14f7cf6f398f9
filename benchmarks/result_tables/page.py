"""The page: its cost, its speed, and who got in."""

from collections.abc import Sequence

from elbowroom.evaluate.page.measured import DUE
from result_tables.cells import Cell, Row, of, table

PICTURE: dict[str, Cell] = {
    "address known, s": of("url_s", 1),
    "first verdict in words, s": of("text_s", 1),
    "first full picture, s": of("first_picture_s", 1, due=DUE),
}
UPDATES: dict[str, Cell] = {
    "MB a second": of("second_mb", 2, due=DUE),
    "blocked space, Hz": of("space_hz", 1, due=DUE),
    "joints, Hz": of("joints_hz", 1, due=DUE),
    "texts, Hz": of("text_hz", 1),
}
CLICK: dict[str, Cell] = {
    "clicks": of("clicks"),
    "to the whole sentence, median ms": of("sentence_ms", 0, due=DUE),
    "worst ms": of("worst_ms", 0),
}
COST: dict[str, Cell] = {
    "cycles, each": of("cycles"),
    "median ms": of("median_ms", 1),
    "without": of("median_without_ms", 1),
    "p99 ms": of("p99_ms", 1),
    "without ": of("p99_without_ms", 1),
    "p99 more, %": of("p99_more_pct", 1, due=DUE),
    "two halves without differ by, %": of("alike_pct", 1),
}
ATTACK: dict[str, Cell] = {
    "attack": of("attack"),
    "tried": of("tried"),
    "a second": lambda row: f"{row['per_s']:.0f}" if "per_s" in row else "-",
    "let in": of("let_in", due=DUE),
}
FLOODED: dict[str, Cell] = {
    "cycles, each": of("cycles"),
    "p99 while attacked, ms": of("p99_ms", 1),
    "before, ms": of("p99_without_ms", 1),
    "later, ms": of("later_ms", 1, due=DUE),
}
REPORT: dict[str, Cell] = {
    "cycles": of("cycles"),
    "room drawn": of("drawn"),
    "MB": of("size_mb", 1, due=DUE),
    "written in, s": of("took_s", 0),
}
PARTS = {
    "picture": PICTURE,
    "updates": UPDATES,
    "click": CLICK,
    "cost": COST,
    "attack": ATTACK,
    "flooded": FLOODED,
    "report": REPORT,
}


def page_tables(rows: Sequence[Row]) -> list[str]:
    """A table for each part."""
    lines: list[str] = []
    for part, cells in PARTS.items():
        found = [row for row in rows if row.get("part") == part]
        lines += [*table(found, cells), ""] if found else []
    return lines
