"""Layouts of cameras."""

from collections.abc import Sequence

from elbowroom.evaluate.placement.rows import DUE
from result_tables.cells import Cell, Row, centimetres, of, plain, table


def placement_tables(rows: Sequence[Row]) -> list[str]:
    """Time of verification and sweep, optimised layouts, prediction beside what is found."""
    kinds = {kind: [row for row in rows if row["kind"] == kind] for kind in {row["kind"] for row in rows}}
    lines = table(
        [*kinds.get("verify", []), *kinds.get("sweep", [])],
        {
            "what": lambda row: (
                f"{row['cameras']} cameras, {row['points']:,} points"
                if row["kind"] == "verify"
                else f"{row['layouts']} layouts at {centimetres(row)}"
            ),
            "seconds": lambda row: (
                of("median_s", 2, due=DUE["verify"])(row)
                if row["kind"] == "verify"
                else of("seconds", 1, due=DUE["sweep"])(row)
            ),
        },
    )
    lines += [
        "",
        *table(
            kinds.get("optimise", []),
            {
                "optimised for": of("what"),
                "cameras": of("cameras", due=DUE["optimise"]),
                "valid, verified [%]": of("valid_pct", 2, due=DUE["optimise"]),
                "bound": of("bound"),
                "candidates": of("candidates"),
                "points": of("points"),
                "19 or fewer after [s]": of("seconds_to_19", 0, due=DUE["optimise"]),
                "seconds": of("seconds", 0),
            },
        ),
    ]
    lines += [
        "",
        *table(
            kinds.get("prediction", []),
            {
                "room": of("room"),
                "images": of("size"),
                "voxel": centimetres,
                "scenes": of("scenes"),
                "predicted [%]": lambda row: (
                    f"{row['predicted_free_pct']:.2f} ± {row['predicted_error_pct']:.2f}"
                ),
                "found [%]": of("found_free_pct", 2),
                "apart at most [points]": lambda row: of("difference_pct", 2, due=DUE["prediction"])(
                    {"difference_pct": abs(row["difference_pct"])}
                ),
            },
        ),
    ]
    return lines


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
