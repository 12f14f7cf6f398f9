"""All that looks after cameras and machine while a run goes on, beside the cycle. Whatever fails in it is a stop."""

from dataclasses import dataclass

from elbowroom.monitor.health.drift.watch import Watch
from elbowroom.monitor.health.known import Known
from elbowroom.monitor.stages import timed
from elbowroom.sensing import Snapshot


@dataclass(frozen=True, slots=True, eq=False)
class Checks:
    """Hears each snapshot. What its watch found stays.

    Args:
        watch: over cameras and machine; None: nobody watches.
        max_age_ns: frames older than this are not heard [ns]; None: all are.
        unwatched: why nobody watches, in words; None: somebody does.
    """

    watch: Watch | None = None
    max_age_ns: int | None = None
    unwatched: str | None = None

    def hear(self, snapshot: Snapshot) -> Known:
        """What is known at this moment. It does not raise: a fault is a value."""
        if self.watch is None:
            return Known()
        stage_ms: dict[str, float] = {}
        try:
            with timed("watch", stage_ms):
                health = self.watch.hear(snapshot.fresh(self.max_age_ns))
        except Exception as error:
            return Known(None, f"{type(error).__name__}: {error}", stage_ms)
        return Known(health, None, stage_ms)
