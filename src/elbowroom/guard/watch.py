"""What the watchdog makes of heartbeats and of time: what outputs say. Values, and no clock."""

from dataclasses import dataclass, replace

from elbowroom.guard.heartbeat import PHASES, Heartbeat, Word
from elbowroom.guard.reason import Reason

MOST_AGE_MS = 65535


@dataclass(frozen=True, slots=True)
class Said:
    """What an output says at one moment.

    Args:
        sequence: of the last pass; 0: none was finished yet, or it was the first.
        age_ms: how long ago it was finished, at most 65535 [ms].
        phase: number in `PHASES`.
        machine: what may be done whatever moves.
        motions: what each motion may do, in the order of the site.
    """

    sequence: int
    age_ms: int
    phase: int
    machine: Word
    motions: tuple[Word, ...]


@dataclass(frozen=True, slots=True)
class Watched:
    """All that the watchdog remembers.

    Args:
        count: how many motions there are.
        heartbeat: the last one; None: none came.
        trips: how often it found silence; until the gate has said that it knows of all of them, outputs say stop.
        is_silent: whether it is silent now.
        ended: that no heartbeat can come any more, and why; None: one may.
        broken: an output that does not work, and why; None: all do.
    """

    count: int
    heartbeat: Heartbeat | None = None
    trips: int = 0
    is_silent: bool = False
    ended: str | None = None
    broken: str | None = None

    def hearing(self, heartbeat: Heartbeat) -> "Watched":
        """The same once a heartbeat came; an old or a second one of the same pass is none."""
        last = self.heartbeat
        if last is not None and heartbeat.sequence <= last.sequence:
            return self
        if len(heartbeat.motions) != self.count:
            return self
        return replace(self, heartbeat=heartbeat)

    def looking(self, now_ns: int) -> "Watched":
        """The same with what time has come to: a trip where silence began."""
        is_over = self.heartbeat is not None and self.heartbeat.is_last
        is_silent = not is_over and (self.ended is not None or self._is_late(now_ns))
        return replace(self, is_silent=is_silent, trips=self.trips + (is_silent and not self.is_silent))

    def said(self, now_ns: int) -> Said:
        """What outputs say at a moment; all but a young, known heartbeat is stop.

        Args:
            now_ns: the moment [ns, the clock of the heartbeats].
        """
        heartbeat = self.heartbeat
        if heartbeat is None:
            reason = Reason.STARTING if self.ended is None else Reason.SILENCE
            return self._stop(0, MOST_AGE_MS, reason)
        age_ms = min(MOST_AGE_MS, max(0, (now_ns - heartbeat.finished_ns) // 1_000_000))
        if heartbeat.is_last:
            return Said(heartbeat.sequence, age_ms, heartbeat.phase, heartbeat.machine, heartbeat.motions)
        is_known = heartbeat.trips_known >= self.trips
        if self.ended is not None or self._is_late(now_ns) or self.is_silent or not is_known:
            return self._stop(heartbeat.sequence, age_ms, Reason.SILENCE)
        if self.broken is not None:
            return self._stop(heartbeat.sequence, age_ms, Reason.OUTPUT)
        let_go = now_ns > heartbeat.held_until_ns
        words = tuple(_let_go(word) if word.held and let_go else word for word in heartbeat.motions)
        return Said(heartbeat.sequence, age_ms, heartbeat.phase, heartbeat.machine, words)

    def _is_late(self, now_ns: int) -> bool:
        """Whether two deadlines went by; a heartbeat of the future is none."""
        if self.heartbeat is None:
            return False
        age_ns = now_ns - self.heartbeat.finished_ns
        return not -self.heartbeat.deadline_ns <= age_ns <= 2 * self.heartbeat.deadline_ns

    def _stop(self, sequence: int, age_ms: int, reason: Reason) -> Said:
        phase = PHASES.index("starting" if reason is Reason.STARTING else "silent")
        word = Word.stop(reason)
        return Said(sequence, age_ms, phase, word, (word,) * self.count)


def _let_go(word: Word) -> Word:
    """What is left of a word that needs a person to hold on once nobody does."""
    return Word(0, 0, word.reason, False, word.escapes)
