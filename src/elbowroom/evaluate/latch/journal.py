"""What a gate that is killed had said of itself, and whether the latch on disk keeps to it."""

from collections.abc import Iterable
from dataclasses import dataclass, replace

from elbowroom.guard.fault import Fault
from elbowroom.guard.reason import Reason

BEGUN, FAULT, ASKED, RESET, REFUSED = "begun", "fault", "asked", "reset", "refused"
ENDING, ENDED = "ending", "ended"
"""Words of a journal: the gate has begun (before that nothing can move); a fault latched, and is on disk; a reset is
asked for, was done, was refused; the run ends, has ended."""


@dataclass(frozen=True, slots=True)
class Truth:
    """What is known to be latched.

    Args:
        latched: faults that are, or were until a reset that may have been done.
        has_begun: the gate said so, and so may have let something move.
        is_doubtful: a reset was asked for, and nobody heard whether it was done.
        is_ending: the run was asked to end.
        has_ended: it has.
    """

    latched: frozenset[Reason]
    has_begun: bool = False
    is_doubtful: bool = False
    is_ending: bool = False
    has_ended: bool = False

    def told(self, line: str) -> "Truth":
        """The same after a line of a journal.

        Raises:
            ValueError, KeyError: it is none.
        """
        word, _, what = line.partition(" ")
        if word == BEGUN:
            return replace(self, has_begun=True)
        if word == FAULT:
            return replace(self, latched=self.latched | {Reason[what]})
        if word == RESET:
            return replace(self, latched=frozenset(), is_doubtful=False)
        if word in (ASKED, REFUSED):
            return replace(self, is_doubtful=word == ASKED)
        if word in (ENDING, ENDED):
            return replace(self, is_ending=True, has_ended=word == ENDED)
        raise ValueError(f"{line}: is no line of a journal")


def truth_after(latched: Iterable[Fault], lines: Iterable[str]) -> Truth:
    """What is known after a run.

    Args:
        latched: what the latch held at its begin.
        lines: of its journal.
    """
    truth = Truth(frozenset(fault.reason for fault in latched))
    for line in lines:
        truth = truth.told(line)
    return truth


def is_kept(truth: Truth, kept: Iterable[Fault]) -> bool:
    """Whether the latch reads as latched wherever it may not read otherwise: after an end, or before a begin.

    Args:
        truth: what is known.
        kept: what was read.
    """
    moved_nothing = truth.is_ending or not truth.has_begun
    return bool(tuple(kept)) or (moved_nothing and not truth.latched)


def is_named(truth: Truth, kept: Iterable[Fault]) -> bool:
    """Whether each fault that had latched is named, unless a reset may have been done.

    Args:
        truth: what is known.
        kept: what was read.
    """
    return truth.is_doubtful or truth.latched <= {fault.reason for fault in kept}
