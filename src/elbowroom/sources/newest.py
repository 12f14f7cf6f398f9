"""The newest frame of each camera that is of one moment, each image read once and brought to the room's clock."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import NamedTuple

from elbowroom.errors import BagError, FrameError
from elbowroom.finding import Finding
from elbowroom.sensing import DepthFrame
from elbowroom.sources.layouts.bag_image import Arrival
from elbowroom.sources.layouts.image import Image
from elbowroom.sources.room_clock import RoomClock
from elbowroom.sources.times.series import length_text


class Dated(NamedTuple):
    """A frame on the room's clock.

    Args:
        frame: with the time of its exposure.
        bound_ns: how much earlier that may have been [ns].
    """

    frame: DepthFrame
    bound_ns: int


@dataclass(slots=True, eq=False)
class Newest:
    """Remembers the newest image of each camera.

    Args:
        clock: of the room.
        max_skew_ns: frames that are older than the newest by more are left out [ns].
    """

    clock: RoomClock
    max_skew_ns: int
    _arrived: dict[str, Image] = field(default_factory=dict, init=False)
    _read: dict[str, tuple[Image, Dated]] = field(default_factory=dict, init=False)
    _damaged: dict[str, tuple[Image, str]] = field(default_factory=dict, init=False)

    def come(self, arrivals: Sequence[Arrival]) -> None:
        """These images have come; of each camera the last counts."""
        for arrival in arrivals:
            camera = arrival.image.camera.name
            self.clock.hear(camera, arrival.received_ns, arrival.image.stamp_ns or 0)
            self._arrived[camera] = arrival.image

    def at(self, now_ns: int) -> tuple[list[Dated], list[Finding]]:
        """The newest frame of each camera that is of the moment, and what is said of the others.

        A camera whose newest image is damaged has none, nor has one whose clock is not known yet.
        """
        dated, found = {}, []
        for camera, image in self._arrived.items():
            one = self._of(camera, image, now_ns)
            if isinstance(one, Dated):
                dated[camera] = one
            elif one is not None:
                found.append(Finding("damaged", (camera,), f"camera {camera} is left out: {one}", False))
        latest_ns = max((one.frame.stamp_ns or 0 for one in dated.values()), default=0)
        kept = []
        for camera, one in dated.items():
            behind_ns = latest_ns - (one.frame.stamp_ns or 0)
            if behind_ns > self.max_skew_ns:
                found.append(Finding("skew", (camera,), self._left(camera, behind_ns), False))
            else:
                kept.append(one)
        return kept, found

    def _of(self, camera: str, image: Image, now_ns: int) -> Dated | str | None:
        """An image as a frame on the room's clock; what is wrong with it; or None: its time is not known."""
        read, damaged = self._read.get(camera), self._damaged.get(camera)
        if read is not None and read[0] is image:
            return read[1]
        if damaged is not None and damaged[0] is image:
            return damaged[1]
        time = self.clock.of(camera, image.stamp_ns or 0, now_ns)
        if time is None:
            return None
        try:
            frame = image.read()
        except (BagError, FrameError) as error:
            self._damaged[camera] = image, str(error)
            return str(error)
        one = Dated(DepthFrame(camera, time.stamp_ns, frame.depth_m), time.bound_ns)
        self._read[camera] = image, one
        return one

    def _left(self, camera: str, behind_ns: int) -> str:
        return (
            f"camera {camera} is left out: its newest image is {length_text(behind_ns)} older than the newest of all, "
            f"at most {length_text(self.max_skew_ns)} are allowed (max_skew_ms)"
        )
