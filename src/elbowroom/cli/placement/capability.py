"""The run of `elbowroom placement capability`."""

import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from elbowroom.cli.placement.options import CapabilityOptions
from elbowroom.cli.placement.room import room_of
from elbowroom.files.atomic import folder
from elbowroom.files.json_rows import json_rows
from elbowroom.placement.charts import capability_section
from elbowroom.placement.detection import Capability, capability, save_capability
from elbowroom.placement.fixed_room import FixedRoom
from elbowroom.placement.pictures import save
from elbowroom.placement.verification import verify
from elbowroom.site import Site
from elbowroom.sources import cameras_of

HIP_M = 1.1
"""Height of the horizontal section above the box's floor [m]."""


def run_capability(options: CapabilityOptions, json_file: Path | None) -> None:
    """Maps detection capability of a site and prints what it says.

    Raises:
        InputError: a site, a number of views or a folder that cannot be.
    """
    site = Site.load(options.site)
    cameras, room, grid = cameras_of(site), room_of(site), site.grid(options.voxel_size_m)
    with json_rows(json_file) as add:
        result = capability(verify(grid, cameras, room), options.views)
        row = result.row() | {"site": str(site.path), "name": site.name, "cameras": len(cameras)}
        files = [] if options.out is None else _save(result, room, folder(options.out))
        add(row | {"files": [str(path) for path in files]})
    _say(row)
    for path in files:
        print(f"written   {path}")


def _save(result: Capability, room: FixedRoom | None, out: Path) -> list[Path]:
    """Sections at the height of hips and through the middle, and the arrays."""
    grid = result.grid
    at_hip = min(int(HIP_M / grid.voxel_size_m), grid.shape[2] - 1)
    files = [
        save(capability_section(result, room, normal, layer), out / f"capability_{name}.png")
        for name, normal, layer in (("z", 2, at_hip), ("x", 0, grid.shape[0] // 2))
    ]
    return [*files, save_capability(out / "capability.npz", result)]


def _say(row: Mapping[str, Any]) -> None:
    who = f"{row['views']} of {row['cameras']} cameras see{'s' * (row['views'] == 1)}"
    print(f"smallest  object that {who}, voxels of {row['voxel_size_m'] * 100:g} cm:")
    for percent, size in row["smallest_mm"].items():
        intrusion = _mm(row["intrusion_mm"][percent], "not defined beyond 70 mm")
        at = percent.removesuffix("_pct")
        print(f"          at {at} % of the places {_mm(size, 'none')}; ISO 13855 C {intrusion}")
    for size, share in row["share_pct"].items():
        print(f"share     {share:.1f} % of the places see {size.removesuffix('_mm')} mm")
    x, y, z = row["worst_m"]
    print(f"worst     {_mm(row['worst_mm'], 'none')} at x {x:.2f}, y {y:.2f}, z {z:.2f}")
    print(
        "note      check formulas in the standard; see docs/safety.md. This is no certified safety function."
    )


def _mm(size: float, otherwise: str) -> str:
    return f"{size:.0f} mm" if math.isfinite(size) else otherwise
