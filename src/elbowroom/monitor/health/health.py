"""Whether cameras and machine are where they are said to be: values, in words that an operator reads.

How conditions combine: the first that stops decides, and it stays. While it stays every motion is stop.

| condition | means | stops |
|---|---|---|
| STILL | the camera's reference fits | no |
| UNSURE | too little of its reference is in view, or none of the tests has decided | no |
| HIDDEN | something nearer, or no return, hides most of its reference | after 60 s: its view is disputed anyway |
| MOVED | its reference fits after a turn or a move | yes |
| CHANGED | much of its reference is gone, and what is behind is seen: a large turn, or the room was rebuilt | yes |
| COVERED | something hides nearly all of its reference | after 5 s |
| BLIND | hardly any pixel of its reference has a return | after 1 s |
| SILENT | it gave no new image | after 2 s |
"""

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import Enum

from elbowroom.monitor.health.drift.shift import Shift


class Condition(Enum):
    """Of a camera; the value is what an operator reads after its name."""

    STILL = "stands where it was commissioned"
    UNSURE = "shows too little of its reference"
    HIDDEN = "is mostly hidden"
    MOVED = "has moved"
    CHANGED = "no longer sees what it was commissioned on"
    COVERED = "is covered"
    BLIND = "gives no returns"
    SILENT = "gives no new image"

    @property
    def stops(self) -> bool:
        """Whether nothing may move once a camera is found so, some of them for a while."""
        return self not in (Condition.STILL, Condition.UNSURE)


@dataclass(frozen=True, slots=True, eq=False)
class CameraHealth:
    """One camera at one moment.

    Args:
        camera: its name.
        condition: what its newest frame says; what tests have decided goes before.
        shift: by how much it seems to have moved; None: its reference is not in view.
        share_seen: of its reference, how much is in view and near where it should be.
        share_hidden: of its reference, before how much there is something nearer, or no return; 1 where it is silent.
        doubt: why it may be elsewhere, after its name, though no test has decided that; None: nothing says so.
        shows: the camera on whose reference its image lies though not on its own, so that the two were exchanged;
            None: none.
    """

    camera: str
    condition: Condition
    shift: Shift | None
    share_seen: float
    share_hidden: float
    doubt: str | None = None
    shows: str | None = None


@dataclass(frozen=True, slots=True, eq=False)
class LinkHealth:
    """One link of the machine at one moment.

    Args:
        link: its name.
        off_m: how far its surface is from where the joints say, on average over what is seen [m].
        cameras: names of those whose images say so, or would see it.
        is_off: whether this moment says that it is not where the joints say; None: it cannot tell.
    """

    link: str
    off_m: float
    cameras: tuple[str, ...]
    is_off: bool | None


@dataclass(frozen=True, slots=True, eq=False)
class Health:
    """All that is watched at one moment.

    Args:
        cameras: those that have a reference, in the room's order.
        links: those of the machine that some camera sees.
        stops: why nothing may move, by camera or link, in the order in which it was found; what is found stays
            until the watch is made anew.
    """

    cameras: tuple[CameraHealth, ...]
    links: tuple[LinkHealth, ...] = ()
    stops: Mapping[str, str] = field(default_factory=dict)

    @property
    def reason(self) -> str | None:
        """Why every motion is stop, one sentence; None: nothing was found."""
        return "; ".join(self.stops.values()) or None

    @property
    def worst(self) -> CameraHealth | None:
        """The camera that seems to have moved most, counting a degree as 2 cm; None: none can be told."""
        told = [camera for camera in self.cameras if camera.shift is not None]
        return max(told, key=_size, default=None)

    def count(self, condition: Condition) -> int:
        """How many cameras are in a condition."""
        return sum(camera.condition is condition for camera in self.cameras)


def _size(camera: CameraHealth) -> float:
    return 0.0 if camera.shift is None else camera.shift.turn_deg * 20 + camera.shift.move_mm
