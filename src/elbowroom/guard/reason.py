"""Why a motion is held back, as a number that receivers read."""

from enum import IntEnum


class Reason(IntEnum):
    """The numbers stay from one version to the next; a receiver takes one that it does not know for a fault.

    0 is never said, so that memory that nobody wrote is no reason. Below 16: what lies in the way, which latches
    nothing. From 16 on: what the gate itself says. From 32 on: faults, each of which latches.
    """

    UNSAID = 0
    NONE = 1
    SURFACE = 2
    MACHINE = 3
    BLIND = 4
    OUTSIDE_GRID = 5
    UNSEEN = 6
    KEPT_OUT = 7
    STARTING = 16
    RISING = 17
    RESET_DUE = 18
    ENDED = 19
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
        return self.is_fault and self not in _BESIDE


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
}
