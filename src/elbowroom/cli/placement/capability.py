"""The run of `elbowroom placement capability`."""

import math
from pathlib import Path
from typing import Any

import numpy as np

from elbowroom.files.atomic import folder
from elbowroom.files.json_rows import json_rows
from elbowroom.placement.cameras import cameras_of
from elbowroom.placement.charts import capability_section
from elbowroom.placement.detection import Capability, capability, save_capability
from elbowroom.placement.fixed_room import FixedRoom
from elbowroom.placement.pictures import save
from elbowroom.placement.verification import verify
from elbowroom.site import Site

PERCENTS = (50.0, 90.0, 99.0)
SIZES_MM = (14.0, 40.0, 70.0, 150.0)


def run_capability(
    site_path: Path, views: int, voxel_size_m: float | None, out: Path | None, json_file: Path | None
) -> None:
    """Maps detection capability of a site and prints what it says."""
    site = Site.load(site_path)
    cameras, room, grid = cameras_of(site), FixedRoom.of_site(site), site.grid(voxel_size_m)
    with json_rows(json_file) as add:
        result = capability(verify(grid, cameras, room), views)
        row = _row(site, result, len(cameras))
        files = []
        if out is not None:
            out = folder(out)
            at_hip = min(int(1.1 / grid.voxel_size_m), grid.shape[2] - 1)
            for name, normal, layer in (("z", 2, at_hip), ("x", 0, grid.shape[0] // 2)):
                files.append(
                    save(capability_section(result, room, normal, layer), out / f"capability_{name}.png")
                )
            files.append(save_capability(out / "capability.npz", result))
        add(row | {"files": [str(path) for path in files]})
    _say(row)
    for path in files:
        print(f"written   {path}")


def _row(site: Site, result: Capability, cameras: int) -> dict[str, Any]:
    """The row of kind "capability"; sizes in mm, null where objects of no size are seen by so many cameras."""
    worst = np.argwhere((result.smallest_mm == result.smallest_mm[result.asked].max()) & result.asked)[0]
    return {
        "kind": "capability",
        "site": str(site.path),
        "name": site.name,
        "cameras": cameras,
        "views": result.views,
        "voxel_size_m": result.grid.voxel_size_m,
        "smallest_mm": {f"{p:g}_pct": result.percentile_mm(p) for p in PERCENTS},
        "intrusion_mm": {
            f"{p:g}_pct": float(
                np.sort(result.intrusion_mm[result.asked])[int(p / 100 * (result.asked.sum() - 1))]
            )
            for p in PERCENTS
        },
        "share_pct": {f"{size:g}_mm": result.share_pct(size) for size in SIZES_MM},
        "worst_m": result.grid.centre_of(worst),
        "worst_mm": float(result.smallest_mm[tuple(worst)]),
    }


def _say(row: dict[str, Any]) -> None:
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
