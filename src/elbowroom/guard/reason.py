"""Why a motion is held back, as a number that receivers read."""

from enum import IntEnum


class Reason(IntEnum):
    """The numbers stay from one version to the next; a receiver takes one that it does not know for a fault.

    0 is never said, so that memory that nobody wrote is no reason. Below 16: what lies in the way, which latches
    nothing. From 16 on: what the gate itself says. From 32 on: faults, each of which latches; from 48
    on those of one camera, from 64 on those of the joints.
    """

    UNSAID = 0
    NONE = 1
    SURFACE = 2
    MACHINE = 3
    BLIND = 4
    OUTSIDE_GRID = 5
    UNSEEN = 6
    KEPT_OUT = 7
    OFF_PATH = 8
    STARTING = 16
    RISING = 17
    RESET_DUE = 18
    ENDED = 19
    JOINTS_STARTING = 20
    CAMERA_DOUBTED = 21
    FAULT = 32
    STALE = 33
    INPUT = 34
    WATCH = 35
    SILENCE = 36
    WATCHDOG = 37
    OUTPUT = 38
    LATCH_FILE = 39
    UNCLEAN_END = 40
    CLOCK = 41
    CAMERA_DISCONNECTED = 48
    CAMERA_GAPS = 49
    CAMERA_DAMAGED = 50
    CAMERA_WRONG_SIZE = 51
    CAMERA_CLOCK = 52
    CAMERA_FROZEN = 53
    CAMERA_SWAPPED = 54
    CAMERA_WRONG_SCALE = 55
    CAMERA_WRONG_ENCODING = 56
    CAMERA_COVERED = 57
    CAMERA_PARTLY_COVERED = 58
    CAMERA_TOO_OLD = 59
    CAMERA_MOVED = 60
    JOINTS_MISSING = 64
    JOINTS_BEYOND = 65
    JOINTS_IMPLAUSIBLE = 66
    JOINTS_FROZEN = 67

    @property
    def sentence(self) -> str:
        """What an operator reads."""
        return _SENTENCES[self]

    @property
    def is_fault(self) -> bool:
        """Whether it latches."""
        return self >= Reason.FAULT

    @property
    def leaves_doubt(self) -> bool:
        """Whether, while it is there, nothing that was judged of the machine and the space can be relied on."""
        return self.is_fault and self not in _BESIDE and not self.is_of_camera

    @property
    def is_of_camera(self) -> bool:
        """Whether one camera is sick. It is left out, so that what was judged holds without it."""
        return Reason.CAMERA_DISCONNECTED <= self <= Reason.CAMERA_MOVED


_BESIDE = frozenset({Reason.WATCHDOG, Reason.OUTPUT, Reason.LATCH_FILE, Reason.UNCLEAN_END})
"""Faults of what carries the word, not of what it is made of."""
_SENTENCES = {
    Reason.UNSAID: "nothing was said",
    Reason.NONE: "nothing holds it back",
    Reason.SURFACE: "something was seen in the way",
    Reason.MACHINE: "another part of the machine is in the way",
    Reason.BLIND: "a camera that looks at the way delivers nothing valid",
    Reason.OUTSIDE_GRID: "the way leaves the watched space",
    Reason.UNSEEN: "nobody sees the way",
    Reason.KEPT_OUT: "a zone that the machine is kept out of is in the way",
    Reason.OFF_PATH: "the machine is not where the path that it means to take begins",
    Reason.STARTING: "nothing has been judged yet",
    Reason.RISING: "speed rises slowly",
    Reason.RESET_DUE: "a fault is over and waits for a person to reset",
    Reason.ENDED: "the monitor has ended",
    Reason.FAULT: "the monitor failed",
    Reason.STALE: "what was seen is too old by now",
    Reason.INPUT: "what came in cannot be right",
    Reason.WATCH: "a camera or the machine is not where it should be",
    Reason.SILENCE: "no pass was finished in time",
    Reason.WATCHDOG: "the watchdog ended or does not answer",
    Reason.OUTPUT: "an output does not work",
    Reason.LATCH_FILE: "the latch on disk cannot be kept or read",
    Reason.UNCLEAN_END: "the monitor ended last time without being asked to",
    Reason.CLOCK: "the monitor's clock went back",
    Reason.JOINTS_STARTING: "where the machine is has not been said yet",
    Reason.CAMERA_DOUBTED: "a camera may be elsewhere than where it was commissioned",
    Reason.CAMERA_DISCONNECTED: "a camera gives no images any more",
    Reason.CAMERA_GAPS: "a camera loses images",
    Reason.CAMERA_DAMAGED: "a camera's images cannot be read",
    Reason.CAMERA_WRONG_SIZE: "a camera's images are of another size",
    Reason.CAMERA_CLOCK: "a camera's clock jumped",
    Reason.CAMERA_FROZEN: "a camera gives the same image again and again",
    Reason.CAMERA_SWAPPED: "a camera shows what another one should",
    Reason.CAMERA_WRONG_SCALE: "a camera's depths are off by one factor",
    Reason.CAMERA_WRONG_ENCODING: "a camera's images are no depths, or of another kind",
    Reason.CAMERA_COVERED: "a camera is covered",
    Reason.CAMERA_PARTLY_COVERED: "a camera is partly covered",
    Reason.CAMERA_TOO_OLD: "a camera's images come too late",
    Reason.CAMERA_MOVED: "a camera is not where it was commissioned",
    Reason.JOINTS_MISSING: "where the machine is is not said any more",
    Reason.JOINTS_BEYOND: "a joint is said to be beyond its limits",
    Reason.JOINTS_IMPLAUSIBLE: "a joint is said to be where it cannot be",
    Reason.JOINTS_FROZEN: "joint positions stand still though the machine moves, or their times do",
}
