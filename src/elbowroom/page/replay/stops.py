"""Where a recorded run stopped: marks on its time."""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from elbowroom.errors import BagError
from elbowroom.monitor.blackbox.recording import Recording
from elbowroom.page.story.phrases import name_of


@dataclass(frozen=True, slots=True)
class Stop:
    """A moment at which something newly stops.

    Args:
        index: of its pass in the file, from 0.
        sequence: of its pass in the run.
        wall_ns: when, by the computer's calendar [ns].
        motions: names of what stops; none: everything does, or the gate.
        text: what was reported; empty: nothing but the verdicts.
    """

    index: int
    sequence: int
    wall_ns: int
    motions: tuple[str, ...]
    text: str = ""


def stops_of(recording: Recording, tell: Callable[[int], None] = lambda done: None) -> Iterator[Stop]:
    """The stops of a recording; what stands stopped when it begins is none. Where it cannot be read, they end.

    Args:
        recording: the file.
        tell: told how many passes have been looked at.
    """
    faults: frozenset[str] | None = None
    stopped: frozenset[str] = frozenset()
    for index in range(len(recording)):
        try:
            said = recording.said_at(index)
            now_faults, now_stopped = _faults(said), _stopped(said)
        except (BagError, KeyError, TypeError):
            return
        new_faults = sorted(now_faults - (faults or frozenset()))
        new = sorted(now_stopped - stopped)
        if faults is not None and (new_faults or new):
            text = "; ".join(new_faults)
            motions = () if new_faults else tuple(new)
            yield Stop(index, said["sequence"], said["wall_ns"], motions, text)
        faults, stopped = now_faults, now_stopped
        tell(index + 1)


def _faults(said: Mapping[str, Any]) -> frozenset[str]:
    """Why all is stop, whatever the space is: what the gate holds, or the head of what was reported."""
    gate = said["gate"]
    if gate is not None:
        return frozenset(fault["text"] for fault in (*gate["latched"], *gate["active"]))
    by = said["judged"]["stopped_by"]
    return frozenset() if by is None else frozenset((by.partition(":")[0],))


def _stopped(said: Mapping[str, Any]) -> frozenset[str]:
    """Names of what is stop; with a gate that lets nothing move, the motions that are."""
    gate = said["gate"]
    if gate is not None and gate["level"] != "stop":
        return frozenset()
    rows = said["judged"]["verdicts"]
    return frozenset(name_of(row) for row in rows if row["level"] == "stop")
