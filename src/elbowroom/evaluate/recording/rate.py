"""Whether the recorder keeps up with 21 cameras: passes from memory, handed over at their rate."""

import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np

from elbowroom.evaluate.due import Due
from elbowroom.evaluate.held_memory import Watched
from elbowroom.evaluate.moments import in_units
from elbowroom.evaluate.recording.compared import Comparing, sum_of
from elbowroom.evaluate.recording.turns import InTurns
from elbowroom.files.progress import Progress, silent
from elbowroom.geometry import DepthCamera
from elbowroom.monitor import CycleResult, Pass
from elbowroom.monitor.blackbox.recorder import Recorder
from elbowroom.monitor.blackbox.sinks import BlackBox, Sink
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
MOMENTS = 6
"""So many moments are rendered; they come again and again."""
WHOLE, BOX = "whole run", "black box, a stop on the way"
BOX_S = 180.0
"""The black box writes each of its stops as the whole run writes all; longer says nothing more [s]."""
TURN_S = 30.0
"""So much of a whole run is one file [s]."""
TOLD_S = 15.0
"""So often it is told how far it is [s]."""


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
            images.append([in_units(frame).depth_m for frame in frames])
        return cls(room, images)

    @property
    def sums(self) -> list[list[bytes]]:
        """Of each moment, those of the images of all cameras."""
        return [[sum_of(image) for image in moment] for moment in self.images]

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
    seconds: float = 60.0,
    cameras: int = 21,
    size: tuple[int, int] = (640, 480),
    place: Path | None = None,
    tell: Progress = silent,
) -> Iterator[dict[str, Any]]:
    """A row for a run that is kept as a whole, and one for the black box with a stop on the way.

    Args:
        seconds: how long each is; the black box at most `BOX_S`.
        cameras: how many.
        size: width and height of their images [px].
        place: a folder for the files; None: a temporary one.
        tell: told how far it is.
    """
    tell("rendering what the cameras see")
    given = Given.rendered(cameras, size)
    for case, length in ((WHOLE, seconds), (BOX, min(seconds, BOX_S))):
        with TemporaryDirectory(dir=place) as folder:
            yield {"case": case, **_row(given, case, length, (Path(folder), tell))}


def _row(given: Given, case: str, seconds: float, beside: tuple[Path, Progress]) -> dict[str, Any]:
    folder, tell = beside
    with Comparing(given.sums) as comparing:
        whole = InTurns(folder, round(TURN_S * 1e9), comparing.take)
        box = BlackBox(folder, before_ns=round(seconds / 4 * 1e9), after_ns=round(seconds / 6 * 1e9))
        sinks: list[Sink] = [whole] if case == WHOLE else [box]
        recorder = Recorder(sinks)
        recorder.begin(given.room)
        run = _handed_over(given, recorder, seconds, lambda text: tell(f"{case}: {text}"))
        recorder.end()
        if case == BOX:
            comparing.take(*folder.glob("*.mcap"))
        tell(f"{case}: looking at what was written")
        kept, other, size = comparing.found()
    raw_mb = len(given.room.cameras) * given.images[0][0].size * 2 / 1e6
    return {
        "cameras": len(given.room.cameras),
        "width": given.room.cameras[0].width,
        "height": given.room.cameras[0].height,
        **run,
        "lost": recorder.lost,
        "troubles": recorder.troubles,
        "core_share": recorder.busy_ns / 1e9 / run["seconds"],
        "raw_mb_s": raw_mb * run["passes"] / run["seconds"],
        "raw_mb_s_of_a_core": raw_mb * run["passes"] / max(recorder.busy_ns / 1e9, 1e-9),
        "file_mb_s": size / 1e6 / (kept / RATE_HZ),
        "times_smaller": raw_mb * kept / (size / 1e6),
        "passes_in_file": kept,
        "not_as_given": other,
    }


def _handed_over(given: Given, recorder: Recorder, seconds: float, tell: Progress) -> dict[str, Any]:
    """Hands passes over at their rate."""
    passes, watched, told_s = round(seconds * RATE_HZ), Watched(seconds), 0.0
    begun, worst_s = time.perf_counter(), 0.0
    for number in range(passes):
        done = _pass(given, number, stops=2 * number > passes)
        handed = time.perf_counter()
        recorder.show(done)
        worst_s = max(worst_s, time.perf_counter() - handed)
        spent_s = time.perf_counter() - begun
        watched.look(spent_s)
        if spent_s - told_s >= TOLD_S:
            told_s, share = spent_s, recorder.busy_ns / 1e9 / spent_s
            tell(f"{spent_s:.0f} of {seconds:.0f} s, {share:.2f} of a core, {recorder.lost} lost")
        time.sleep(max(0.0, begun + (number + 1) / RATE_HZ - time.perf_counter()))
    took_s = time.perf_counter() - begun
    return {
        "seconds": took_s,
        "passes": passes,
        "rate_hz": passes / took_s,
        "handed_over_ms": 1e3 * worst_s,
        **watched.row(),
    }


def _pass(given: Given, number: int, stops: bool) -> Pass:
    snapshot = given.snapshot(number)
    _, motions = given.room.machine_and_motions()
    level, cause = (Level.STOP, Cause.SURFACE) if stops else (Level.CLEAR, Cause.NONE)
    verdicts = tuple(Verdict(motion, level, 0.1, "m", None, None, cause) for motion in motions)
    result = CycleResult(number, snapshot.now_ns or 0, None, verdicts, {}, 0.0)
    return Pass(snapshot, result, 0.0)


def _frame(camera: DepthCamera, stamp_ns: int, image: np.ndarray[Any, np.dtype[np.float32]]) -> DepthFrame:
    return DepthFrame(camera.name, stamp_ns, image)
