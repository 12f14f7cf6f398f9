"""Whether the recorder keeps up with 21 cameras: passes from memory, handed over at their rate."""

import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np

from elbowroom.evaluate.due import Due
from elbowroom.geometry import DepthCamera
from elbowroom.monitor import CycleResult, Pass
from elbowroom.monitor.blackbox.recorder import Recorder
from elbowroom.monitor.blackbox.recording import Recording
from elbowroom.monitor.blackbox.sinks import BlackBox, Sink, WholeRun
from elbowroom.motion import Cause, Level, Verdict
from elbowroom.sensing import DepthFrame, Snapshot
from elbowroom.simulate import InterventionRoom, render
from elbowroom.site import Site
from elbowroom.sources import Room, open_room

DUE = (
    Due("lost", "≤", 0, words="passes lost"),
    Due("core_share", "≤", 0.3, words="share of a core"),
    Due("not_as_given", "≤", 0, words="images read back that are not as they were given"),
)
"""21 cameras of 640x480, 15 images a second."""
RATE_HZ = 15.0
UNIT_M = 0.001
MOMENTS = 6
"""So many moments are rendered; they come again and again."""
LOOKED_AT = 7
"""Every so many passes are compared with what was given."""


@dataclass(frozen=True, slots=True, eq=False)
class Given:
    """What is recorded.

    Args:
        room: of the cameras.
        images: of each moment, those of all cameras [m], whole millimetres.
    """

    room: Room
    images: Sequence[Sequence[np.ndarray[Any, np.dtype[np.float32]]]]

    @classmethod
    def rendered(cls, cameras: int, size: tuple[int, int], noise: str = "tof") -> "Given":
        """The simulated room with people.

        Args:
            cameras: how many.
            size: width and height of their images [px].
            noise: of the sensors.
        """
        from elbowroom.sources.cameras import with_noise

        room = open_room(with_noise(Site.simulated_room(), noise), cameras=cameras, resolution=size)
        simulated = InterventionRoom(machine=room.machine)
        images = []
        for number in range(MOMENTS):
            frames = render(room.cameras, simulated.at(2.0 * number), seed=number)
            images.append([_in_units(frame).depth_m for frame in frames])
        return cls(room, images)

    def snapshot(self, number: int) -> Snapshot:
        """The moment of a pass, with frames of its own.

        Args:
            number: of the pass.
        """
        stamp_ns = round(number * 1e9 / RATE_HZ)
        of = self.images[number % len(self.images)]
        frames = [_frame(c, stamp_ns, image) for c, image in zip(self.room.cameras, of, strict=True)]
        machine = self.room.machine
        joints = {} if machine is None else dict.fromkeys(machine.joint_names, 0.0)
        return Snapshot(tuple(frames), joints, now_ns=stamp_ns)


def rate_rows(
    seconds: float = 60.0, cameras: int = 21, size: tuple[int, int] = (640, 480), place: Path | None = None
) -> Iterator[dict[str, Any]]:
    """A row for a run that is kept as a whole, and one for the black box with a stop on the way.

    Args:
        seconds: how long each is.
        cameras: how many.
        size: width and height of their images [px].
        place: a folder for the files; None: a temporary one.
    """
    given = Given.rendered(cameras, size)
    for case in ("whole run", "black box, a stop on the way"):
        with TemporaryDirectory(dir=place) as folder:
            yield {"case": case, **_row(given, case, seconds, Path(folder))}


def _row(given: Given, case: str, seconds: float, folder: Path) -> dict[str, Any]:
    whole = WholeRun(folder / "run.mcap")
    box = BlackBox(folder, before_ns=round(seconds / 4 * 1e9), after_ns=round(seconds / 6 * 1e9))
    sinks: list[Sink] = [whole] if case == "whole run" else [box]
    recorder, passes = Recorder(sinks), round(seconds * RATE_HZ)
    recorder.begin(given.room)
    begun, worst_s = time.perf_counter(), 0.0
    for number in range(passes):
        done = _pass(given, number, stops=2 * number > passes)
        handed = time.perf_counter()
        recorder.show(done)
        worst_s = max(worst_s, time.perf_counter() - handed)
        time.sleep(max(0.0, begun + (number + 1) / RATE_HZ - time.perf_counter()))
    took_s = time.perf_counter() - begun
    recorder.end()
    (file,) = folder.glob("*.mcap")
    first = given.snapshot(0)
    raw_mb = sum(frame.depth_m.size * 2 for frame in first.frames) / 1e6
    kept, other = _compared(file, given)
    return {
        "cameras": len(given.room.cameras),
        "width": given.room.cameras[0].width,
        "height": given.room.cameras[0].height,
        "seconds": took_s,
        "passes": passes,
        "rate_hz": passes / took_s,
        "lost": recorder.lost,
        "troubles": recorder.troubles,
        "core_share": recorder.busy_ns / 1e9 / took_s,
        "raw_mb_s": raw_mb * passes / took_s,
        "file_mb_s": file.stat().st_size / 1e6 / (kept / RATE_HZ),
        "times_smaller": raw_mb * kept / (file.stat().st_size / 1e6),
        "handed_over_ms": 1e3 * worst_s,
        "passes_in_file": kept,
        "not_as_given": other,
    }


def _compared(file: Path, given: Given) -> tuple[int, int]:
    """How many passes a file holds, and how many images of some are not as they were given."""
    other = 0
    with Recording(file) as recording:
        for number in range(0, len(recording), LOOKED_AT):
            one = recording.at(number)
            due = given.snapshot(one.sequence)
            pairs = zip(one.snapshot.frames, due.frames, strict=True)
            other += sum(found.depth_m.tobytes() != frame.depth_m.tobytes() for found, frame in pairs)
        return len(recording), other + (recording.wrong() is not None)


def _pass(given: Given, number: int, stops: bool) -> Pass:
    snapshot = given.snapshot(number)
    _, motions = given.room.machine_and_motions()
    level, cause = (Level.STOP, Cause.SURFACE) if stops else (Level.CLEAR, Cause.NONE)
    verdicts = tuple(Verdict(motion, level, 0.1, "m", None, None, cause) for motion in motions)
    result = CycleResult(number, snapshot.now_ns or 0, None, verdicts, {}, 0.0)
    return Pass(snapshot, result, 0.0)


def _in_units(frame: DepthFrame) -> DepthFrame:
    """In whole millimetres, as sensors give it."""
    with np.errstate(invalid="ignore"):
        raw = np.where(np.isfinite(frame.depth_m), np.floor(frame.depth_m / UNIT_M), 0).astype(np.uint16)
    return DepthFrame.from_raw(frame.camera, frame.stamp_ns, raw, scale_m=UNIT_M)


def _frame(camera: DepthCamera, stamp_ns: int, image: np.ndarray[Any, np.dtype[np.float32]]) -> DepthFrame:
    return DepthFrame(camera.name, stamp_ns, image)
