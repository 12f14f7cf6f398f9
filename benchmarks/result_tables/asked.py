"""What a cycle costs by one thing at a time, as tables and as the power that each curve follows."""

from collections.abc import Callable, Sequence

import numpy as np

from elbowroom.evaluate.speed import others
from elbowroom.evaluate.speed.questions import DUE, HEADLINE
from elbowroom.view.report.charts import Line, chart
from result_tables.cells import Cell, Row, centimetres, of, same, table

CURVES: dict[str, tuple[str, Callable[[Row], float]]] = {
    "voxels": ("voxels of a metre", lambda row: row["voxel_size_m"] ** -3),
    "cameras": ("cameras", lambda row: row["cameras"]),
    "pixels": ("pixels", lambda row: row["cameras"] * row["width"] * row["height"]),
    "volume": ("volume at the same surface", lambda row: row["voxels"]),
    "surface": ("surface in the same volume", lambda row: row["surface_voxels"]),
}
"""By question, what it varies: in words, and of a row."""
PICTURE = "bench_curves.svg"
CAPTION = "Cost of a cycle or carve over voxels, cameras, pixels, volume and surface"
SAYS = {
    "voxels": "finer voxels cost less than their number: most of space is settled by cubes of 16 and blocks of 4",
    "cameras": "each camera has an image to prepare; in the carve three that see through a voxel save the others",
    "pixels": "an image is read once; what a voxel asks of it grows with the pixels that the voxel covers",
    "volume": "empty space is settled by cubes, and costs less than in proportion",
    "surface": "what lies at a surface is asked voxel by voxel and pixel by pixel",
}
"""What the shape of each curve says."""


def asked_tables(rows: Sequence[Row]) -> list[str]:
    """The headline, a table a question, the powers, and other systems."""
    lines: list[str] = []
    questions = dict.fromkeys(row["question"] for row in rows)
    for question in questions:
        own = [row for row in rows if row["question"] == question]
        lines += ["", f"**{question[0].upper()}{question[1:]}**", ""]
        lines += _others(own) if question == "others" else table(own, _columns(question))
    return [*lines, "", *_powers(rows), "", f"![{CAPTION}](images/{PICTURE})"]


def curves(rows: Sequence[Row]) -> bytes:
    """Cost over what each question varies, both as shares of the greatest, as SVG.

    Raises:
        PackageError: Matplotlib is not installed.
    """
    lines = []
    for question, (what, across) in CURVES.items():
        own = sorted((row for row in rows if row["question"] == question), key=across)
        if own:
            most, dearest = across(own[-1]), own[-1]["median_ms"]
            points = [(across(row) / most, row["median_ms"] / dearest) for row in own]
            lines.append(Line(what, points))
    return chart(lines, "share of the greatest", "cost, share of that at the greatest", logarithmic=True)


def power_of(across: Sequence[float], cost: Sequence[float]) -> float:
    """The power that cost follows over a quantity, by least squares of logarithms.

    Args:
        across: of the quantity, at least two.
        cost: at each.
    """
    return float(np.polyfit(np.log(across), np.log(cost), 1)[0])


def _columns(question: str) -> dict[str, Cell]:
    columns: dict[str, Cell] = {"voxel": centimetres}
    if question in ("volume", "surface"):
        columns |= {"voxels": of("voxels"), "of a surface": of("surface_voxels")}
    else:
        columns |= {"cameras": lambda row: f"{row['cameras']} x {row['width']}x{row['height']}"}
        columns |= same("detail", "scene", "threads")
    columns |= {
        "median ms": of("median_ms", 1),
        "99 % ms": of("p99_ms", 1, due=DUE),
        "worst ms": of("max_ms", 1),
        "the worst had": of("cause"),
        "peak MB": of("peak_rss_mb", 0, due=DUE),
    }
    if question == HEADLINE:
        columns["stages ms"] = lambda row: ", ".join(f"{k} {v:.1f}" for k, v in row["stages_ms"].items())
    return columns


def _others(rows: Sequence[Row]) -> list[str]:
    columns = {"voxel": centimetres, **same("case"), "median ms": of("median_ms", 1), **same("rounds")}
    return table(rows, columns | {"times as long as carve": of("times_as_long", 1, due=others.DUE)})


def _powers(rows: Sequence[Row]) -> list[str]:
    lines = []
    for question, (what, across) in CURVES.items():
        own = [row for row in rows if row["question"] == question]
        if len({across(row) for row in own}) > 1:
            power = power_of([across(row) for row in own], [row["median_ms"] for row in own])
            lines.append(f"- Cost grows with {what} to the power of {power:.2f}: {SAYS[question]}.")
    return lines
