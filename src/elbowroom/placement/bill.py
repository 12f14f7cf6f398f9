"""What a layout costs, camera by camera."""

from collections.abc import Sequence
from typing import Any

from elbowroom.placement.candidates import Candidate


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
