"""All that looks after cameras and machine while a run goes on, beside the cycle. Whatever fails in it is a stop."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

from elbowroom.finding import Finding
from elbowroom.monitor.health.drift.watch import Watch
from elbowroom.monitor.health.known import Known
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
    """

    watch: Watch | None = None
    max_age_ns: int | None = None
    unwatched: str | None = None
    looks: tuple[Look, ...] = ()

    def hear(self, snapshot: Snapshot) -> Known:
        """What is known at this moment. It does not raise: a fault is a value."""
        stage_ms: dict[str, float] = {}
        health, findings = None, list[Finding]()
        try:
            for look in self.looks:
                with timed(look.name, stage_ms):
                    findings += look.hear(snapshot)
            if self.watch is not None:
                with timed("watch", stage_ms):
                    health = self.watch.hear(snapshot.fresh(self.max_age_ns))
        except Exception as error:
            raise_interrupt(error)
            return Known(None, f"{type(error).__name__}: {error}", stage_ms, tuple(findings))
        return Known(health, None, stage_ms, tuple(findings))
