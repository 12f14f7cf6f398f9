"""Free space beside the truth and beside other views."""

from collections.abc import Sequence

from elbowroom.evaluate.rooms import room, sevenscenes
from result_tables.cells import Row, centimetres, of, same, table


def room_tables(rows: Sequence[Row]) -> list[str]:
    """Occupied and found, by voxel size, noise and detail."""
    return table(
        rows,
        {
            "voxel": centimetres,
            **same("detail", "rule", "noise"),
            "occupied kept %": of("occupied_pct", 4, due=room.DUE),
            "falsely free voxels": lambda row: (
                f"{row.get('false_free_voxels', 0):,} of {row.get('occupied_voxels', 0):,}"
            ),
            "found %": of("found_pct", 2, due=room.DUE),
            "free %": of("free_pct", 2),
        },
    )


def sevenscenes_tables(rows: Sequence[Row]) -> list[str]:
    """Falsely free check points and free voxels, by rule, detail and margin."""
    return table(
        rows,
        {
            "voxel": centimetres,
            **same("rule", "detail", "margin"),
            "false %": of("false_pct", 3, due=sevenscenes.DUE),
            "free %": of("free_pct", 2, due=sevenscenes.DUE),
        },
    )
