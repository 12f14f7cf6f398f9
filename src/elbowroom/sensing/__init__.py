"""What cameras deliver: frames, their noise and margins, distorted images made pinhole, joints over time."""

from elbowroom.geometry.margin import Margin
from elbowroom.geometry.noise import NOISE_PRESETS, NoiseModel
from elbowroom.sensing.frame import DepthFrame
from elbowroom.sensing.joints import JointRecord
from elbowroom.sensing.meant import MeantPath, MeantPaths
from elbowroom.sensing.rectify import rectified, rectify
from elbowroom.sensing.snapshot import Snapshot

__all__ = [
    "NOISE_PRESETS",
    "DepthFrame",
    "JointRecord",
    "Margin",
    "MeantPath",
    "MeantPaths",
    "NoiseModel",
    "Snapshot",
    "rectified",
    "rectify",
]
