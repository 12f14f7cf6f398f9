"""The pass that is done many times a second: newest frames in, verdicts out."""

from elbowroom.monitor.cycle import Cycle
from elbowroom.monitor.result import CycleResult

__all__ = ["Cycle", "CycleResult"]
