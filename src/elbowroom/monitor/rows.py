"""Results as rows of the files that `--json` writes."""

from typing import Any

import numpy as np

from elbowroom.monitor import CycleResult
from elbowroom.monitor.health.drift.watch import BODY
from elbowroom.reconstruct.free_space import FreeSpace


def cycle_rows(result: CycleResult, source_ms: float) -> list[dict[str, Any]]:
    """A pass: one row of kind "cycle" and one of kind "verdict" per motion, joined by `sequence`."""
    shared = {"sequence": result.sequence, "time_s": result.stamp_ns / 1e9}
    cycle = {
        "kind": "cycle",
        **shared,
        "level": result.level.name.lower(),
        "cycle_ms": result.cycle_ms,
        "stage_ms": dict(result.stage_ms),
        "source_ms": source_ms,
        "oldest_age_ms": result.oldest_age_ms,
        "fault": result.fault,
        "stopped_by": result.stopped_by,
    }
    return [cycle, *({"kind": "verdict", **shared, **verdict.row()} for verdict in result.verdicts)]


def health_rows(result: CycleResult, said: dict[str, str]) -> list[dict[str, Any]]:
    """A row of kind "health" per camera and link whose condition is another than it was, or that newly stops.

    Args:
        result: of a pass.
        said: what the last rows said, by camera and link; changed.
    """
    if result.health is None:
        return []
    rows = []
    shared = {"kind": "health", "sequence": result.sequence, "time_s": result.stamp_ns / 1e9}
    stops = result.health.stops
    for camera in result.health.cameras:
        stop = stops.get(camera.camera)
        if said.get(camera.camera) != f"{camera.condition.name} {stop}":
            said[camera.camera] = f"{camera.condition.name} {stop}"
            shift = camera.shift
            rows.append(
                {
                    **shared,
                    "camera": camera.camera,
                    "condition": camera.condition.name.lower(),
                    "stop": stop,
                    "seen_pct": 100 * camera.share_seen,
                    "hidden_pct": 100 * camera.share_hidden,
                    "turn_deg": None if shift is None else shift.turn_deg,
                    "turn_sigma_deg": None if shift is None else shift.turn_sigma_deg,
                    "move_mm": None if shift is None else shift.move_mm,
                    "move_sigma_mm": None if shift is None else shift.move_sigma_mm,
                }
            )
    for link in result.health.links:
        stop = stops.get(BODY)
        if said.get(f"link {link.link}") != f"{link.is_off} {stop}":
            said[f"link {link.link}"] = f"{link.is_off} {stop}"
            rows.append(
                {
                    **shared,
                    "link": link.link,
                    "is_off": link.is_off,
                    "off_mm": 1e3 * link.off_m,
                    "cameras": list(link.cameras),
                    "stop": stop,
                }
            )
    return rows


def shares_pct(space: FreeSpace) -> dict[str, float]:
    """Shares of all voxels of the grid: free, surface, unseen [%]; blind is a part of surface and unseen."""
    planes = {
        "free_pct": space.free_words,
        "surface_pct": space.surface_words,
        "unseen_pct": space.blocked_words & ~space.surface_words,
        "blind_pct": space.blind_words,
        "body_pct": space.body_words,
    }
    return {
        name: 100 * int(np.unpackbits(words.view(np.uint8)).sum(dtype=np.int64)) / space.grid.size
        for name, words in planes.items()
    }
