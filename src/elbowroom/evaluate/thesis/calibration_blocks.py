"""Calibration error as tables and curves: what errors of poses cost, and what a margin for them buys."""

from collections.abc import Sequence

from elbowroom.evaluate.shares.task import Row
from elbowroom.evaluate.tables import table_of
from elbowroom.evaluate.thesis.draws import MARGIN
from elbowroom.view.report.blocks import Block, Picture, Table, cm, pct
from elbowroom.view.report.charts import Line, chart


def calibration_blocks(rows: Sequence[Row], due: str) -> list[Block]:
    """The due case, the price of margins in one picture, curves over the error.

    Args:
        rows: of the part, summaries among them.
        due: the figures that are due, in words.
    """
    means = [row for row in rows if row["kind"] == "summary"]
    titles = {
        "due": f"Errors up to 1 degree and 1 cm without margin and with the declared one (due {due})",
        "margins": "The same with other margins, on a third of the room",
        "rotation": "Turned",
        "translation": "Moved",
        "thesis": "The thesis' sensor and point test, no margin: it says the accuracy does not change",
    }
    by_curve = {curve: [row for row in means if row["curve"] == curve] for curve in titles}
    blocks: list[Block] = [_table(titles[curve], mine) for curve, mine in by_curve.items() if mine]
    blocks += _price([*by_curve["due"], *by_curve["margins"]])
    for curve, unit, scale in (("rotation", "degrees", 1.0), ("translation", "cm", 100.0)):
        mine = [row for row in means if row["curve"] in (curve, "rotation") and _of(row, curve)]
        if len(mine) > 2:
            key = f"{curve}_{'deg' if curve == 'rotation' else 'm'}"
            blocks.append(Picture(_curve(mine, key, unit, scale), f"{curve}: mean of the draws", 560))
    return blocks


def _price(rows: Sequence[Row]) -> list[Block]:
    """Occupied and found over the margin."""
    if len(rows) <= 2:
        return []
    points = [
        (r["margin_share"], r["occupied_pct"], r["found_pct"])
        for r in sorted(rows, key=lambda r: float(r["margin_share"]))
    ]
    lines = (
        Line("objects kept (occupied)", [(x, y) for x, y, _ in points]),
        Line("free space found", [(x, y) for x, _, y in points]),
    )
    words = "What margin buys and costs: +-1 degree, +-1 cm, 640x480. Margin as a share of the greatest error"
    return [Picture(chart(lines, "margin", "%"), words, 560)]


def _of(row: Row, curve: str) -> bool:
    """Whether a row belongs to a curve: the exact case is the beginning of both."""
    return row["curve"] == curve or (row["rotation_deg"] == 0 and row["translation_m"] == 0)


def _curve(rows: Sequence[Row], key: str, unit: str, scale: float) -> bytes:
    lines = []
    for share, words in ((0.0, "no margin"), (MARGIN, "declared margin")):
        mine = sorted((r for r in rows if r["margin_share"] == share), key=lambda r: float(r[key]))
        for measure, of in (("occupied_pct", "occupied"), ("found_pct", "found")):
            lines.append(Line(f"{of}, {words}", [(r[key] * scale, r[measure]) for r in mine]))
    return chart(lines, f"greatest error about each axis [{unit}]", "%")


def _table(title: str, rows: Sequence[Row]) -> Table:
    return table_of(
        title,
        rows,
        {
            "sensor": "{sensor}",
            "voxel": lambda r: cm(r["voxel_size_m"]),
            "detail": "{detail}",
            "turned": "{rotation_deg:g} deg",
            "moved": lambda r: cm(r["translation_m"]),
            "margin": "{margin_share:g}",
            "draws": "{draws}",
            "occupied": lambda r: pct(r["occupied_pct"], 3),
            "least": lambda r: pct(r["least_occupied_pct"], 3),
            "found": lambda r: pct(r["found_pct"]),
        },
        left=("sensor", "detail"),
    )
