"""One pass: newest frames in, a verdict for each motion out. Whatever goes wrong on the way is a stop."""

import time
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field

import numpy as np

from elbowroom.choices import Detail, Rule
from elbowroom.errors import InputError
from elbowroom.geometry import DepthCamera, VoxelGrid
from elbowroom.geometry.margin import Margin
from elbowroom.machine import Machine
from elbowroom.monitor.health.drift.watch import Watch
from elbowroom.monitor.result import CycleResult
from elbowroom.motion import Cause, Level, Motion, Verdict, blocks_in_reach, check_motions
from elbowroom.reconstruct import reconstruct
from elbowroom.sensing import DepthFrame, JointRecord
from elbowroom.sensing.snapshot import young_enough


@dataclass(slots=True, eq=False)
class Cycle:
    """The pass and all that stays the same from one to the next. It remembers nothing but its number; its watch does.

    Args:
        grid: the watched box.
        cameras: all cameras of the room, also those that may deliver nothing.
        machine: what moves.
        motions: what is asked in each pass; at least one.
        rule, detail, margin: as of `reconstruct`.
        max_age_ns: frames older than this are not used [ns]; None: no limit.
        explain_tolerance_m: as of `reconstruct` [m].
        focused: only the space where the motions can go is looked at, all other space stays unseen.
        watch: hears the frames of each pass, and stops every motion once it found a camera or the machine where it
            should not be; None: nobody watches.

    Raises:
        InputError: no motions, since then nothing would ever say stop.
    """

    grid: VoxelGrid
    cameras: Sequence[DepthCamera]
    machine: Machine
    motions: Sequence[Motion]
    rule: Rule = "three"
    detail: Detail = "pixel"
    margin: Margin = field(default_factory=Margin)
    max_age_ns: int | None = None
    explain_tolerance_m: float = 0.01
    focused: bool = True
    watch: Watch | None = None
    sequence: int = field(default=0, init=False)

    def __post_init__(self) -> None:
        self.motions = tuple(self.motions)
        if not self.motions:
            raise InputError("cycle: no motions to check, at least one is needed")

    def run(
        self,
        frames: Sequence[DepthFrame],
        joints: Mapping[str, float],
        now_ns: int,
        joints_at_frames: JointRecord | None = None,
    ) -> CycleResult:
        """Judges all motions by the newest frames.

        It does not raise: a fault of any kind is a stop for every motion, with the reason beside it.

        Args:
            frames: the newest frame of each camera that has one.
            joints: the machine's joint positions now, by name [m or rad]; motions begin there.
            now_ns: the time now [ns, the clock of the frames].
            joints_at_frames: positions over time, asked at each frame's time; None: `joints` held then too.
        """
        sequence, self.sequence = self.sequence, self.sequence + 1
        stage_ms: dict[str, float] = {}
        given: dict[Motion, Verdict] = {}
        space, oldest, fault, health = None, None, None, None
        try:
            oldest = _oldest_age_ms(frames, now_ns)
            if self.watch is not None:
                with _timed("watch", stage_ms):
                    known = joints if joints_at_frames is None else joints_at_frames
                    health = self.watch.hear(young_enough(frames, now_ns, self.max_age_ns), known, now_ns)
            space = reconstruct(
                self.grid,
                self.cameras,
                frames,
                machine=self.machine,
                joints=joints if joints_at_frames is None else joints_at_frames,
                rule=self.rule,
                detail=self.detail,
                margin=self.margin,
                now_ns=now_ns,
                max_age_ns=self.max_age_ns,
                explain_tolerance_m=self.explain_tolerance_m,
                focus=blocks_in_reach(self.grid, self.machine, joints, self.motions)
                if self.focused
                else None,
                timer=lambda stage: _timed(stage, stage_ms),
            )
            with _timed("motion", stage_ms):
                given = _usable(check_motions(space, self.machine, joints, self.motions))
        except Exception as error:  # at this border a fault becomes a decision: stop
            space, given, health = None, {}, None
            fault = f"{type(error).__name__}: {error}"
        missing = [motion.name for motion in self.motions if motion not in given]
        if missing and fault is None:
            fault = f"no usable verdict for {', '.join(missing)}"
        if health is not None and health.reason is not None:
            # free space that comes from a camera that is elsewhere is no free space
            given = {}
        verdicts = tuple(given.get(motion) or self._stop(motion) for motion in self.motions)
        return CycleResult(sequence, now_ns, space, verdicts, stage_ms, oldest, fault, health)

    def _stop(self, motion: Motion) -> Verdict:
        units = {joint.name: joint.unit for joint in self.machine.joints}
        return Verdict(motion, Level.STOP, 0.0, units.get(motion.joint, "m or rad"), None, None, Cause.BLIND)


def _usable(verdicts: Sequence[Verdict]) -> dict[Motion, Verdict]:
    """By motion, the verdicts that say a level and a distance that is a number of at least zero."""
    return {
        verdict.motion: verdict
        for verdict in verdicts
        if isinstance(verdict, Verdict)
        and isinstance(verdict.motion, Motion)
        and isinstance(verdict.level, Level)
        and np.isfinite(verdict.free_travel)
        and verdict.free_travel >= 0
    }


@contextmanager
def _timed(stage: str, stage_ms: dict[str, float]) -> Iterator[None]:
    """Notes how long a stage took, also when it fails."""
    start = time.perf_counter()
    try:
        yield
    finally:
        stage_ms[stage] = (time.perf_counter() - start) * 1e3


def _oldest_age_ms(frames: Sequence[DepthFrame], now_ns: int) -> float | None:
    stamps = [frame.stamp_ns for frame in frames if frame.stamp_ns is not None]
    return (now_ns - min(stamps)) / 1e6 if stamps else None
