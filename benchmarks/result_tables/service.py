"""Attacks on the control service of a running monitor."""

from collections.abc import Sequence

from elbowroom.evaluate.service.rows import DUE
from result_tables.cells import Cell, Row, of, table

ATTACKS: dict[str, Cell] = {
    "attack": of("case"),
    "requests": of("requests"),
    "let in": of("let_in", due=DUE),
    "answered": of("answered"),
}
PASSES: dict[str, Cell] = {
    "requests": of("requests"),
    "let in": of("let_in", due=DUE),
    "passes": of("passes"),
    "median left alone [ms]": of("alone_median_ms", 1),
    "attacked ": of("attacked_median_ms", 1),
    "99 % left alone": of("alone_p99_ms", 1),
    "attacked  ": of("attacked_p99_ms", 1),
    "worst left alone": of("alone_worst_ms", 1),
    "attacked": of("attacked_worst_ms", 1),
    "later": of("later_ms", 1, due=DUE),
    "later, of a server that only closes": of("attacker_later_ms", 1),
    "later than of that": of("service_later_ms", 1, due=DUE),
}


def service_tables(rows: Sequence[Row]) -> list[str]:
    """A row for each kind of attack, and one of the passes."""
    kinds = {kind: [row for row in rows if row["kind"] == kind] for kind in ("attack", "service")}
    return [*table(kinds["attack"], ATTACKS), "", *table(kinds["service"], PASSES)]
