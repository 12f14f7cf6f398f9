"""Watches whether one camera stands where it was commissioned."""

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from elbowroom.errors import InputError
from elbowroom.geometry import DepthCamera
from elbowroom.monitor._kernels_watch import Memory, Spots, judge_image
from elbowroom.monitor.health import CameraHealth, Condition
from elbowroom.monitor.reference import MOVE_PRIOR_M, TURN_PRIOR_RAD, CameraReference
from elbowroom.monitor.sequential import Tally
from elbowroom.monitor.shift import Shift
from elbowroom.monitor.shown_part import ShownPart
from elbowroom.monitor.tolerance import Tolerance
from elbowroom.sensing import DepthFrame

GATE_M = 0.20
SIGMAS = 3.0
LEAST_SEEN = 60
"""So many spots must be in view for a frame to say anything."""
LEAST_SEEN_SHARE = 0.15
FOR_OVER_AGAINST = 5.0
"""What speaks for a motion must outweigh so much what stands where it was: a table that is pushed moves no wall."""
LEAST_FOR = 20.0
LEAST_FIT = 0.5
"""So much of what is in view must fit the motion."""
FRAMES = 6
"""So many more frames must say that it moved than say, counted twice, that it did not."""
CHANGED_FRAMES = 12
CHANGED_FIT = 0.5
COVERED_SHARE = 0.97
COVERED_S = 5.0
BLIND_S = 1.0


@dataclass(slots=True, eq=False)
class CameraWatch:
    """Hears the frames of one camera and remembers what its tests have come to.

    Args:
        camera: as the site says.
        reference: what it was commissioned on.
        tolerance: what is not yet called moved.
    """

    camera: DepthCamera
    reference: CameraReference
    tolerance: Tolerance = field(default_factory=Tolerance)

    stop: str | None = field(default=None, init=False)
    """Why nothing may move, once it was found; it stays."""
    shift: Shift | None = field(default=None, init=False)
    """By how much it had moved when that was found."""
    _part: ShownPart | None = field(init=False)
    _least: Tolerance = field(init=False)
    """What is not yet called moved in this view."""
    _spots: Spots = field(init=False)
    _memory: Memory = field(init=False)
    _since_moved: Memory = field(init=False)
    _moved: Tally = field(default_factory=lambda: Tally(FRAMES), init=False)
    _changed: Tally = field(default_factory=lambda: Tally(CHANGED_FRAMES), init=False)
    _since: dict[Condition, int] = field(default_factory=dict, init=False)
    _newest: tuple[int | None, CameraHealth] | None = field(default=None, init=False)

    def __post_init__(self) -> None:
        self.reference.require(self.camera)
        self._part = ShownPart.of(self.reference, self.tolerance)
        self._least = self.tolerance if self._part is None else self._part.tolerance
        self._spots = self.reference.spots()
        self._memory, self._since_moved = _nothing_heard(self._spots), _nothing_heard(self._spots)

    def hear(self, frame: DepthFrame | None, now_ns: int) -> CameraHealth:
        """Judges the newest frame.

        Args:
            frame: of this camera; None: it gave none. A frame that was heard already is not counted again.
            now_ns: the time now [ns, the clock of the frames].

        Raises:
            InputError: the image is of another size than the reference's.
        """
        if frame is None:
            return self._silent
        if self._newest is not None and frame.stamp_ns is not None and self._newest[0] == frame.stamp_ns:
            return self._newest[1]
        now = self._judge(frame)
        self._newest = frame.stamp_ns, now
        self._count(frame, now, frame.stamp_ns if frame.stamp_ns is not None else now_ns)
        return now

    @property
    def newest(self) -> CameraHealth:
        """What was said last; before there was a frame, that it gave none."""
        return self._newest[1] if self._newest is not None else self._silent

    @property
    def _silent(self) -> CameraHealth:
        return CameraHealth(self.camera.name, Condition.SILENT, None, 0.0)

    def _judge(self, frame: DepthFrame) -> CameraHealth:
        """What one frame says by itself."""
        image, name = frame.depth_m, self.camera.name
        if image.shape != (self.reference.height, self.reference.width):
            raise InputError(
                f"watch: frame of {name} is {image.shape[1]} x {image.shape[0]} pixels, its reference "
                f"{self.reference.width} x {self.reference.height}"
            )
        counted, shift, said = self._listen(frame, self._memory)
        within, nearer, farther, lost = (int(number) for number in counted)
        total = len(self.reference.pixel)
        speaks_for, against, fits_still, fits_moved = (float(share) for share in said)
        fits = max(fits_still, fits_moved) * within
        share = fits / total
        if lost >= COVERED_SHARE * total:
            return CameraHealth(name, Condition.BLIND, None, share)
        if nearer + lost >= COVERED_SHARE * total:
            return CameraHealth(name, Condition.COVERED, None, share)
        if within + farther < max(LEAST_SEEN, LEAST_SEEN_SHARE * total):
            return CameraHealth(name, Condition.UNSURE, None, share)
        if fits < CHANGED_FIT * (within + farther):
            return CameraHealth(name, Condition.CHANGED, None, share)
        moved = (
            speaks_for > max(FOR_OVER_AGAINST * against, LEAST_FOR)
            and fits_moved >= LEAST_FIT
            and shift.exceeds(self._least.turn_rad, self._least.move_m, SIGMAS)
        )
        return CameraHealth(name, Condition.MOVED if moved else Condition.STILL, shift, share)

    def _listen(
        self, frame: DepthFrame, memory: Memory
    ) -> tuple[NDArray[np.int64], Shift, NDArray[np.float64]]:
        """Adds a frame to a memory: numbers of spots, the shift that fits, and what speaks for it (`fit_motion`)."""
        counted, said = np.empty(4, dtype=np.int64), np.empty(4)
        motion, covariance = np.empty(6), np.empty((6, 6))
        judge_image(
            frame.depth_m.ravel(), self._spots, float(self.camera.min_depth_m), float(self.camera.max_depth_m),
            GATE_M, TURN_PRIOR_RAD, MOVE_PRIOR_M, memory, counted, motion, covariance, said,
        )  # fmt: skip
        shift = Shift.of(motion, covariance) if self._part is None else self._part.shift(motion, covariance)
        return counted, shift, said

    def _count(self, frame: DepthFrame, now: CameraHealth, stamp_ns: int) -> None:
        """Lets the tests hear what the frame said."""
        condition = now.condition
        can_tell = condition in (Condition.MOVED, Condition.STILL)
        moved = self._moved.add(condition is Condition.MOVED if can_tell else None)
        changed = self._changed.add(condition is Condition.CHANGED)
        for lasting in (Condition.COVERED, Condition.BLIND):
            if condition is lasting:
                self._since.setdefault(lasting, stamp_ns)
            else:
                self._since.pop(lasting, None)
        if self.stop is not None:
            return
        shift = None
        if self._moved.score == 0:
            self._since_moved.frames[:] = 0
        else:
            # the size is that of frames after the knock: the mean that found it holds some from before
            _, shift, _ = self._listen(frame, self._since_moved)
        self.stop = self._found(shift if moved else None, changed, stamp_ns)

    def _found(self, shift: Shift | None, changed: bool, stamp_ns: int) -> str | None:
        """The reason to stop, if a test has decided."""
        name = self.camera.name
        if shift is not None:
            self.shift = shift
            return f"camera {name} has {shift.words(self._least.turn_rad, self._least.move_m)}"
        if changed:
            return f"camera {name} {Condition.CHANGED.value}: turned or moved far, or the room was rebuilt"
        for lasting, limit_s in ((Condition.COVERED, COVERED_S), (Condition.BLIND, BLIND_S)):
            lasted = (stamp_ns - self._since.get(lasting, stamp_ns)) / 1e9
            if lasted >= limit_s:
                return f"camera {name} {lasting.value}, for {lasted:.0f} s"
        return None


def _nothing_heard(spots: Spots) -> Memory:
    n = len(spots.pixel)
    return Memory(np.zeros(n), np.zeros(n), np.zeros(n, dtype=np.int64), np.zeros(n, dtype=np.int64))
