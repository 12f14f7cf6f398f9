"""Motions checked against free space: how far, how urgent, and why."""

from elbowroom.motion.braking import Braking, braking_distance
from elbowroom.motion.braking_volume import check_moving, check_stop
from elbowroom.motion.check import check_motion, check_motions, joint_motions
from elbowroom.motion.creep import Override, with_creep
from elbowroom.motion.distances import Distances, LinkDistances, Nearest, link_distances
from elbowroom.motion.focus import blocks_in_reach
from elbowroom.motion.meant import asked_of, check_rest, rest_of, with_path
from elbowroom.motion.motion import JointPath, Motion
from elbowroom.motion.path import Blocked, PathVerdict, check_path, longest_safe_prefix
from elbowroom.motion.path_file import read_path
from elbowroom.motion.speed import machine_speed
from elbowroom.motion.trajectory import MachineState, Trajectory
from elbowroom.motion.verdict import Cause, Creep, Level, Verdict, most_cautious

__all__ = [
    "Blocked",
    "Braking",
    "Cause",
    "Creep",
    "Distances",
    "JointPath",
    "Level",
    "LinkDistances",
    "MachineState",
    "Motion",
    "Nearest",
    "Override",
    "PathVerdict",
    "Trajectory",
    "Verdict",
    "asked_of",
    "blocks_in_reach",
    "braking_distance",
    "check_motion",
    "check_motions",
    "check_moving",
    "check_path",
    "check_rest",
    "check_stop",
    "joint_motions",
    "link_distances",
    "longest_safe_prefix",
    "machine_speed",
    "most_cautious",
    "read_path",
    "rest_of",
    "with_creep",
    "with_path",
]
