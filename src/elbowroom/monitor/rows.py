"""What a run comes to as rows of a file; `Rows` is the face that writes them."""

from collections.abc import Mapping
from dataclasses import asdict
from typing import Any

import numpy as np

from elbowroom.files.json_rows import AddRow
from elbowroom.geometry.parallel import thread_count
from elbowroom.monitor.face import Pass
from elbowroom.monitor.gate.told import GateRows
from elbowroom.monitor.health.drift.watch import BODY
from elbowroom.monitor.health.health import CameraHealth, LinkHealth
from elbowroom.monitor.health.streams.told import SickRows, sick_row
from elbowroom.monitor.result import CycleResult
from elbowroom.reconstruct.free_space import FreeSpace
from elbowroom.sources import Played, Room, Source
from elbowroom.sources.times.clock import ClockEstimate

CLOCKS_EVERY_NS = 1_000_000_000
"""What is known of clocks is told so often [ns]."""


class Rows:
    """The face that adds to a file: the room, of each pass what was judged, and what is news of cameras and machine.

    Args:
        add: takes a row.
    """

    def __init__(self, add: AddRow) -> None:
        self._add = add
        self._told: dict[str, str] = {}
        self._source: Source | None = None
        self._clocks_ns: int | None = None
        self._gate, self._sick = GateRows(), SickRows()

    def begin(self, room: Room) -> None:
        """Adds the row of the room."""
        self._source = room.source
        self._add(room_row(room))

    def show(self, done: Pass) -> None:
        """Adds the rows of a pass."""
        for row in cycle_rows(done.result, done.source_ms):
            if row["kind"] == "cycle" and done.margins is not None:
                row["separation"] = done.margins.row()
            self._add(row)
        for row in (*health_rows(done.result, self._told), *self._gate.rows(done.result, done.decision)):
            self._add(row)
        for row in self._sick.rows(done.result.sick):
            self._add({**row, "sequence": done.result.sequence, "time_s": done.result.stamp_ns / 1e9})
        if isinstance(self._source, Played) and self._is_time(done.result.stamp_ns):
            for row in clock_rows(done.result, self._source.clocks):
                self._add(row)

    def _is_time(self, now_ns: int) -> bool:
        """Whether a second has gone by since clocks were told last."""
        due = self._clocks_ns is None or not 0 <= now_ns - self._clocks_ns < CLOCKS_EVERY_NS
        if due:
            self._clocks_ns = now_ns
        return due

    def end(self) -> None:
        """Whoever made the file closes it."""


def room_row(room: Room) -> dict[str, Any]:
    """What is watched: the row of kind "room", before all others."""
    return {
        "kind": "room",
        "site": room.site.name,
        "voxel_size_m": room.grid.voxel_size_m,
        "shape": room.grid.shape,
        "cameras": len(room.cameras),
        "width": max(camera.width for camera in room.cameras),
        "height": max(camera.height for camera in room.cameras),
        "rule": room.terms.rule,
        "detail": room.terms.detail,
        "threads": thread_count(),
        "unchecked_links": room.machine.unchecked_links if room.machine else (),
        "allowances": room.allowances,
        "bodiless_links": room.machine.bodiless_links if room.machine else (),
    }


def cycle_rows(result: CycleResult, source_ms: float) -> list[dict[str, Any]]:
    """A pass: one row of kind "cycle" and one of kind "verdict" per motion, joined by `sequence`."""
    shared = {"sequence": result.sequence, "time_s": result.stamp_ns / 1e9}
    cycle = {
        "kind": "cycle",
        **shared,
        "level": result.level.name.lower(),
        "safe_speed": result.safe_speed,
        "stopping": None if result.stopping is None else result.stopping.row(),
        "cycle_ms": result.cycle_ms,
        "stage_ms": dict(result.stage_ms),
        "source_ms": source_ms,
        "oldest_age_ms": result.oldest_age_ms,
        "age_ms": result.age_ms,
        "skew_ms": result.skew_ms,
        "late": result.late,
        "fault": result.fault,
        "stopped_by": result.stopped_by,
        "findings": [asdict(finding) for finding in result.findings],
        "sick": [sick_row(each) for each in result.sick],
    }
    if result.path is not None:
        cycle["path"] = result.path.row()
    if result.off_path is not None:
        cycle["off_path"] = result.off_path
    if not result.verdicts and result.space is not None:
        cycle |= shares_pct(result.space)
    return [cycle, *({"kind": "verdict", **shared, **verdict.row()} for verdict in result.verdicts)]


def health_rows(result: CycleResult, told: dict[str, str]) -> list[dict[str, Any]]:
    """A row of kind "health" per camera and link whose condition is another than it was, or that newly stops.

    Args:
        result: of a pass.
        told: what the last rows said, by camera and link; changed.
    """
    if result.health is None:
        return []
    rows = []
    shared = {"kind": "health", "sequence": result.sequence, "time_s": result.stamp_ns / 1e9}
    stops = result.health.stops
    for camera in result.health.cameras:
        stop = stops.get(camera.camera)
        if _is_news(told, camera.camera, f"{camera.condition.name} {stop}"):
            rows.append({**shared, **_camera_row(camera), "stop": stop})
    for link in result.health.links:
        stop = stops.get(BODY)
        if _is_news(told, f"link {link.link}", f"{link.is_off} {stop}"):
            rows.append({**shared, **_link_row(link), "stop": stop})
    return rows


def clock_rows(result: CycleResult, clocks: Mapping[str, ClockEstimate]) -> list[dict[str, Any]]:
    """A row of kind "clock" per camera: its clock beside that of the monitor.

    Args:
        result: of a pass.
        clocks: what is known of them, by camera.
    """
    shared = {"kind": "clock", "sequence": result.sequence, "time_s": result.stamp_ns / 1e9}
    return [{**shared, "camera": name, **estimate.row} for name, estimate in clocks.items()]


def _is_news(told: dict[str, str], of: str, words: str) -> bool:
    """Whether something else was told last; notes that it is told now."""
    before, told[of] = told.get(of), words
    return before != words


def _camera_row(camera: CameraHealth) -> dict[str, Any]:
    shift = camera.shift
    return {
        "camera": camera.camera,
        "condition": camera.condition.name.lower(),
        "seen_pct": 100 * camera.share_seen,
        "hidden_pct": 100 * camera.share_hidden,
        "turn_deg": None if shift is None else shift.turn_deg,
        "turn_sigma_deg": None if shift is None else shift.turn_sigma_deg,
        "move_mm": None if shift is None else shift.move_mm,
        "move_sigma_mm": None if shift is None else shift.move_sigma_mm,
    }


def _link_row(link: LinkHealth) -> dict[str, Any]:
    return {
        "link": link.link,
        "is_off": link.is_off,
        "off_mm": 1e3 * link.off_m,
        "cameras": list(link.cameras),
    }


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
