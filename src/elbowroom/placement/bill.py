"""What a layout costs, camera by camera."""

from collections.abc import Sequence
from typing import Any

from elbowroom.placement.candidates import Candidate
from elbowroom.view.report.blocks import Table


def bill(bought: Sequence[Candidate]) -> list[dict[str, Any]]:
    """A row for each camera and one for all: sensor, mount and cable, in whatever money the site counts in.

    Args:
        bought: cameras that have to be bought.
    """
    rows: list[dict[str, Any]] = [
        {
            "kind": "item",
            "camera": item.camera.name,
            "mount": item.mount.name,
            "position_m": item.mount.position_m,
            "looks_along": item.camera.world_from_camera[:3, 2],
            "sensor": item.sensor.name,
            "sensor_price": item.sensor.price,
            "mount_price": item.mount.price,
            "cable_m": item.mount.cable_m,
            "cable_price": item.cable_price,
            "price": item.price,
        }
        for item in bought
    ]
    keys = ("sensor_price", "mount_price", "cable_m", "cable_price", "price")
    rows.append(
        {"kind": "total", "cameras": len(bought), **{key: sum(row[key] for row in rows) for key in keys}}
    )
    return rows


def bill_table(rows: Sequence[dict[str, Any]]) -> Table:
    """The bill for people.

    Args:
        rows: as `bill` makes them.
    """
    lines = []
    for row in rows:
        total = row["kind"] == "total"
        lines.append(
            (
                "all" if total else row["camera"],
                "" if total else ", ".join(f"{v + 0.0:.2f}" for v in row["position_m"]),
                "" if total else row["sensor"],
                f"{row['sensor_price']:g}",
                f"{row['mount_price']:g}",
                f"{row['cable_m']:.1f} m {row['cable_price']:.2f}",
                f"{row['price']:.2f}",
            )
        )
    columns = ("camera", "x, y, z in m", "kind", "sensor", "mount", "cable", "price")
    return Table("", columns, lines, left=(0, 1, 2))
