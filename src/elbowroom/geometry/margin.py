"""How far a measurement is not trusted: along the ray and across it."""

from dataclasses import dataclass

import numpy as np

from elbowroom.errors import CameraError


@dataclass(frozen=True, slots=True)
class Margin:
    """A pixel's depth is trusted to sigmas * sigma(z) + bias + range error; its direction to `lateral_px`.

    Args:
        sigmas: k in k sigma(z).
        bias_m: constant part: sensor bias and calibration error of position [m].
        range_linear: part that grows with depth, as of a scale error [m per m].
        range_quadratic: part that grows with its square [1/m].
        lateral_px: by how much each pixel's cone is widened, on each side [px].

    Raises:
        CameraError: a part below zero or not finite.
    """

    sigmas: float = 3.0
    bias_m: float = 0.0
    lateral_px: float = 0.5
    range_linear: float = 0.0
    range_quadratic: float = 0.0

    def __post_init__(self) -> None:
        for name in ("sigmas", "bias_m", "lateral_px", "range_linear", "range_quadratic"):
            value = getattr(self, name)
            if not (np.isfinite(value) and value >= 0):
                raise CameraError(f"margin: {name} is {value}, must be a finite number of at least 0")
