"""Watches whether one camera stands where it was commissioned."""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from elbowroom.errors import InputError
from elbowroom.geometry import DepthCamera
from elbowroom.monitor.health.drift.doubt import ANOTHERS, WORTH_A_FIT, Doubt, Shares, shares_of
from elbowroom.monitor.health.drift.fit import MOVE_PRIOR_M, TURN_PRIOR_RAD, convinces
from elbowroom.monitor.health.drift.kernels.watch import Counts, Fit, Gate, Memory, Spots, judge_image
from elbowroom.monitor.health.drift.lasting import Lasting
from elbowroom.monitor.health.drift.reference import CameraReference
from elbowroom.monitor.health.drift.sequential import Tally
from elbowroom.monitor.health.drift.shift import Shift
from elbowroom.monitor.health.drift.shown_part import ShownPart
from elbowroom.monitor.health.drift.tolerance import Tolerance
from elbowroom.monitor.health.health import CameraHealth, Condition
from elbowroom.sensing import DepthFrame

GATE_M = 0.20
SIGMAS = 3.0
LEAST_SEEN = 60
"""So many spots must be in view for a frame to say anything."""
LEAST_SEEN_SHARE = 0.15
FRAMES = 6
"""So many more frames must say that it moved than say, counted twice, that it did not."""
CHANGED_FRAMES = 12
CHANGED_FIT = 0.5
COVERED_SHARE = 0.97
HIDDEN_SHARE = 0.7


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
    _lasting: Lasting = field(default_factory=Lasting, init=False)
    _doubt: Doubt = field(default_factory=Doubt, init=False)
    _is_gone: bool = field(default=False, init=False)
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
            frame: of this camera; None: it gave none. One that was heard already is no new one, and counts once.
            now_ns: the time now [ns, the clock of the frames].

        Raises:
            InputError: the image is of another size than the reference's.
        """
        if frame is None or self._was_heard(frame):
            self._lasting.silent(now_ns)
            self._stop_if_too_long()
            return self._silent if frame is None else self.newest
        now = self._judge(frame)
        shares = self._shares(frame.depth_m.ravel())
        self._doubt.hear(*self._contradiction(frame, now, shares))
        now = replace(now, doubt=self._doubt.text)
        self._newest = frame.stamp_ns, now
        self._is_gone = now.condition is Condition.CHANGED or (shares.gone and self._can_tell(shares))
        self._count(frame, now, frame.stamp_ns if frame.stamp_ns is not None else now_ns)
        return now

    def pass_over(self, frame: DepthFrame | None, now_ns: int) -> CameraHealth:
        """What was said last, without a look at the newest frame, of which all that counts is whether it is there.

        Args:
            frame, now_ns: as of `hear`.
        """
        if frame is None or self._was_heard(frame):
            return self.hear(frame, now_ns)
        self._lasting.not_silent()
        return self.newest

    def shows(self, frame: DepthFrame, others: Sequence["CameraWatch"]) -> str | None:
        """The camera on whose reference an image lies that does not lie on its own; None: none.

        Args:
            frame: of this camera.
            others: the watches of the other cameras.
        """
        image = frame.depth_m.ravel()
        own = self._shares(image)
        off = {}
        for other in others:
            reference = other.reference
            if (reference.width, reference.height) == (self.reference.width, self.reference.height):
                shares = other._shares(image)
                if other._can_tell(shares):
                    off[other.camera.name] = shares.off
        name = min(off, key=lambda each: off[each], default=None)
        is_its = name is not None and own.off >= WORTH_A_FIT and off[name] <= ANOTHERS * own.off
        return name if is_its else None

    def _shares(self, image: NDArray[np.float32]) -> Shares:
        return shares_of(image, self._spots, self._gate)

    def _was_heard(self, frame: DepthFrame) -> bool:
        return self._newest is not None and frame.stamp_ns is not None and self._newest[0] == frame.stamp_ns

    @property
    def newest(self) -> CameraHealth:
        """What was said last; before there was a frame, that it gave none."""
        return self._newest[1] if self._newest is not None else self._silent

    @property
    def _silent(self) -> CameraHealth:
        return CameraHealth(self.camera.name, Condition.SILENT, None, 0.0, 1.0)

    def _judge(self, frame: DepthFrame) -> CameraHealth:
        """What one frame says by itself."""
        self._require_size(frame)
        (within, nearer, farther, lost), fit = self._listen(frame, self._memory)
        total = len(self.reference.pixel)
        fits = max(fit.fits_still, fit.fits_moved) * within
        seen, hidden = fits / total, (nearer + lost) / total
        shift = None
        if lost >= COVERED_SHARE * total:
            condition = Condition.BLIND
        elif hidden >= COVERED_SHARE:
            condition = Condition.COVERED
        elif within + farther < max(LEAST_SEEN, LEAST_SEEN_SHARE * total):
            condition = Condition.HIDDEN if hidden >= HIDDEN_SHARE else Condition.UNSURE
        elif fits < CHANGED_FIT * (within + farther):
            condition = Condition.CHANGED
        else:
            shift = self._shift(fit)
            moved = convinces(fit) and shift.exceeds(self._least.turn_rad, self._least.move_m, SIGMAS)
            still = Condition.HIDDEN if hidden >= HIDDEN_SHARE else Condition.STILL
            condition = Condition.MOVED if moved else still
        return CameraHealth(self.camera.name, condition, shift, seen, hidden)

    def _can_tell(self, shares: Shares) -> bool:
        return shares.shown >= max(LEAST_SEEN, LEAST_SEEN_SHARE * len(self.reference.pixel))

    def _contradiction(self, frame: DepthFrame, now: CameraHealth, shares: Shares) -> tuple[str | None, bool]:
        """What this image alone says against where the camera is said to be, and whether it can tell at all."""
        if now.condition in (Condition.MOVED, Condition.CHANGED):
            return f"may be elsewhere: it {now.condition.value}", True
        if not self._can_tell(shares):
            return None, False
        if shares.contradict:
            text = f"may be elsewhere: it sees through {shares.through:.0%} of what stood still before it"
            return text, True
        if shares.off < WORTH_A_FIT:
            return None, True
        fit = self._listen(frame, _nothing_heard(self._spots))[1]
        shift = self._shift(fit)
        if not (convinces(fit) and shift.exceeds(self._least.turn_rad, self._least.move_m, SIGMAS)):
            return None, True
        words = shift.words(self._least.turn_rad, self._least.move_m)
        return f"may be elsewhere: its image fits one that has {words}", True

    @property
    def _gate(self) -> Gate:
        return Gate(float(self.camera.min_depth_m), float(self.camera.deepest_m), GATE_M)

    def _require_size(self, frame: DepthFrame) -> None:
        height, width = frame.depth_m.shape
        if (height, width) != (self.reference.height, self.reference.width):
            raise InputError(
                f"watch: frame of {self.camera.name} is {width} x {height} pixels, its reference "
                f"{self.reference.width} x {self.reference.height}"
            )

    def _listen(self, frame: DepthFrame, memory: Memory) -> tuple[Counts, Fit]:
        """Adds a frame to a memory: numbers of spots, and the motion that fits them."""
        counts, fit = judge_image(
            frame.depth_m.ravel(), self._spots, self._gate, TURN_PRIOR_RAD, MOVE_PRIOR_M, memory
        )
        return counts, fit

    def _shift(self, fit: Fit) -> Shift:
        """A fitted motion as far as the view shows it."""
        if self._part is not None:
            return self._part.shift(fit.motion, fit.covariance)
        return Shift.of(fit.motion, fit.covariance)

    def _count(self, frame: DepthFrame, now: CameraHealth, stamp_ns: int) -> None:
        """Lets the tests hear what the frame said."""
        condition = now.condition
        can_tell = now.shift is not None
        moved = self._moved.add(condition is Condition.MOVED if can_tell else None)
        changed = self._changed.add(self._is_gone)
        self._lasting.seen(_hidden_as(now), stamp_ns)
        if self.stop is not None:
            return
        shift = None
        if self._moved.score == 0:
            self._since_moved.frames[:] = 0
        else:
            # the size is that of frames after the knock: the mean that found it holds some from before
            shift = self._shift(self._listen(frame, self._since_moved)[1])
        name = self.camera.name
        if moved and shift is not None:
            self.shift = shift
            self.stop = f"camera {name} has {shift.words(self._least.turn_rad, self._least.move_m)}"
        elif changed:
            self.stop = (
                f"camera {name} {Condition.CHANGED.value}: turned or moved far, or the room was rebuilt"
            )
        else:
            self._stop_if_too_long(now.share_hidden)

    def _stop_if_too_long(self, share_hidden: float | None = None) -> None:
        """Stops for what has lasted too long; the share of the reference that is hidden is said where it is known."""
        too_long = self._lasting.too_long
        if self.stop is not None or too_long is None:
            return
        condition, lasted_s = too_long
        hidden = (
            "" if share_hidden is None else f": {100 * share_hidden:.0f} % of what it was commissioned on"
        )
        self.stop = f"camera {self.camera.name} {condition.value}{hidden}, for {lasted_s:.0f} s"


def _hidden_as(now: CameraHealth) -> set[Condition]:
    """All in which its view is hidden: one that is blind is covered, and one that is covered is hidden."""
    shares = {Condition.HIDDEN: HIDDEN_SHARE, Condition.COVERED: COVERED_SHARE}
    said = {condition for condition, share in shares.items() if now.share_hidden >= share}
    return said | ({now.condition} & {Condition.BLIND})


def _nothing_heard(spots: Spots) -> Memory:
    n = len(spots.pixel)
    return Memory(np.zeros(n), np.zeros(n), np.zeros(n, dtype=np.int64), np.zeros(n, dtype=np.int64))
