"""What cameras deliver: frames, their noise and margins, recordings on disk."""

from elbowroom.geometry.margin import Margin
from elbowroom.geometry.noise import NOISE_PRESETS, NoiseModel
from elbowroom.sensing.frame import DepthFrame

__all__ = ["NOISE_PRESETS", "DepthFrame", "Margin", "NoiseModel"]
