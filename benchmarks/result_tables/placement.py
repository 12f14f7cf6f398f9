"""Layouts of cameras."""

from collections.abc import Sequence

from elbowroom.evaluate.placement.rows import DUE
from result_tables.cells import Cell, Row, centimetres, of, plain, table


def placement_tables(rows: Sequence[Row]) -> list[str]:
    """Time of verification and sweep, optimised layouts, prediction beside what is found."""
    kinds = {kind: [row for row in rows if row["kind"] == kind] for kind in DUE}
    return [
        *table([*kinds["verify"], *kinds["sweep"]], {"what": _what, "seconds": _seconds}),
        "",
        *table(kinds["optimise"], OPTIMISED),
        "",
        *table(kinds["prediction"], PREDICTED),
    ]


def _what(row: Row) -> str:
    if row["kind"] == "verify":
        return f"{row['cameras']} cameras, {row['points']:,} points"
    return f"{row['layouts']} layouts at {centimetres(row)}"


def _seconds(row: Row) -> str:
    key, digits = ("median_s", 2) if row["kind"] == "verify" else ("seconds", 1)
    return of(key, digits, due=DUE[row["kind"]])(row)


def _apart(row: Row) -> str:
    """Without its sign."""
    apart = {"difference_pct": abs(row["difference_pct"])}
    return of("difference_pct", 2, due=DUE["prediction"])(apart)


OPTIMISED: dict[str, Cell] = {
    "optimised for": of("what"),
    "cameras": of("cameras", due=DUE["optimise"]),
    "valid, verified [%]": of("valid_pct", 2, due=DUE["optimise"]),
    "bound": of("bound"),
    "candidates": of("candidates"),
    "points": of("points"),
    "19 or fewer after [s]": of("seconds_to_19", 0, due=DUE["optimise"]),
    "seconds": of("seconds", 0),
}
PREDICTED: dict[str, Cell] = {
    "room": of("room"),
    "images": of("size"),
    "voxel": centimetres,
    "scenes": of("scenes"),
    "predicted [%]": lambda row: f"{row['predicted_free_pct']:.2f} ± {row['predicted_error_pct']:.2f}",
    "found [%]": of("found_free_pct", 2),
    "apart at most [points]": _apart,
}


def sweep_tables(rows: Sequence[Row]) -> list[str]:
    """A row for each room and sensor: the share at some numbers of cameras, the least number, the time."""
    shares = {
        (row["room"], row["sensor"], row["cameras"]): row["valid_pct"]
        for row in rows
        if row["kind"] == "layout"
    }

    def share(count: int) -> Cell:
        return lambda row: plain(round(shares[row["room"], row["sensor"], count], 2))

    return table(
        [row for row in rows if row["kind"] == "sweep"],
        {
            "room": of("room"),
            "sensor": of("sensor"),
            **{f"{count} cameras [%]": share(count) for count in (8, 12, 16, 21, 30, 40)},
            "least": lambda row: plain(row["least_cameras"]) or "none",
            "seconds": of("seconds", 1, due=DUE["sweep"]),
        },
    )
