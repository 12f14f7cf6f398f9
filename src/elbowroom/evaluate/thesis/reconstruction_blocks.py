"""Reconstruction accuracy as tables and pictures, beside the thesis' Table 2."""

from collections.abc import Mapping, Sequence

from elbowroom.evaluate.shares.task import Row
from elbowroom.evaluate.tables import table_of
from elbowroom.evaluate.thesis.thesis import TABLE_2
from elbowroom.view.report.blocks import Block, Picture, Table, cm, pct

COLOURS = "white: free, found; blue: free, not found; green: object, kept; red: object, declared free; grey: machine"


def reconstruction_blocks(rows: Sequence[Row], pictures: Mapping[str, bytes]) -> list[Block]:
    """Tables beside the thesis' Table 2, the trade of its sensor, pictures of the four cases."""
    means = [row for row in rows if row["kind"] == "summary" and row["of"] == "reconstruction"]
    trades = [row for row in rows if row["kind"] == "summary" and row["of"] == "trade"]
    own = [row for row in rows if row["kind"] == "reconstruction"]
    edges = sorted({r["voxel_size_m"] for r in own})
    blocks: list[Block] = [_mean_table(means)]
    blocks += [_by_setup(own, sensor, edges) for sensor in dict.fromkeys(r["sensor"] for r in own)]
    if trades:
        blocks.append(_trade_table(trades))
    for name, png in sorted(pictures.items()):
        wide = name.endswith("section")
        blocks.append(Picture(png, f"{name.replace('-', ' ')} (5 cm). {COLOURS}", 560 if wide else 400))
    return blocks


def _mean_table(means: Sequence[Row]) -> Table:
    return table_of(
        "Mean of the setups [%]; in brackets the least of them. Thesis: free 98.9, occupied 91.1 (its table: 90.4)",
        means,
        {
            "sensor": "{sensor}",
            "noise": lambda r: "yes" if r["noise"] else "no",
            "voxel": lambda r: cm(r["voxel_size_m"]),
            "detail": "{detail}",
            "occupied, touched": lambda r: f"{pct(r['occupied_pct'], 3)} ({pct(r['least_occupied_pct'], 3)})",
            "occupied, centre": lambda r: pct(r["occupied_centre_pct"], 3),
            "found of seen": lambda r: pct(r["found_pct"]),
            "free of all": lambda r: pct(r["free_pct"]),
        },
        left=("sensor", "noise", "detail"),
    )


def _trade_table(trades: Sequence[Row]) -> Table:
    return table_of(
        "What the thesis' sensor trades: 64x48, 5 cm, no noise, pixel test, by how much a pixel is widened",
        trades,
        {
            "widened by": "{lateral_px:g} px",
            "occupied, touched": lambda r: pct(r["occupied_pct"], 3),
            "least of setups": lambda r: pct(r["least_occupied_pct"], 3),
            "found of seen": lambda r: pct(r["found_pct"]),
        },
        left=("widened by",),
    )


def _by_setup(rows: Sequence[Row], sensor: str, edges: Sequence[float]) -> Table:
    """As the thesis' Table 2: free and occupied per setup, without noise."""
    kinds = [(edge, detail) for edge in edges for detail in ("point", "pixel")]
    lines = []
    for number in sorted({r["setup"] for r in rows}):
        found = {
            (r["voxel_size_m"], r["detail"]): f"{pct(r['free_pct'], 1)} / {pct(r['occupied_pct'], 2)}"
            for r in rows
            if (r["setup"], r["sensor"], r["noise"]) == (number, sensor, False)
        }
        printed = f"{TABLE_2[number][0]:.1f} / {TABLE_2[number][1]:.1f}"
        lines.append([str(number), printed, *(found[kind] for kind in kinds if kind in found)])
    columns = [f"{cm(edge)} {detail}" for edge, detail in kinds]
    return Table(
        f"{sensor}, no noise: free of all / occupied (touched) [%]", ("setup", "thesis", *columns), lines
    )
