"""What of a pass latches."""

from elbowroom.guard.fault import Fault
from elbowroom.guard.reason import Reason
from elbowroom.monitor.result import CycleResult


def faults_of(result: CycleResult) -> tuple[Fault, ...]:
    """Faults of a pass: it failed, came too late, had input that cannot be right, or the watch found something."""
    found = []
    if result.fault is not None:
        found.append(Fault(Reason.FAULT, "", result.fault))
    if result.late is not None:
        found.append(Fault(Reason.STALE, "", result.late))
    found += [
        Fault(Reason.INPUT, " ".join((finding.kind, *finding.about)), finding.text)
        for finding in result.findings
        if finding.stops
    ]
    stops = {} if result.health is None else result.health.stops
    return (*found, *(Fault(Reason.WATCH, subject, text) for subject, text in stops.items()))
