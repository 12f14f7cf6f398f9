"""The look at times: whether stamps of frames go on as a camera's do, and with the clock."""

import time
from collections import deque
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from elbowroom.finding import Finding
from elbowroom.sensing import DepthFrame, Snapshot
from elbowroom.sources.times.series import length_text

AHEAD_NS = 100_000_000
"""A frame farther ahead of the clock than this has no age that could be judged [ns]."""
SKEW_STEPS = 5
SKEW_NS = 500_000_000
"""Frames of one moment lie no farther apart than so many usual steps of the slowest camera, or than this [ns]."""
UNKNOWN_STEP_NS = 1_000_000_000
"""Where no camera has given two frames yet, they lie no farther apart than this [ns]."""
RATE_AFTER_NS = 1_000_000_000
"""After so long it is known how fast stamps go [ns]."""
JUMP_NS = 100_000_000
"""The clock jumped if it went ahead by so much more than any snapshot could have waited [ns],"""
JUMP_STEPS, LEAST_STEPS = 3, 3
"""and by more than so many usual steps; of a source that runs faster than this computer's clock all steps are large."""
JUMP_LASTS_NS = 1_000_000_000
"""For so long after a jump no age is trusted [ns]."""
TOO_SLOW, TOO_FAST = 0.02, 50.0
"""Stamps that go so much slower or faster than the clock of this computer are in another unit."""
REMEMBERED = 15


@dataclass(slots=True, eq=False)
class _Heard:
    """What a camera gave last, and how its stamps went."""

    stamp_ns: int
    depth_m: NDArray[np.float32]
    greatest_ns: int
    steps_ns: deque[int] = field(default_factory=lambda: deque(maxlen=REMEMBERED))

    @property
    def usual_step_ns(self) -> int:
        """The median of the latest steps [ns]; there is one."""
        return sorted(self.steps_ns)[len(self.steps_ns) // 2]


@dataclass(slots=True, eq=False)
class Clocks:
    """Looks at the stamps of each snapshot (`Look`). What it finds holds as long as it lasts.

    Args:
        max_age_ns: frames older than this are left out of the pass, and so of what is compared [ns]; None: none are.
        recorded: whether frames come from a recording, whose layout has looked at skews, and which may be slow.
        gap_ns: nothing for longer than this is a gap, in a recording [ns].
        clock_ns: of this computer; it never goes back [ns].
    """

    max_age_ns: int | None = None
    recorded: bool = False
    gap_ns: int = 5_000_000_000
    clock_ns: Callable[[], int] = time.perf_counter_ns
    _heard: dict[str, _Heard] = field(default_factory=dict, init=False)
    _now_ns: int | None = field(default=None, init=False)
    _greatest_now_ns: int | None = field(default=None, init=False)
    _first: tuple[int, int] | None = field(default=None, init=False)
    _heard_ns: tuple[int, ...] = field(default=(), init=False)
    _went_ns: deque[int] = field(default_factory=lambda: deque(maxlen=REMEMBERED), init=False)
    _jumped: tuple[int, str] | None = field(default=None, init=False)

    @property
    def name(self) -> str:
        """In a word, for the table of stages."""
        return "times"

    def hear(self, snapshot: Snapshot) -> tuple[Finding, ...]:
        """What is odd about the times of a snapshot, beside those before it."""
        found = [*self._clock(snapshot)]
        for frame in snapshot.frames:
            if frame.stamp_ns is not None:
                found += self._camera(frame, frame.stamp_ns, snapshot.now_ns)
        if not self.recorded:
            found += [*self._skew(snapshot), *self._rate(snapshot)]
        return tuple(found)

    def _clock(self, snapshot: Snapshot) -> Iterator[Finding]:
        """The time of the snapshot itself."""
        now, before = snapshot.now_ns, self._now_ns
        if now is None:
            return
        greatest = now if self._greatest_now_ns is None else max(now, self._greatest_now_ns)
        self._now_ns, self._greatest_now_ns = now, greatest
        if now < greatest:
            text = (
                f"the clock went back by {length_text(greatest - now)}, so no age can be trusted: was it set? "
                "Start the monitor again"
            )
            yield Finding("clock", (), text, True)
        elif not self.recorded and before is not None:
            yield from self._jump(now - before)
        elif self.recorded and before is not None and now - before > self.gap_ns:
            yield Finding("gap", (), f"nothing was recorded for {length_text(now - before)}: skipped", False)

    def _jump(self, went_ns: int) -> Iterator[Finding]:
        """That the clock went ahead of this computer's: a snapshot is dated after the one before was taken up, so that
        between two of them there is no more time than between their passes and one pass before.

        Args:
            went_ns: by the clock of the snapshots, since the one before [ns].
        """
        heard_ns = self.clock_ns()
        steps = sorted(self._went_ns)
        usual_ns = steps[len(steps) // 2] if len(steps) >= LEAST_STEPS else went_ns
        self._went_ns.append(went_ns)
        is_far = len(self._heard_ns) == 2 and went_ns > heard_ns - self._heard_ns[0] + JUMP_NS
        if is_far and went_ns > JUMP_STEPS * usual_ns:
            text = (
                f"the clock went ahead by {length_text(went_ns)} within "
                f"{length_text(heard_ns - self._heard_ns[0])}, so no age can be trusted: was it set?"
            )
            self._jumped = heard_ns, text
        self._heard_ns = (*self._heard_ns, heard_ns)[-2:]
        if self._jumped is not None and heard_ns - self._jumped[0] <= JUMP_LASTS_NS:
            yield Finding("clock", (), self._jumped[1], True)

    def _camera(self, frame: DepthFrame, stamp_ns: int, now_ns: int | None) -> Iterator[Finding]:
        """One frame beside what its camera gave before, and beside the clock."""
        heard = self._heard.get(frame.camera)
        if heard is None:
            self._heard[frame.camera] = _Heard(stamp_ns, frame.depth_m, stamp_ns)
        else:
            yield from _beside(heard, frame, stamp_ns)
            if stamp_ns > heard.stamp_ns:
                heard.steps_ns.append(stamp_ns - heard.stamp_ns)
            heard.stamp_ns, heard.depth_m = stamp_ns, frame.depth_m
            heard.greatest_ns = max(stamp_ns, heard.greatest_ns)
        if now_ns is not None and stamp_ns - now_ns > AHEAD_NS:
            text = (
                f"camera {frame.camera} is {length_text(stamp_ns - now_ns)} ahead of the clock, so its age is not "
                "known: bring camera and computer to one clock"
            )
            yield Finding("clock", (frame.camera,), text, True)

    def _skew(self, snapshot: Snapshot) -> Iterator[Finding]:
        """How far apart in time the frames of one moment are, beside how often cameras give one."""
        young = snapshot.fresh(self.max_age_ns).frames if snapshot.now_ns is not None else snapshot.frames
        stamps = {frame.camera: frame.stamp_ns for frame in young if frame.stamp_ns is not None}
        if len(stamps) < 2:
            return
        steps = [h.usual_step_ns for h in self._heard.values() if h.steps_ns]
        limit = max(SKEW_STEPS * max(steps), SKEW_NS) if steps else UNKNOWN_STEP_NS
        oldest, newest = min(stamps, key=stamps.__getitem__), max(stamps, key=stamps.__getitem__)
        skew = stamps[newest] - stamps[oldest]
        if skew > limit:
            step = f", images come every {length_text(max(steps))}" if steps else ""
            text = (
                f"camera {oldest} is {length_text(skew)} behind camera {newest}{step}: not one moment. Another clock "
                "or unit, or a camera that stopped: with max_frame_age_ms it is left out"
            )
            yield Finding("skew", (oldest, newest), text, True)

    def _rate(self, snapshot: Snapshot) -> Iterator[Finding]:
        """How fast stamps go beside the clock of this computer."""
        newest = max((f.stamp_ns for f in snapshot.frames if f.stamp_ns is not None), default=None)
        if newest is None:
            return
        if self._first is None:
            self._first = newest, self.clock_ns()
        went, took = newest - self._first[0], self.clock_ns() - self._first[1]
        if took < RATE_AFTER_NS or TOO_SLOW < went / took < TOO_FAST or went <= 0:
            return
        text = (
            f"stamps went on by {length_text(went)} in {length_text(took)}: they are not in nanoseconds, so no limit "
            "on age or skew holds; convert them where frames come in"
        )
        yield Finding("unit", (), text, True)


def _beside(heard: _Heard, frame: DepthFrame, stamp_ns: int) -> Iterator[Finding]:
    """A frame beside the one before of the same camera."""
    if stamp_ns < heard.greatest_ns:
        text = (
            f"camera {frame.camera} went back in time by {length_text(heard.greatest_ns - stamp_ns)}: images out of "
            "order, or its clock was set; it counts again when it is past what it gave before"
        )
        yield Finding("order", (frame.camera,), text, True)
    elif stamp_ns == heard.stamp_ns and not _is_same(frame.depth_m, heard.depth_m):
        text = (
            f"camera {frame.camera} gives another image with the stamp of the one before ({stamp_ns} ns): its stamps "
            "stand still, so no age can be trusted"
        )
        yield Finding("order", (frame.camera,), text, True)


def _is_same(one: NDArray[np.float32], other: NDArray[np.float32]) -> bool:
    return one is other or np.array_equal(one, other, equal_nan=True)
