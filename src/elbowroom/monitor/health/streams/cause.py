"""What may be wrong with a source, by name, and what is said of it while it is."""

from dataclasses import dataclass
from enum import Enum

from elbowroom.guard.reason import Reason


class HealthCause(Enum):
    """A named cause for which a camera is left out, or for which the machine stops; the value is its number for a PLC.

    Of two that are there at once the first of this list is said first.
    """

    CAMERA_STARTING = Reason.STARTING
    CAMERA_DISCONNECTED = Reason.CAMERA_DISCONNECTED
    CAMERA_GAPS = Reason.CAMERA_GAPS
    CAMERA_DAMAGED = Reason.CAMERA_DAMAGED
    CAMERA_WRONG_SIZE = Reason.CAMERA_WRONG_SIZE
    CAMERA_CLOCK = Reason.CAMERA_CLOCK
    CAMERA_FROZEN = Reason.CAMERA_FROZEN
    CAMERA_SWAPPED = Reason.CAMERA_SWAPPED
    CAMERA_WRONG_SCALE = Reason.CAMERA_WRONG_SCALE
    CAMERA_WRONG_ENCODING = Reason.CAMERA_WRONG_ENCODING
    CAMERA_COVERED = Reason.CAMERA_COVERED
    CAMERA_PARTLY_COVERED = Reason.CAMERA_PARTLY_COVERED
    CAMERA_TOO_OLD = Reason.CAMERA_TOO_OLD
    CAMERA_MOVED = Reason.CAMERA_MOVED
    CAMERA_DOUBTED = Reason.CAMERA_DOUBTED
    JOINTS_STARTING = Reason.JOINTS_STARTING
    JOINTS_MISSING = Reason.JOINTS_MISSING
    JOINTS_BEYOND = Reason.JOINTS_BEYOND
    JOINTS_IMPLAUSIBLE = Reason.JOINTS_IMPLAUSIBLE
    JOINTS_FROZEN = Reason.JOINTS_FROZEN

    __hash__ = object.__hash__
    """Members are one each: a hash of the name, as enumerations have it, is work in Python at each look-up."""

    @property
    def is_of_camera(self) -> bool:
        """Whether it is about a camera, which is left out; one about joints stops every motion."""
        return self.name.startswith("CAMERA_")

    @property
    def word(self) -> str:
        """As rows, site files and operators have it: "partly_covered"."""
        return self.name.split("_", 1)[1].lower()

    @property
    def latches(self) -> bool:
        """Whether a gate keeps it until a person resets."""
        return self.value.is_fault


CAMERA_WORDS = tuple(cause.word for cause in HealthCause if cause.is_of_camera and cause.latches)
"""What a site may name."""


@dataclass(frozen=True, slots=True)
class Sick:
    """One thing that is wrong with one source now.

    Args:
        cause: its name.
        source: of the camera; "joints" of the machine's joints.
        text: what was found, one sentence, in numbers.
        clears: which evidence ends it, in words.
        lasts_s: for how long it has been there [s].
        tolerated: the site says that the machine may go on without this camera, so that nothing latches.
    """

    cause: HealthCause
    source: str
    text: str
    clears: str
    lasts_s: float = 0.0
    tolerated: bool = False

    @property
    def latches(self) -> bool:
        """Whether a gate keeps it until a person resets."""
        return self.cause.latches and not self.tolerated

    @property
    def leaves_out(self) -> bool:
        """Whether the camera's frame is taken as missing."""
        return self.cause.is_of_camera

    @property
    def stops(self) -> bool:
        """Whether every motion is stop, whatever the space is."""
        return not self.cause.is_of_camera
