"""Free space beside the truth and beside other views."""

from collections.abc import Sequence

from result_tables.cells import Row, centimetres, is_full_room, of, same, table


def _due_occupied(row: Row) -> tuple[str, float] | None:
    if row.get("rule") != "three" or not is_full_room(row):
        return None
    if row.get("noise"):
        return ("≥", 99.99) if (row.get("detail"), row.get("voxel_size_m")) == ("pixel", 0.02) else None
    return {"footprint": ("≥", 100.0), "pixel": ("≥", 99.99)}.get(str(row.get("detail")))


def _due_found(row: Row) -> tuple[str, float] | None:
    if row.get("rule") != "three" or row.get("detail") != "pixel" or not is_full_room(row):
        return None
    figures = {(0.02, False): 97.0, (0.05, False): 94.0, (0.02, True): 92.0}
    figure = figures.get((row.get("voxel_size_m", 0.0), bool(row.get("noise"))))
    return None if figure is None else ("≥", figure)


def room_tables(rows: Sequence[Row]) -> list[str]:
    """Occupied and found, by voxel size, noise and detail."""
    return table(
        rows,
        {
            "voxel": centimetres,
            **same("detail", "rule", "noise"),
            "occupied kept %": of("occupied_pct", 4, due=_due_occupied),
            "falsely free voxels": lambda row: (
                f"{row.get('false_free_voxels', 0):,} of {row.get('occupied_voxels', 0):,}"
            ),
            "found %": of("found_pct", 2, due=_due_found),
            "free %": of("free_pct", 2),
        },
    )


def _due_free(row: Row) -> tuple[str, float] | None:
    figures = {"three": 10.0, "majority": 10.0, "veto": 16.0, "any": 20.0}
    return (
        ("≥", figures[row["rule"]])
        if row.get("voxel_size_m") == 0.05 and row.get("rule") in figures
        else None
    )


def sevenscenes_tables(rows: Sequence[Row]) -> list[str]:
    """Falsely free check points and free voxels, by rule, detail and margin."""
    return table(
        rows,
        {
            "voxel": centimetres,
            **same("rule", "detail", "margin"),
            "false %": of("false_pct", 3, due=lambda row: ("≤", 0.30) if _due_free(row) else None),
            "free %": of("free_pct", 2, due=_due_free),
        },
    )
