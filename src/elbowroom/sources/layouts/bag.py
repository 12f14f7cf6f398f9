"""Layout `bag`: images and joints in a bag of ROS 2; what lies near in time makes a moment."""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from elbowroom.errors import BagError, FrameError, JointsError, SiteError
from elbowroom.geometry import DepthCamera
from elbowroom.sensing import JointRecord
from elbowroom.site.recording_entry import BagRecording
from elbowroom.site.site import Site
from elbowroom.sources.bags.bag import Bag
from elbowroom.sources.bags.camera_infos import lens_by
from elbowroom.sources.bags.joints import Told, record_of, told_of
from elbowroom.sources.bags.messages import COMPRESSED, IMAGE, JOINT_STATE
from elbowroom.sources.bags.opened import opened
from elbowroom.sources.bags.stamps import Times, stamped
from elbowroom.sources.layouts.bag_image import Arrival, Message
from elbowroom.sources.layouts.bag_rows import Row, row_of
from elbowroom.sources.layouts.gathered import gathered, series_of
from elbowroom.sources.layouts.image import Image
from elbowroom.sources.room_clock import RoomClock
from elbowroom.sources.times.clock import ClockEstimate
from elbowroom.sources.times.joint_names import meant
from elbowroom.sources.times.joints import of_machine, require_span
from elbowroom.sources.times.meeting import Meeting
from elbowroom.sources.times.stamp import require_possible

DEPTH_TYPES = (IMAGE, COMPRESSED)
OTHER_FOCAL, OTHER_CENTRE_PX = 0.05, 5.0
"""A lens whose focal length is off by this share, or its centre by so many pixels, is another one."""


@dataclass(frozen=True, eq=False)
class BagFrames:
    """A recording of this layout (`Layout`).

    Args:
        site: that names it.
        recording: what the site says of it.
        path: of the bag.
    """

    site: Site
    recording: BagRecording
    path: Path

    def moments(self) -> list[list[Image]]:
        """Images gathered around those of the camera that has most: of each other the nearest, within `max_skew_ms`.

        Raises:
            SiteError: a camera without a topic, or an unknown one.
            BagError, FrameError: a bag, a topic or a message that cannot be it.
        """
        return gathered(self._rows, self.meeting)

    @cached_property
    def meeting(self) -> Meeting:
        """When each camera's images were taken, and who meets whom; raises as `moments`."""
        series = series_of(self._rows)
        if not any(map(len, series)):
            raise SiteError(f"{self.site.path}: recording: no depth image in {self.path}")
        return Meeting(series, round(self.recording.max_skew_ms * 1e6), True)

    def by_camera(self) -> dict[str, list[Image]]:
        """Each camera's images by rising time. Raises as `moments`."""
        return dict(self._rows)

    def arrivals(self) -> list[Arrival]:
        """All images by the time at which the recorder got them. Raises as `moments`."""
        found = [
            Arrival(image.stored.stored.received_ns, image)
            for row in self._rows.values()
            for image in row
            if isinstance(image.stored, Message)
        ]
        return sorted(found, key=lambda arrival: arrival.received_ns)

    def clocks(self) -> dict[str, ClockEstimate]:
        """What is known at the end of the bag of the clock of each camera that has stamps. Raises as `moments`."""
        room, arrivals = RoomClock(), self.arrivals()
        for received_ns, image in arrivals:
            if self.by_header(image.camera.name):
                room.hear(image.camera.name, received_ns, image.stamp_ns or 0)
        return dict(room.estimates(arrivals[-1].received_ns)) if arrivals else {}

    def by_header(self, camera: str) -> bool:
        """Whether a camera's times are those of exposure; otherwise, of receipt."""
        return self._times[camera].by_header

    @property
    def joints_path(self) -> Path:
        """The bag, by which joints are named."""
        return self.path

    @property
    def notes(self) -> tuple[str, ...]:
        """What is wrong with the bag and odd about its stamps; raises as `moments`."""
        told = [note for times in self._times.values() for note in times.notes]
        has_joints = self.site.entry.has_machine and self._has_told
        lenses = [self._lens_note(camera) for camera in self.site.cameras()]
        odd = [note for note in lenses if note is not None]
        alike = [note for row in self._taken.values() for note in row.notes]
        return (*self._bag.notes, *told, *alike, *odd, *(self._told.notes if has_joints else ()))

    def _lens_note(self, camera: DepthCamera) -> str | None:
        """That the bag says another lens than the site; None: it says the same, or none."""
        try:
            found = lens_by(self._bag, self.recording.topics[camera.name])
        except (BagError, FrameError):
            return None
        site, bag = camera.intrinsics, found.intrinsics
        off = max(abs(bag.fx / site.fx - 1), abs(bag.fy / site.fy - 1))
        centre = max(abs(bag.cx - site.cx), abs(bag.cy - site.cy))
        if off <= OTHER_FOCAL and centre <= OTHER_CENTRE_PX:
            return None
        return (
            f"camera {camera.name}: the bag's CameraInfo says fx {bag.fx:.5g}, fy {bag.fy:.5g}, cx {bag.cx:.5g}, cy "
            f"{bag.cy:.5g}, the site fx {site.fx:.5g}, fy {site.fy:.5g}, cx {site.cx:.5g}, cy {site.cy:.5g}: is it "
            "another camera, or another size?"
        )

    def joints(self) -> JointRecord | None:
        """The joints of the machine; None: there is none.

        Raises:
            BagError: a topic that is not there, or a malformed message.
            JointsError: a joint that nobody publishes, another machine's units, or never at the images' times.
        """
        machine = self.site.machine()
        if machine is None or not self._has_told:
            return None
        told = self._told
        for name in machine.joint_names:
            if name not in told.positions:
                raise JointsError(self._missing(name, told))
        names = list(machine.joint_names)
        record = record_of(told, names, round(self.recording.max_joint_gap_ms * 1e6))
        require_span(self.path, record, self.meeting, "do cameras and joints come from one clock?")
        return of_machine(self.site, machine, self.path, record, told.fell)

    @property
    def joint_arrivals(self) -> Mapping[str, NDArray[np.int64]]:
        """Of each topic of joints when its messages came and their stamps (`Told.arrivals`); raises as `joints`."""
        return self._told.arrivals if self.site.entry.has_machine and self._has_told else {}

    def joint_clocks(self) -> dict[str, ClockEstimate]:
        """What is known at the end of the bag of the clock of each topic of joints; raises as `joints`."""
        room, end_ns = RoomClock(), 0
        for topic, times in self.joint_arrivals.items():
            for received_ns, stamp_ns in times.tolist():
                room.hear(topic, received_ns, stamp_ns)
            end_ns = max(end_ns, int(times[-1, 0]))
        return dict(room.estimates(end_ns))

    @cached_property
    def _bag(self) -> Bag:
        return opened(self.path)

    @property
    def _has_told(self) -> bool:
        """Whether joints are looked for: where the machine was not there yet, only if a topic of them is."""
        topics = self.recording.joint_topics
        return not self.recording.without_machine or any(topic in self._bag.topics for topic in topics)

    @cached_property
    def _told(self) -> Told:
        return told_of(self._bag, self.recording.joint_topics)

    @cached_property
    def _times(self) -> dict[str, Times]:
        """By camera, when its messages are from."""
        names = [camera.name for camera in self.site.cameras()]
        for unknown in self.recording.topics.keys() - set(names):
            raise SiteError(
                f"{self.site.path}: recording.topics: unknown camera {unknown!r}; cameras are {', '.join(names)}"
            )
        for name in names:
            if name not in self.recording.topics:
                known = ", ".join(self._bag.of_type(*DEPTH_TYPES)) or "none"
                raise SiteError(
                    f"{self.site.path}: recording.topics: none for camera {name}; topics of images are {known}"
                )
        return {name: self._times_of(self.recording.topics[name]) for name in names}

    def _times_of(self, topic: str) -> Times:
        type_ = self._bag.require(topic).type
        if type_ not in DEPTH_TYPES:
            raise FrameError(f"{self.path}: {topic} is {type_}, must be {IMAGE} or {COMPRESSED}")
        return stamped(self._bag, topic)

    @cached_property
    def _taken(self) -> dict[str, Row]:
        topics = self.recording.topics
        return {
            camera.name: row_of(
                self.site, camera, self._bag, topics[camera.name], self._times[camera.name].messages
            )
            for camera in self.site.cameras()
        }

    @cached_property
    def _rows(self) -> dict[str, list[Image]]:
        rows = {name: row.images for name, row in self._taken.items()}
        stamps = {name: [image.stamp_ns or 0 for image in row] for name, row in rows.items()}
        require_possible(self.site.path, stamps, "ns", True)
        return rows

    def _missing(self, name: str, told: Told) -> str:
        said = ", ".join(told.positions) or "none with a position"
        others = set(self._bag.of_type(JOINT_STATE)) - set(self.recording.joint_topics)
        more = f"; other topics of joints: {', '.join(sorted(others))}" if others else ""
        return (
            f"{self.path}: no joint {name}{meant(name, told.positions)} in "
            f"{', '.join(self.recording.joint_topics)}; joints there are "
            f"{said}{more}"
        )
