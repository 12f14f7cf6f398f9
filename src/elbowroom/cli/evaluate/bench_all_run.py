"""The run of `elbowroom bench --all`."""

from pathlib import Path

from elbowroom.cli.evaluate.measured import measured
from elbowroom.cli.evaluate.shown import as_table, voxel
from elbowroom.evaluate.due import Row

QUICK_ROUNDS, QUICK_LONGEST = 2, 5


def run_bench_all(quick: bool, others: bool, json: Path | None) -> None:
    """Every question, a few cases each.

    Args:
        quick: few rounds.
        others: other systems on the same images as well.
        json: file for the rows.
    """
    from elbowroom.evaluate.speed.asked_rows import asked_rows
    from elbowroom.evaluate.speed.questions import DUE, all_asked

    cases = list(all_asked(QUICK_ROUNDS, QUICK_LONGEST) if quick else all_asked())

    def due(row: Row) -> str:
        return ", ".join(due.said for due in DUE if due.of(row))

    show = as_table(
        {
            "question": "{question}",
            "case": _case,
            "voxel": voxel,
            "median": "{median_ms:.1f} ms",
            "99 %": lambda row: f"{row['p99_ms']:.1f} ms" if "p99_ms" in row else "",
            "worst": lambda row: f"{row['max_ms']:.1f} ms" if "max_ms" in row else "",
            "of the worst": lambda row: str(row.get("cause", "")),
            "memory": lambda row: f"{row['peak_rss_mb']:.0f} MB" if row.get("peak_rss_mb") else "",
            "due": due,
        },
        "Each case in a process of its own; due figures are for two cores.",
    )
    measured("cases", asked_rows(cases, others), len(cases) + (6 if others else 0), json, show)


def _case(row: Row) -> str:
    if row["question"] == "others":
        return f"{row['case']} ({row['times_as_long']:.1f} times carve)"
    if row["scene"] == "balls":
        return f"{row['voxels']:,} voxels, {row['surface_voxels']:,} of a surface"
    seen = f"{row['cameras']} of {row['width']}x{row['height']}, {row['detail']}"
    return f"{seen}, {row['scene']}, {row['threads']} threads"
