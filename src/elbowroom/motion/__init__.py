"""Motions checked against free space: how far, how urgent, and why."""

from elbowroom.motion.braking import braking_distance
from elbowroom.motion.check import check_motion, check_motions, joint_motions
from elbowroom.motion.creep import Override, with_creep
from elbowroom.motion.distances import Distances, LinkDistances, Nearest, link_distances
from elbowroom.motion.focus import blocks_in_reach
from elbowroom.motion.motion import JointPath, Motion
from elbowroom.motion.verdict import Cause, Creep, Level, Verdict, most_cautious

__all__ = [
    "Cause",
    "Creep",
    "Distances",
    "JointPath",
    "Level",
    "LinkDistances",
    "Motion",
    "Nearest",
    "Override",
    "Verdict",
    "blocks_in_reach",
    "braking_distance",
    "check_motion",
    "check_motions",
    "joint_motions",
    "link_distances",
    "most_cautious",
    "with_creep",
]
