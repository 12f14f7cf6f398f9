"""When a run stops: what is kept of it is kept because of that."""

from dataclasses import dataclass, field

from elbowroom.monitor.face import Pass
from elbowroom.motion import Level

Kind = tuple[str, ...]
"""Of what stops: its name, and the names of what it is about."""


@dataclass(slots=True, eq=False)
class Stops:
    """Hears each pass, and says what has newly stopped. What stands stopped when a run begins is no news.

    What stops is the same for as long as it is of one kind and about the same thing: its words hold figures, which
    change with each pass.
    """

    _faults: frozenset[Kind] | None = field(default=None, init=False)
    _stopped: frozenset[str] = field(default=frozenset(), init=False)

    def hear(self, done: Pass) -> list[str]:
        """What stopped with this pass and moved, or might have, in the one before; a sentence each."""
        faults, stopped = _faults(done), _stopped(done)
        is_first, before = self._faults is None, self._faults or frozenset()
        news = [] if is_first else sorted(text for kind, text in faults.items() if kind not in before)
        new = [] if is_first or news else sorted(stopped - self._stopped)
        self._faults, self._stopped = frozenset(faults), stopped
        if new:
            news.append(f"{', '.join(new)}: stop")
        return news


def _faults(done: Pass) -> dict[Kind, str]:
    """Why all is stop, whatever the space is: by kind, and what it is about, in words."""
    found: dict[Kind, str]
    if done.decision is not None:
        both = (*done.decision.latched, *done.decision.active)
        found = {(fault.reason.name, fault.subject): fault.sentence for fault in both}
        return found
    result, found = done.result, {}
    if result.fault is not None:
        name = result.fault.split(":")[0]
        found["fault", name] = name
    if result.late is not None:
        found["late",] = result.late
    found |= {(each.cause.word, each.source): each.text for each in result.sick if each.stops}
    found |= {(each.kind, *each.about): each.text for each in result.findings if each.stops}
    if result.blind is not None:
        found["blind",] = result.blind
    if result.health is not None and result.health.reason is not None:
        found["watch",] = result.health.reason
    return found


def _stopped(done: Pass) -> frozenset[str]:
    """Names of what is stop; with a gate it is the machine that counts."""
    if done.decision is not None:
        return frozenset(("the machine",)) if done.decision.level is Level.STOP else frozenset()
    return frozenset(v.motion.name for v in done.result.verdicts if v.level is Level.STOP)
