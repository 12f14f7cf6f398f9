"""Times and memory of the cycle, and of the start, due figures beside them."""

from collections.abc import Iterable, Sequence
from typing import Any

from elbowroom.evaluate.due import due_of
from elbowroom.evaluate.speed import fine_machine, parts, start
from elbowroom.evaluate.speed.bench import DUE
from result_tables.cells import Cell, Row, centimetres, of, same, table

STAGE = "cycle/"
"""Cases that begin so are stages of the cycle."""
KIND = ("voxel_size_m", "detail", "noise")
"""What tells one cycle from another."""


def bench_tables(rows: Sequence[Row]) -> list[str]:
    """Times, then the stages of a cycle."""
    whole = [row for row in rows if "/" not in str(row.get("case"))]
    lines = table(
        whole,
        {
            **same("case"),
            "voxel": centimetres,
            "cameras": lambda row: f"{row.get('cameras')} x {row.get('width')}x{row.get('height')}",
            **same("detail", "noise", "threads"),
            "median ms": of("median_ms", 1, due=DUE),
            "99 % ms": of("p99_ms", 1),
            "worst ms": of("max_ms", 1),
            "peak MB": of("peak_rss_mb", 0, due=DUE),
            "ratio": of("ratio", 2),
        },
    )
    lines += _against_octomap(rows)
    stages = _stages(row for row in rows if str(row.get("case")).startswith(STAGE))
    return [*lines, "", "Stages of the cycle, medians:", "", *stages] if stages else lines


def start_tables(rows: Sequence[Row]) -> list[str]:
    """Times of new processes, beside those of an earlier commit."""
    return table(
        rows,
        {
            **same("case", "rounds"),
            "median ms": of("median_ms", 0, due=start.DUE),
            "99 % ms": of("p99_ms", 0),
            "worst ms": of("max_ms", 0),
            "processor time, median ms": of("cpu_median_ms", 0),
            "before, median ms": of("before_ms", 0),
            "before, processor time ms": of("before_cpu_ms", 0),
        },
    )


def parts_tables(rows: Sequence[Row]) -> list[str]:
    """Times of the machine's parts of a pass, beside those of an earlier commit."""
    return table(
        rows,
        {
            **same("case", "threads", "rounds"),
            "median ms": of("median_ms", 1, due=parts.DUE),
            "99 % ms": of("p99_ms", 1),
            "processor time, median ms": of("cpu_median_ms", 1),
            "before, median ms": of("before_ms", 1),
            "before, processor time ms": of("before_cpu_ms", 1),
        },
    )


def machine_tables(rows: Sequence[Row]) -> list[str]:
    """What triangles of a machine's meshes cost."""
    return table(
        rows,
        {
            **same("case", "triangles"),
            "of which are drawn": of("drawn_triangles"),
            **same("cameras", "rounds"),
            "median ms": of("median_ms", 2, due=fine_machine.DUE),
            "worst ms": of("max_ms", 2),
            "processor time, median ms": of("cpu_median_ms", 2),
            "times as long as the least": of("times_as_long", 2),
        },
    )


def _against_octomap(rows: Sequence[Row]) -> list[str]:
    lines = []
    for row in rows:
        due = due_of(DUE, "times_slower_than_carve", row)
        if due is not None and (times := row.get(due.key)):
            wanted = f"due {due.sign} {due.for_row(row):g}{'' if due.met(row) else ': missed'}"
            lines += ["", f"OctoMap takes {times:.0f} times as long as carve on the same images ({wanted})."]
    return lines


def _stages(rows: Iterable[Row]) -> list[str]:
    """A line for each kind of cycle, a column for each stage; nothing of no rows."""
    kinds: dict[tuple[Any, ...], dict[str, Any]] = {}
    for row in rows:
        kind = {key: row[key] for key in KIND}
        line = kinds.setdefault(tuple(kind.values()), kind)
        line[row["case"].removeprefix(STAGE)] = row["median_ms"]
    names = dict.fromkeys(name for line in kinds.values() for name in line if name not in KIND)
    columns: dict[str, Cell] = {"voxel": centimetres, **same("detail", "noise")}
    columns |= {f"{name} ms": of(name, 1) for name in names}
    return table(kinds.values(), columns) if kinds else []
