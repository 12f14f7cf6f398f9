"""From frames to evidence to free space: pyramid, carve, merge, resolve."""

from elbowroom.choices import DETAILS, LAWFUL, RULES, Detail, Rule
from elbowroom.reconstruct.carve import carve
from elbowroom.reconstruct.evidence import Evidence, merge
from elbowroom.reconstruct.free_space import FreeSpace
from elbowroom.reconstruct.point_report import PointReport, Sight
from elbowroom.reconstruct.reconstruct import free_space_of, reconstruct
from elbowroom.reconstruct.resolve import resolve
from elbowroom.reconstruct.terms import Terms
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
    "Terms",
    "carve",
    "free_space_of",
    "merge",
    "reconstruct",
    "resolve",
    "warm_up",
]
