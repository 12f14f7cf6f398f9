"""From frames to evidence to free space: pyramid, carve, merge, resolve."""

from elbowroom.reconstruct.carve import DETAILS, Detail, carve
from elbowroom.reconstruct.evidence import Evidence, merge
from elbowroom.reconstruct.free_space import FreeSpace
from elbowroom.reconstruct.point_report import PointReport, Sight
from elbowroom.reconstruct.reconstruct import reconstruct
from elbowroom.reconstruct.resolve import LAWFUL, RULES, Rule, resolve
from elbowroom.reconstruct.warm_up import warm_up

__all__ = [
    "DETAILS",
    "LAWFUL",
    "RULES",
    "Detail",
    "Evidence",
    "FreeSpace",
    "PointReport",
    "Rule",
    "Sight",
    "carve",
    "merge",
    "reconstruct",
    "resolve",
    "warm_up",
]
