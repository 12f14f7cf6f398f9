"""The figures that the project set out to reach, beside those found; what misses is said to miss."""

from collections.abc import Callable, Sequence
from typing import Any

from elbowroom.evaluate.shares.task import Row
from elbowroom.view.report.blocks import Table, pct

Pick = Callable[[Row], bool]


def due_table(rows: Sequence[Row]) -> Table | None:
    """A line for each figure that the rows answer; None if they answer none.

    Args:
        rows: of all parts, each with its `part`, summaries among them.
    """
    lines = [
        *_reconstruction(rows),
        *_motions(rows),
        *_calibration(rows),
        *_scale(rows),
    ]
    if not lines:
        return None
    columns = ("figure", "thesis", "due", "found", "")
    return Table("What was due", columns, lines, left=(0, 4))


def _reconstruction(rows: Sequence[Row]) -> list[tuple[str, ...]]:
    lines = []
    for edge, words in ((0.05, "5 cm"), (0.02, "2 cm")):
        for detail, least in (("footprint", 100.0), ("pixel", 99.99)):
            found = [r["occupied_pct"] for r in _own(rows, "640x480", False, edge, detail)]
            if found:
                lines.append(
                    _at_least(
                        f"occupied, 640x480, {words}, {detail}, worst setup [%]", "91.1", least, min(found), 4
                    )
                )
    for edge, words, least in ((0.02, "2 cm", 98.0), (0.05, "5 cm", 95.0)):
        for row in _means(rows, "640x480", False, edge, "pixel"):
            name = f"found of what is seen, 640x480, {words}, pixel, mean [%]"
            lines.append(
                _at_least(name, "98.9 of all", least, row["found_pct"], 2, f"{pct(row['free_pct'])} of all")
            )
    trades = [r for r in rows if r.get("kind") == "summary" and r.get("of") == "trade"]
    both = [r for r in trades if r["occupied_pct"] >= 98.5] or trades
    for row in sorted(both, key=lambda r: -float(r["found_pct"]))[:1]:
        words = f"pixels widened by {row['lateral_px']:g} px"
        name = "64x48, 5 cm, pixel: occupied [%]"
        lines.append(_at_least(name, "91.1", 98.5, row["occupied_pct"], 2, words))
        lines.append(
            _at_least("and found of what is seen [%]", "98.9 of all", 90.0, row["found_pct"], 2, words)
        )
    for row in _means(rows, "640x480", True, 0.02, "pixel"):
        name = "with sensor noise, 640x480, 2 cm, pixel: occupied [%]"
        lines.append(_at_least(name, "", 99.99, row["occupied_pct"], 4))
        lines.append(_at_least("and found of what is seen [%]", "", 92.0, row["found_pct"], 2))
    return lines


def _motions(rows: Sequence[Row]) -> list[tuple[str, ...]]:
    lines = []
    summaries = [r for r in rows if r.get("kind") == "summary" and r.get("part") == "motions"]
    for row in [r for r in summaries if r["of"] == "movement"][:1]:
        right = 31 * row["movements"] / 35
        of = f"of {row['movements']}"
        lines.append(_at_most(f"movements: unsafe, {of}", "2", 0, row["u"]))
        lines.append(_at_most("and of small objects", "2", 0, row["unsafe_of_small_objects"]))
        lines.append(_at_least(f"movements: right band, {of}", "27", right, row["s"], 0))
        lines.append(_at_most("movements: too safe by three bands", "1", 0, row["tts"]))
    for row in [r for r in summaries if r["of"] == "random"][:1]:
        lines.append(_at_most(f"random motions: unsafe, of {row['motions']}", "", 0, row["u"]))
        lines.append(_at_most("and of small objects", "", 0, row["unsafe_of_small_objects"]))
        short = row["median_shortfall_voxels"]
        lines.append(_at_most("random motions: median shortfall [voxels]", "", 2, short))
    return lines


def _calibration(rows: Sequence[Row]) -> list[tuple[str, ...]]:
    lines = []
    for row in rows:
        mine = row.get("part") == "calibration" and row.get("kind") == "summary" and row["curve"] == "due"
        if mine and row["margin_share"] > 0:
            name = "+-1 degree, +-1 cm, declared margin, 5 cm: occupied [%]"
            lines.append(_at_least(name, "unchanged", 99.99, row["occupied_pct"], 4))
            lines.append(_at_least("and found of what is seen [%]", "unchanged", 75.0, row["found_pct"], 2))
    return lines


def _scale(rows: Sequence[Row]) -> list[tuple[str, ...]]:
    lines = []
    summaries = [r for r in rows if r.get("kind") == "summary" and r.get("part") == "scale"]
    finest = min((r["voxel_size_m"] for r in summaries), default=0.0)
    for row in [r for r in summaries if r["noise"] and not r["losses"] and r["voxel_size_m"] == finest]:
        name = f"scale model, noise: more than the truth, of {row['motions']}"
        lines.append(_at_most(name, "", 0, row["more_than_truth"]))
        for key, most in (("median", 5), ("worst", 12)):
            name = f"scale model, noise, the {row['in_view']} ways in view: short by, {key} [mm]"
            lines.append(_at_most(name, "5", most, row[f"{key}_in_view_short_mm"]))
    return lines


def _own(rows: Sequence[Row], sensor: str, noise: bool, edge: float, detail: str) -> list[Row]:
    return [r for r in rows if r.get("kind") == "reconstruction" and _is(r, sensor, noise, edge, detail)]


def _means(rows: Sequence[Row], sensor: str, noise: bool, edge: float, detail: str) -> list[Row]:
    of = [r for r in rows if r.get("kind") == "summary" and r.get("of") == "reconstruction"]
    return [r for r in of if _is(r, sensor, noise, edge, detail)]


def _is(row: Row, sensor: str, noise: bool, edge: float, detail: str) -> bool:
    said = (row["sensor"], row["noise"], row["detail"])
    return said == (sensor, noise, detail) and abs(row["voxel_size_m"] - edge) < 1e-9


def _at_least(
    name: str, thesis: str, due: float, found: float, digits: int, words: str = ""
) -> tuple[str, ...]:
    verdict = "reached" if found >= due else "missed"
    return name, thesis, f"{due:g}", pct(found, digits), f"{verdict}{'; ' + words if words else ''}"


def _at_most(name: str, thesis: str, due: float, found: Any) -> tuple[str, ...]:
    text = "-" if found is None else f"{found:.1f}" if isinstance(found, float) else str(found)
    return name, thesis, f"{due:g}", text, "reached" if found is not None and found <= due else "missed"
