"""From the middle of exposure to the decision: the monitor's whole way, on frames that lie in memory."""

import tempfile
import time
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np

from elbowroom.errors import InputError
from elbowroom.evaluate.due import FULL_ROOM, Due
from elbowroom.evaluate.moments import there_and_back
from elbowroom.geometry import parallel
from elbowroom.monitor import Pass
from elbowroom.monitor.separation.measuring import gate_beside
from elbowroom.monitor.start.start import started
from elbowroom.site import Site
from elbowroom.sources import Room, open_room
from elbowroom.sources.from_memory import FromMemory

MOMENTS = 15
RATE_HZ = 15.0
SPREADS = {"exposed together": 0.0, "running free": 0.95}
"""By case, over which share of a frame period exposures are spread."""


def _is_due(row: Mapping[str, Any]) -> bool:
    whole = all(row.get(key) == value for key, value in FULL_ROOM.items())
    return whole and row["case"] == "exposed together" and row["voxel_size_m"] == 0.05


DUE = (
    Due(
        "p99_ms",
        "≤",
        100.0,
        _is_due,
        "exposure to decision, 21 cameras of 640x480 at 15 Hz, 5 cm, two cores, 99 %",
    ),
)


@dataclass(slots=True, eq=False)
class _Heard:
    """The face that notes when each pass was decided."""

    rows: list[dict[str, Any]] = field(default_factory=list)

    def begin(self, room: Room) -> None:
        """Nothing is to be done."""

    def show(self, done: Pass) -> None:
        """Notes how old the oldest frame is that was used, and where its time went."""
        now_ns = time.perf_counter_ns()
        if done.result.fault is not None:
            raise InputError(f"bench: a pass failed: {done.result.fault}")
        stamps = [frame.stamp_ns for frame in done.snapshot.frames if frame.stamp_ns is not None]
        self.rows.append(
            {
                "ms": (now_ns - min(stamps)) / 1e6,
                "age_ms": done.result.oldest_age_ms,
                "stage_ms": dict(done.result.stage_ms),
                "late": done.result.late is not None,
            }
        )

    def end(self) -> None:
        """Nothing is to be done."""


def decision_rows(
    seconds: float = 30.0, cameras: int = 21, size: tuple[int, int] = (640, 480), threads: int | None = None
) -> Iterator[dict[str, Any]]:
    """The simulated room from memory through the whole monitor, with its watch, its gate and distances.

    Args:
        seconds: how long, of each case.
        cameras, size: of the room.
        threads: over so many the work is spread; None: one a core.

    Yields:
        A row for each case: from the exposure of the oldest frame that was used to the decision (median_ms, p99_ms,
        max_ms), how many passes were past their age (late), and where the time of the worst pass went (worst).

    Raises:
        InputError: a pass failed.
    """
    room = open_room(Site.simulated_room(), cameras=cameras, resolution=size)
    moments = there_and_back(room, MOMENTS, RATE_HZ)
    for case, spread in SPREADS.items():
        # the room is commissioned as it is simulated; then its moments come from memory
        loop = started(room, lambda step: None)
        loop, heard = replace(loop, room=replace(room, source=FromMemory(moments, RATE_HZ, spread))), _Heard()
        with tempfile.TemporaryDirectory() as folder, parallel.threads(threads):
            replace(loop, gate=gate_beside(loop, Path(folder))).run([heard], seconds)
        spent = np.array([row["ms"] for row in heard.rows])
        worst = heard.rows[int(spent.argmax())]
        yield {
            "case": case,
            "cameras": len(room.cameras),
            "width": size[0],
            "height": size[1],
            "voxel_size_m": room.grid.voxel_size_m,
            "rate_hz": RATE_HZ,
            "threads": threads or parallel.default_threads(),
            "seconds": seconds,
            "passes": len(spent),
            "late": sum(row["late"] for row in heard.rows),
            "median_ms": float(np.median(spent)),
            "p99_ms": float(np.percentile(spent, 99)),
            "max_ms": float(spent.max()),
            "worst": {"age_ms": worst["age_ms"], **worst["stage_ms"]},
        }


def words_of_worst(row: Mapping[str, Any]) -> str:
    """Where the time of the worst pass went, its longest parts first: "carve 61, age 12, motion 9"."""
    parts = {name.removesuffix("_ms"): ms for name, ms in row["worst"].items() if ms is not None and ms >= 1}
    longest = sorted(parts.items(), key=lambda part: -part[1])[:4]
    return ", ".join(f"{name} {ms:.0f}" for name, ms in longest)
