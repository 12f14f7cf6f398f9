"""The pass that is done many times a second: newest frames in, verdicts out; and the watch over cameras and machine."""

from elbowroom.monitor.cycle import Cycle
from elbowroom.monitor.health.drift.reference import CameraReference
from elbowroom.monitor.health.drift.reference_file import load_references, save_references
from elbowroom.monitor.health.drift.shift import Shift
from elbowroom.monitor.health.drift.tolerance import Tolerance
from elbowroom.monitor.health.drift.watch import Watch
from elbowroom.monitor.health.health import CameraHealth, Condition, Health, LinkHealth
from elbowroom.monitor.result import CycleResult

__all__ = [
    "CameraHealth",
    "CameraReference",
    "Condition",
    "Cycle",
    "CycleResult",
    "Health",
    "LinkHealth",
    "Shift",
    "Tolerance",
    "Watch",
    "load_references",
    "save_references",
]
