"""The whole monitor for long: at full rate from memory, with its watch, gate, distances, recording and black box."""

import tempfile
import time
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np

from elbowroom.errors import InputError
from elbowroom.evaluate.due import FULL_ROOM, Due, where
from elbowroom.evaluate.held_memory import Watched
from elbowroom.evaluate.moments import there_and_back
from elbowroom.evaluate.recording.turns import InTurns
from elbowroom.files.progress import Progress, silent
from elbowroom.geometry import parallel
from elbowroom.monitor import Loop, Pass
from elbowroom.monitor.blackbox.recorder import Recorder
from elbowroom.monitor.blackbox.sinks import BlackBox
from elbowroom.monitor.separation.measuring import gate_beside
from elbowroom.monitor.start.start import started
from elbowroom.site import Site
from elbowroom.sources import Room, open_room
from elbowroom.sources.from_memory import FromMemory

MOMENTS, RATE_HZ = 15, 15.0
TURN_S, TOLD_S = 30.0, 15.0
BEFORE_S, AFTER_S = 60.0, 10.0
"""Of a stop, the black box keeps so much [s]."""
BOX_BYTES = 1_000_000_000
"""Memory of the black box: so little that it is full whatever the rate of passes, or what it holds would go up and down
with that [bytes]."""
DUE = (
    Due("grows", "≤", 0, words="memory that grows: the interval of its slope above zero"),
    Due("lost", "≤", 0, words="passes not recorded"),
    Due("p99_ms", "≤", 100.0, where(**FULL_ROOM), "exposure to decision, 99 %"),
)


@dataclass(slots=True, eq=False)
class Heard:
    """The face that notes each pass in memory that is there before, and the worst one as a whole.

    Args:
        seconds: how long the run may be.
        recorder: of the run.
        tell: told how far it is.
    """

    seconds: float
    recorder: Recorder
    tell: Progress = silent
    late: int = field(default=0, init=False)
    passes: int = field(default=0, init=False)
    worst: dict[str, Any] = field(default_factory=dict, init=False)
    watched: Watched = field(init=False)
    _spent_ms: np.ndarray = field(init=False)
    _begun_s: float = field(default=0.0, init=False)
    _told_s: float = field(default=0.0, init=False)

    def __post_init__(self) -> None:
        self.watched = Watched(self.seconds)
        self._spent_ms = np.full(int(2 * RATE_HZ * (self.seconds + 60)), np.nan, np.float32)

    @property
    def spent_ms(self) -> np.ndarray:
        """From exposure to decision, of each pass."""
        return self._spent_ms[: self.passes]

    def begin(self, room: Room) -> None:
        """The run begins."""
        self._begun_s = time.perf_counter()

    def show(self, done: Pass) -> None:
        """Notes a pass.

        Raises:
            InputError: it failed.
        """
        now_ns = time.perf_counter_ns()
        if done.result.fault is not None:
            raise InputError(f"soak: a pass failed: {done.result.fault}")
        stamps = [frame.stamp_ns for frame in done.snapshot.frames if frame.stamp_ns is not None]
        spent_ms, spent_s = (now_ns - min(stamps)) / 1e6, now_ns / 1e9 - self._begun_s
        if not self.passes or spent_ms > self._spent_ms[: self.passes].max():
            self.worst = {"at_s": spent_s, "age_ms": done.result.oldest_age_ms, **done.result.stage_ms}
        self._spent_ms[self.passes] = spent_ms
        self.passes += 1
        self.late += done.result.late is not None
        self.watched.look(spent_s)
        if spent_s - self._told_s >= TOLD_S:
            self._told_s, held = spent_s, self.watched.newest_mb
            self.tell(
                f"{spent_s:.0f} of {self.seconds:.0f} s, worst {np.nanmax(self.spent_ms):.0f} ms, "
                f"{self.recorder.lost} lost" + ("" if held is None else f", {held:.0f} MB held")
            )

    def end(self) -> None:
        """Nothing is to be done."""


def soak_rows(
    seconds: float = 1800.0, cameras: int = 21, size: tuple[int, int] = (640, 480), tell: Progress = silent
) -> Iterator[dict[str, Any]]:
    """A row of one long run.

    Args:
        seconds: how long.
        cameras, size: of the simulated room.
        tell: told what is being done.

    Raises:
        InputError: a pass failed.
    """
    room = open_room(Site.simulated_room(), cameras=cameras, resolution=size)
    tell("rendering what the cameras see")
    moments = there_and_back(room, MOMENTS, RATE_HZ)
    loop = started(room, tell)
    loop = replace(loop, room=replace(room, source=FromMemory(moments, RATE_HZ)))
    with tempfile.TemporaryDirectory() as folder:
        yield _row(loop, Path(folder), seconds, tell)


def _row(loop: Loop, folder: Path, seconds: float, tell: Progress) -> dict[str, Any]:
    whole = InTurns(folder, round(TURN_S * 1e9), Path.unlink)
    box = BlackBox(folder, round(BEFORE_S * 1e9), round(AFTER_S * 1e9), BOX_BYTES)
    recorder = Recorder([whole, box], cycle=loop.cycle)
    loop = replace(
        loop,
        gate=gate_beside(loop, folder),
        checks=replace(loop.checks, looks=(*loop.checks.looks, recorder)),
    )
    heard = Heard(seconds, recorder, tell)
    loop.run([heard, recorder], seconds)
    spent, camera = heard.spent_ms, loop.room.cameras[0]
    return {
        "cameras": len(loop.room.cameras),
        "width": camera.width,
        "height": camera.height,
        "voxel_size_m": loop.room.grid.voxel_size_m,
        "threads": parallel.default_threads(),
        "seconds": seconds,
        "passes": heard.passes,
        "rate_hz": heard.passes / seconds,
        "late": heard.late,
        "median_ms": float(np.median(spent)),
        "p99_ms": float(np.percentile(spent, 99)),
        "max_ms": float(spent.max()),
        "worst": heard.worst,
        "lost": recorder.lost,
        "troubles": recorder.troubles,
        "recorder_core_share": recorder.busy_ns / 1e9 / seconds,
        "file_mb_s": whole.bytes / 1e6 / seconds,
        "stops_kept": len(box.said),
        **heard.watched.row(),
    }


def words_of_worst(row: Mapping[str, Any]) -> str:
    """When the worst pass was and where its time went, its longest parts first: "at 812 s: carve 61, age 12"."""
    parts = {
        name.removesuffix("_ms"): ms for name, ms in row["worst"].items() if name != "at_s" and (ms or 0) >= 1
    }
    longest = sorted(parts.items(), key=lambda part: -part[1])[:4]
    return f"at {row['worst']['at_s']:.0f} s: " + ", ".join(f"{name} {ms:.0f}" for name, ms in longest)
