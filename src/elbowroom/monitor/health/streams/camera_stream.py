"""One camera's images as they come: which causes are there by now. It remembers."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from elbowroom.geometry import DepthCamera
from elbowroom.monitor.health.held import Held
from elbowroom.monitor.health.streams.arrivals import MOST_A_PASS_NS, Arrivals
from elbowroom.monitor.health.streams.cause import HealthCause
from elbowroom.monitor.health.streams.cover import COVERED, NOTHING, PARTLY, Cover
from elbowroom.monitor.health.streams.picture import (
    EQUAL_TILES,
    Odd,
    agrees,
    equal_share,
    oddity,
    pairs_of,
)
from elbowroom.monitor.health.streams.thumb import Thumb
from elbowroom.sensing import DepthFrame

C = HealthCause
START_NS = 5_000_000_000
"""A camera may take so long to its first image; then it is disconnected [ns]."""
AGES = 10
"""After so many images it is known how old they come."""
LATE_STEPS, LATE_NS = 3.0, 200_000_000
"""Where the site sets no limit, an image is late that is older than usual by so many steps, and by this [ns]."""
OF_PICTURES = (C.CAMERA_SWAPPED, C.CAMERA_WRONG_SCALE, C.CAMERA_WRONG_ENCODING)
AFTER = {C.CAMERA_COVERED: 2, C.CAMERA_PARTLY_COVERED: 2}
CLEARS_AFTER = {C.CAMERA_STARTING: 1, C.CAMERA_GAPS: 5, C.CAMERA_COVERED: 5, C.CAMERA_PARTLY_COVERED: 5}
CLEARS = {
    C.CAMERA_STARTING: "its first image that has returns",
    C.CAMERA_DISCONNECTED: "3 new images",
    C.CAMERA_GAPS: "5 images in a row without a gap",
    C.CAMERA_DAMAGED: "3 images in a row that can be read",
    C.CAMERA_WRONG_SIZE: "3 images in a row of its size",
    C.CAMERA_CLOCK: "3 images in a row whose stamps go on",
    C.CAMERA_FROZEN: "3 images in a row that are not the one before",
    C.CAMERA_SWAPPED: "3 images in a row that are its own",
    C.CAMERA_WRONG_SCALE: "3 images in a row that agree with the last good one",
    C.CAMERA_WRONG_ENCODING: "3 images in a row that agree with the last good one",
    C.CAMERA_COVERED: "5 images in a row with returns where it usually has them",
    C.CAMERA_PARTLY_COVERED: "5 images in a row with returns where it usually has them",
    C.CAMERA_TOO_OLD: "3 images in a row that are young enough",
    C.CAMERA_MOVED: "a monitor that is started again",
    C.CAMERA_DOUBTED: "3 images in a row that go with what it was commissioned on, or the watch, which decides soon",
}


@dataclass(frozen=True, slots=True)
class Moment:
    """What a camera's memory is told at each pass.

    Args:
        went_ns: between this pass and the one before, by the clock of the frames [ns].
        now_ns: the time now [ns, that clock]; None: nothing has a time.
        bound_ns: by how much the frame may be older than its stamp says [ns].
        clock: what is wrong with the frame's stamp; None: nothing is.
        damaged: why its newest image cannot be read; None: it can.
    """

    went_ns: int
    now_ns: int | None
    bound_ns: int = 0
    clock: str | None = None
    damaged: str | None = None


@dataclass(slots=True, eq=False)
class CameraStream:
    """What is remembered of one camera.

    Args:
        camera: as the site says.
        repeats: it is exact, so that equal images say nothing.
        max_age_ns: images that are older are too old [ns]; None: those are that are older than they usually come.
        spots: what it was commissioned on, as a small image; None: it was not.
    """

    camera: DepthCamera
    repeats: bool = False
    max_age_ns: int | None = None
    spots: Thumb | None = None

    good: Thumb | None = field(default=None, init=False)
    """The last image in which nothing was wrong."""
    texts: dict[HealthCause, str] = field(default_factory=dict, init=False)
    """What was found last, by cause."""
    _held: dict[HealthCause, Held] = field(init=False)
    _arrivals: Arrivals = field(default_factory=Arrivals, init=False)
    _last: DepthFrame | None = field(default=None, init=False)
    _thumb: Thumb | None = field(default=None, init=False)
    _cover: Cover | None = field(default=None, init=False)
    _ages_ns: list[int] = field(default_factory=list, init=False)
    _since_start_ns: int = field(default=0, init=False)
    _stretch: NDArray[np.float32] = field(init=False)

    def __post_init__(self) -> None:
        self._held = {cause: Held(AFTER.get(cause, 1), CLEARS_AFTER.get(cause, 3)) for cause in CLEARS}
        self._held[C.CAMERA_STARTING] = Held(1, 1, is_there=True)
        self.texts[C.CAMERA_STARTING] = "is awaited: no image has come"
        x, y = self.camera.intrinsics.normalised(self.camera.width, self.camera.height)
        step = Thumb.of(np.empty((1, self.camera.width), dtype=np.float32)).step
        across, down = x[::step], y[::step]
        self._stretch = np.sqrt(1 + across[None, :] ** 2 + down[:, None] ** 2).astype(np.float32)
        if self.spots is not None:
            self.good, self._cover = self.spots, Cover.commissioned(self.spots)

    def hear(self, frame: DepthFrame | None, moment: Moment, good: Mapping[str, Thumb]) -> None:
        """Takes one pass into account.

        Args:
            frame: the newest of this camera; None: there is none.
            moment: what is known beside it.
            good: by camera, the last good images of all, before this pass.
        """
        is_new = self._is_new(frame)
        self._since_start_ns += min(max(moment.went_ns, 0), MOST_A_PASS_NS)
        before, self._arrivals = self._arrivals, self._arrivals.passing(moment.went_ns, is_new)
        self._hear_times(frame, moment, before, is_new)
        if frame is None or not is_new:
            return
        size = frame.depth_m.shape
        due = self.camera.height, self.camera.width
        text = f"gives images of {size[1]} x {size[0]} pixels, the site says {due[1]} x {due[0]}"
        self._say(C.CAMERA_WRONG_SIZE, size != due, text)
        if size == due:
            self._look(Thumb.of(frame.depth_m), frame, good)
        self._last = frame

    @property
    def causes(self) -> Iterator[HealthCause]:
        """Those that are there, what explains others without them."""
        there = {cause for cause, held in self._held.items() if held.is_there}
        if not there:
            return iter(())
        if there & {C.CAMERA_DISCONNECTED, C.CAMERA_FROZEN, C.CAMERA_STARTING}:
            there -= {C.CAMERA_GAPS, C.CAMERA_TOO_OLD}
        if there & {C.CAMERA_DISCONNECTED, C.CAMERA_COVERED}:
            there -= {C.CAMERA_STARTING}
        if there & {C.CAMERA_GAPS, C.CAMERA_CLOCK}:
            there -= {C.CAMERA_TOO_OLD}
        if C.CAMERA_COVERED in there:
            there -= {C.CAMERA_PARTLY_COVERED}
        return (cause for cause in HealthCause if cause in there)

    @property
    def is_usable(self) -> bool:
        """Whether its newest image can be looked at at all."""
        return not self._held[C.CAMERA_WRONG_SIZE].is_there

    def _is_new(self, frame: DepthFrame | None) -> bool:
        last = self._last
        if frame is None or last is None:
            return frame is not None
        return frame is not last and (frame.stamp_ns is None or frame.stamp_ns != last.stamp_ns)

    def _say(self, cause: HealthCause, is_bad: bool | None, text: str) -> None:
        if is_bad:
            self.texts[cause] = text
        self._held[cause] = self._held[cause].hearing(is_bad)

    def _hear_times(self, frame: DepthFrame | None, moment: Moment, before: Arrivals, is_new: bool) -> None:
        """What arrivals, stamps and ages say."""
        now, waited_s = self._arrivals, self._arrivals.waited_ns / 1e9
        again = frame is not None and not is_new and frame is not self._last  # it gives, but nothing new
        if now.came == 0:
            self._say(C.CAMERA_STARTING, True, f"is awaited: no image has come for {waited_s:.1f} s")
            gone: bool | None = True if now.waited_ns > START_NS else None
        else:
            gone = True if now.is_gone else (False if is_new else None)
        self._say(C.CAMERA_DISCONNECTED, gone, f"gives no new image, for {waited_s:.1f} s")
        in_time = not before.passing(moment.went_ns, False).is_overdue
        gap = True if now.is_overdue else (False if is_new and in_time else None)
        usual = "" if now.usual_ns is None else f", one comes every {now.usual_ns / 1e6:.0f} ms as a rule"
        self._say(C.CAMERA_GAPS, gap, f"loses images: none came for {1e3 * waited_s:.0f} ms{usual}")
        if again and now.is_overdue:
            self._say(C.CAMERA_FROZEN, True, f"gives images whose stamp stands still, for {waited_s:.1f} s")
        self._say(C.CAMERA_DAMAGED, self._sign(moment.damaged, is_new), moment.damaged or "")
        self._say(C.CAMERA_CLOCK, self._sign(moment.clock, is_new), moment.clock or "")
        if frame is not None and frame.stamp_ns is not None and moment.now_ns is not None:
            self._hear_age(moment.now_ns - frame.stamp_ns + moment.bound_ns, is_new)

    @staticmethod
    def _sign(found: str | None, is_new: bool) -> bool | None:
        return True if found is not None else (False if is_new else None)

    def _hear_age(self, age_ns: int, is_new: bool) -> None:
        limit_ns = self.max_age_ns
        if limit_ns is None:
            if len(self._ages_ns) < AGES:
                self._ages_ns += [age_ns] if is_new else []
                return
            usual_ns = sorted(self._ages_ns)[AGES // 2]
            limit_ns = usual_ns + max(LATE_NS, round(LATE_STEPS * (self._arrivals.usual_ns or 0)))
        text = f"gives images that are {age_ns / 1e6:.0f} ms old, at most {limit_ns / 1e6:.0f} ms are right"
        self._say(C.CAMERA_TOO_OLD, True if age_ns > limit_ns else (False if is_new else None), text)

    def _look(self, thumb: Thumb, frame: DepthFrame, good: Mapping[str, Thumb]) -> None:
        """What a new image of the right size says."""
        has_returns = thumb.share >= NOTHING
        self._say(C.CAMERA_STARTING, None if not has_returns else False, "")
        if self._held[C.CAMERA_STARTING].is_there:
            self.texts[C.CAMERA_STARTING] = "is awaited: its images have no returns"
            if self._since_start_ns > START_NS:
                self._say(C.CAMERA_COVERED, True, "has given no image with returns yet")
        self._look_for_same(thumb, frame)
        self._look_at_cover(thumb)
        odd = self._look_at_picture(thumb, good) if has_returns else None
        self._thumb = thumb
        if odd is None and has_returns and not any(True for _ in self.causes):
            self.good = thumb
            if self._cover is not None:
                self._cover = self._cover.learning(thumb)

    def _look_for_same(self, thumb: Thumb, frame: DepthFrame) -> None:
        if self.repeats or self._thumb is None or self._last is None:
            return
        share = equal_share(thumb, self._thumb)
        is_same = None if share is None else share >= EQUAL_TILES
        if share == 1.0 and self._last.depth_m.shape == frame.depth_m.shape:
            is_same = bool(np.array_equal(self._last.depth_m, frame.depth_m, equal_nan=True)) or is_same
        what = "the image before" if share == 1.0 else f"{share or 0:.0%} of the image before"
        self._say(C.CAMERA_FROZEN, is_same, f"gives {what} again, bit by bit, with a new stamp")

    def _look_at_cover(self, thumb: Thumb) -> None:
        if self._cover is None:
            self._cover = Cover.unknown(thumb)
        lost = self._cover.lost(thumb)
        if lost is None:
            if thumb.share >= NOTHING:
                self._say(C.CAMERA_COVERED, False, "")
            return
        text = f"has no returns in {lost:.0%} of where it usually has them"
        self._say(C.CAMERA_COVERED, lost >= COVERED, text)
        self._say(C.CAMERA_PARTLY_COVERED, lost >= PARTLY, text)

    def _look_at_picture(self, thumb: Thumb, good: Mapping[str, Thumb]) -> Odd | None:
        """What is odd about the picture; nothing is over until it agrees with the last good one again."""
        is_own = None if self.good is None else agrees(thumb, self.good)
        if self.good is None or is_own is None:
            return None
        if is_own:
            for cause in OF_PICTURES:
                self._say(cause, False, "")
            return None
        pairs = pairs_of(thumb, self.good, self._stretch)
        assert pairs is not None
        others = {name: each for name, each in good.items() if name != self.camera.name}
        odd = oddity(thumb, self.good, pairs, others)
        if odd is not None:
            self._say(odd.cause, True, odd.text)
        return odd
