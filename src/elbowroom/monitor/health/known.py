"""What is known of cameras and machine beside what they see."""

from collections.abc import Mapping
from dataclasses import dataclass, field

from elbowroom.finding import Finding
from elbowroom.monitor.health.health import Health
from elbowroom.monitor.health.streams.cause import Sick
from elbowroom.motion import Cause


@dataclass(frozen=True, slots=True, eq=False)
class Known:
    """What the checks came to at one moment.

    Args:
        health: of cameras and machine; None: nobody watches, or the checks failed.
        fault: why nothing is known, one sentence; None: nothing failed.
        stage_ms: time that each check took [ms].
        findings: what the looks at the input found, those that stop and those that warn.
        sick: what is wrong with which source; a camera of it is left out, and sick joints stop.
        is_placed: whether the machine can be where it is said to be; else no pass can be made.
        blind: that no camera gives anything that counts, so that every motion is stop, one sentence; None: one does.
    """

    health: Health | None = None
    fault: str | None = None
    stage_ms: Mapping[str, float] = field(default_factory=dict)
    findings: tuple[Finding, ...] = ()
    sick: tuple[Sick, ...] = ()
    is_placed: bool = True
    blind: str | None = None

    @property
    def stop_cause(self) -> Cause | None:
        """Why every motion is stop: a fault, input that cannot be right, no camera, what the watch found; None:
        none.
        """
        if self.fault is not None:
            return Cause.FAULT
        if any(finding.stops for finding in self.findings) or any(each.stops for each in self.sick):
            return Cause.INPUT
        if self.blind is not None:
            return Cause.BLIND
        return Cause.WATCH if self.health is not None and self.health.reason is not None else None
