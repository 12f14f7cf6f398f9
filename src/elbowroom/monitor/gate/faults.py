"""What of a pass latches."""

from collections.abc import Mapping

from elbowroom.guard.fault import Fault
from elbowroom.guard.reason import Reason
from elbowroom.monitor.health.streams.cause import HealthCause
from elbowroom.monitor.result import CycleResult


def faults_of(result: CycleResult) -> tuple[Fault, ...]:
    """Faults of a pass: a sick source, a failure, too late, input that cannot be right, what the watch found."""
    found = [Fault(sick.cause.value, sick.source, sick.text) for sick in result.sick if sick.latches]
    if result.fault is not None:
        found.append(Fault(Reason.FAULT, "", result.fault))
    if result.late is not None:
        found.append(Fault(Reason.STALE, "", result.late))
    found += [
        Fault(Reason.INPUT, " ".join((finding.kind, *finding.about)), finding.text)
        for finding in result.findings
        if finding.stops
    ]
    stops: Mapping[str, str] = {} if result.health is None else result.health.stops
    told = {sick.source for sick in result.sick if sick.cause is HealthCause.CAMERA_MOVED}
    watched = [(subject, text) for subject, text in stops.items() if subject not in told]
    return (*found, *(Fault(Reason.WATCH, subject, text) for subject, text in watched))
