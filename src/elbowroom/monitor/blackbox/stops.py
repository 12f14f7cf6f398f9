"""When a run stops: what is kept of it is kept because of that."""

from dataclasses import dataclass, field

from elbowroom.monitor.face import Pass
from elbowroom.motion import Level


@dataclass(slots=True, eq=False)
class Stops:
    """Hears each pass, and says what has newly stopped. What stands stopped when a run begins is no news."""

    _faults: frozenset[str] | None = field(default=None, init=False)
    _stopped: frozenset[str] = field(default=frozenset(), init=False)

    def hear(self, done: Pass) -> list[str]:
        """What stopped with this pass and moved, or might have, in the one before; a sentence each."""
        faults, stopped = _faults(done), _stopped(done)
        is_first = self._faults is None
        news = [] if is_first else sorted(faults - (self._faults or frozenset()))
        new = [] if is_first or news else sorted(stopped - self._stopped)
        self._faults, self._stopped = faults, stopped
        if new:
            news.append(f"{', '.join(new)}: stop")
        return news


def _faults(done: Pass) -> frozenset[str]:
    """Why all is stop, whatever the space is."""
    if done.decision is not None:
        return frozenset(fault.sentence for fault in (*done.decision.latched, *done.decision.active))
    return (
        frozenset() if done.result.stopped_by is None else frozenset((done.result.stopped_by.split(":")[0],))
    )


def _stopped(done: Pass) -> frozenset[str]:
    """Names of what is stop; with a gate it is the machine that counts."""
    if done.decision is not None:
        return frozenset(("the machine",)) if done.decision.level is Level.STOP else frozenset()
    return frozenset(v.motion.name for v in done.result.verdicts if v.level is Level.STOP)
