"""The pass that is done many times a second: newest frames in, verdicts out; and the watch over cameras and machine."""

from elbowroom.monitor.cycle import Cycle
from elbowroom.monitor.health import CameraHealth, Condition, Health, LinkHealth
from elbowroom.monitor.reference import CameraReference
from elbowroom.monitor.reference_file import load_references, save_references
from elbowroom.monitor.result import CycleResult
from elbowroom.monitor.shift import Shift
from elbowroom.monitor.tolerance import Tolerance
from elbowroom.monitor.watch import Watch

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
