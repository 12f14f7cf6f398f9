"""All that looks after cameras and machine while a run goes on, beside the cycle. Whatever fails in it is a stop."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

from elbowroom.finding import Finding
from elbowroom.monitor.health.drift.watch import Watch
from elbowroom.monitor.health.known import Known
from elbowroom.monitor.health.streams.cause import Sick
from elbowroom.monitor.health.streams.streams import Streams, without_sick
from elbowroom.monitor.stages import raise_interrupt, timed
from elbowroom.sensing import Snapshot


class Look(Protocol):
    """A look at what came in: whether it can be meant so."""

    @property
    def name(self) -> str:
        """In a word, for the table of stages."""

    def hear(self, snapshot: Snapshot) -> Sequence[Finding]:
        """What is found at this moment; what stays, it says again. It may raise: that is a fault, and a stop."""


@dataclass(frozen=True, slots=True, eq=False)
class Checks:
    """Hears each snapshot. What its watch found stays.

    Args:
        watch: over cameras and machine; None: nobody watches.
        max_age_ns: frames older than this are not heard [ns]; None: all are.
        unwatched: why nobody watches, in words; None: somebody does.
        looks: at what came in, before it is judged.
        first: looks at times and at the source itself: they see all that came, also of what is sick.
        streams: whether each source gives what it should; None: nobody looks.
    """

    watch: Watch | None = None
    max_age_ns: int | None = None
    unwatched: str | None = None
    looks: tuple[Look, ...] = ()
    first: tuple[Look, ...] = ()
    streams: Streams | None = None

    def hear(self, snapshot: Snapshot) -> Known:
        """What is known at this moment. It does not raise: a fault is a value."""
        stage_ms: dict[str, float] = {}
        health, findings, sick = None, list[Finding](), tuple[Sick, ...]()
        try:
            for look in self.first:
                findings += _told(look, snapshot, stage_ms)
            usable, well = snapshot, snapshot
            if self.streams is not None:
                with timed("streams", stage_ms):
                    sick = self.streams.hear(snapshot, findings)
                usable = self.streams.usable(snapshot)
                well = without_sick(usable, sick)
            for look in self.looks:
                findings += _told(look, well, stage_ms)
            if self.watch is not None:
                with timed("watch", stage_ms):
                    health = self.watch.hear(usable.fresh(self.max_age_ns))
                if self.streams is not None:
                    sick = self.streams.knowing(sick, health)
        except Exception as error:
            raise_interrupt(error)
            fault = f"{type(error).__name__}: {error}"
            return Known(None, fault, stage_ms, tuple(findings), sick)
        if self.streams is None:
            return Known(health, None, stage_ms, tuple(findings))
        is_placed, blind = self.streams.joints_usable, self.streams.blind(sick)
        return Known(health, None, stage_ms, tuple(findings), sick, is_placed, blind)


def _told(look: Look, snapshot: Snapshot, stage_ms: dict[str, float]) -> Sequence[Finding]:
    """What a look finds, and how long it took."""
    with timed(look.name, stage_ms):
        return look.hear(snapshot)
