"""How far a measured depth scatters: sigma over depth, per kind of sensor (docs/safety.md)."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from elbowroom.errors import CameraError


@dataclass(frozen=True, slots=True)
class NoiseModel:
    """Standard deviation of depth: sigma(z) = constant + linear z + quadratic max(z - offset, 0)^2  [m].

    It never falls with z, so the farthest point of a voxel bounds the sigma of all of it.

    Args:
        constant_m: at depth zero [m].
        linear: per metre of depth.
        quadratic: per square metre beyond `offset_m` [1/m].
        offset_m: where the quadratic part begins [m].

    Raises:
        CameraError: a coefficient below zero or not finite.
    """

    constant_m: float
    linear: float = 0.0
    quadratic: float = 0.0
    offset_m: float = 0.0

    def __post_init__(self) -> None:
        for name in ("constant_m", "linear", "quadratic", "offset_m"):
            value = getattr(self, name)
            if not (np.isfinite(value) and value >= 0):
                raise CameraError(f"noise: {name} is {value}, must be a finite number of at least 0")

    def sigma(self, depth_m: float | NDArray[np.floating]) -> NDArray[np.float64]:
        """Standard deviation at a depth [m], same shape as `depth_m`."""
        z = np.asarray(depth_m, dtype=float)
        return self.constant_m + self.linear * z + self.quadratic * np.maximum(z - self.offset_m, 0.0) ** 2


NOISE_PRESETS: dict[str, NoiseModel] = {
    # Nguyen, Izadi, Lovell 2012: axial noise of Kinect v1
    "kinect_v1": NoiseModel(0.0012, 0.0, 0.0019, 0.4),
    # the manual's bounds: standard deviation up to 17 mm within 3.5 m
    "azure_kinect": NoiseModel(0.017),
    # fits to a subpixel error of 0.08 px: 15, 34, 60 mm and 8, 19, 34 mm at 2, 3, 4 m
    "realsense_d435": NoiseModel(0.0, 0.0, 0.00378),
    "realsense_d455": NoiseModel(0.0, 0.0, 0.00213),
    # a time-of-flight camera of today, and the one that the simulated room uses
    "tof": NoiseModel(0.0015, 0.0, 0.00025),
}
"""Noise by the name of a sensor; sources in docs/safety.md."""
