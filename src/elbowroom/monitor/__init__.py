"""The running system: snapshots in, verdicts out to every face; cameras and machine are looked after meanwhile."""

from elbowroom.monitor.cycle import Cycle
from elbowroom.monitor.face import Face, Pass
from elbowroom.monitor.gate.gate import Gate
from elbowroom.monitor.gate.state import Decision
from elbowroom.monitor.health.checks import Checks
from elbowroom.monitor.health.drift.reference import CameraReference
from elbowroom.monitor.health.drift.reference_file import load_references, save_references
from elbowroom.monitor.health.drift.shift import Shift
from elbowroom.monitor.health.drift.tolerance import Tolerance
from elbowroom.monitor.health.drift.watch import Watch
from elbowroom.monitor.health.health import CameraHealth, Condition, Health, LinkHealth
from elbowroom.monitor.health.known import Known
from elbowroom.monitor.loop import Loop
from elbowroom.monitor.result import CycleResult

__all__ = [
    "CameraHealth",
    "CameraReference",
    "Checks",
    "Condition",
    "Cycle",
    "CycleResult",
    "Decision",
    "Face",
    "Gate",
    "Health",
    "Known",
    "LinkHealth",
    "Loop",
    "Pass",
    "Shift",
    "Tolerance",
    "Watch",
    "load_references",
    "save_references",
]
