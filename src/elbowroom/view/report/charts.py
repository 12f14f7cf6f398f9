"""Charts of the report, as SVG: lines over an axis, drawn by Matplotlib."""

import io
from collections.abc import Sequence
from dataclasses import dataclass

from elbowroom.extras import package

COLOURS = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9")
"""After Okabe and Ito (2008): colour-blind eyes tell them apart."""


@dataclass(frozen=True, slots=True)
class Line:
    """A line of a chart: its name and its points (x, y)."""

    name: str
    points: Sequence[tuple[float, float]]


def chart(
    lines: Sequence[Line],
    x: str,
    y: str,
    *,
    logarithmic: bool = False,
    y_range: tuple[float, float] | None = None,
) -> bytes:
    """A chart of lines with a legend, as SVG.

    Args:
        lines: at most as many as there are colours.
        x, y: names of the axes, with units.
        logarithmic: whether x is.
        y_range: least and greatest y; None: what the lines need.

    Raises:
        PackageError: Matplotlib is not installed.
    """
    figure = package("matplotlib.figure").Figure(figsize=(6.4, 3.8), layout="constrained")
    axes = figure.add_subplot()
    marks = "osD^vP"
    for number, line in enumerate(lines):
        xs, ys = zip(*line.points, strict=True) if line.points else ((), ())
        axes.plot(xs, ys, marks[number % 6] + "-", color=COLOURS[number % 6], label=line.name, markersize=4)
    axes.set(xlabel=x, ylabel=y)
    if logarithmic:
        axes.set_xscale("log")
    if y_range is not None:
        axes.set_ylim(y_range)
    axes.grid(alpha=0.3)
    axes.legend(fontsize=8)
    buffer = io.BytesIO()
    # without a date and with fixed names the same lines give the same file
    figure.canvas = package("matplotlib.backends.backend_svg").FigureCanvasSVG(figure)
    figure.savefig(buffer, format="svg", metadata={"Date": None})
    return buffer.getvalue()
