"""The inner geometry of a camera: pinhole, with OpenCV's distortion of 5 or 8 coefficients."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from elbowroom.errors import CameraError


@dataclass(frozen=True, slots=True)
class Intrinsics:
    """Pinhole intrinsics. Pixel centres lie at whole numbers: pixel (u, v) covers u +- 0.5, v +- 0.5.

    u = fx X/Z + cx, v = fy Y/Z + cy in OpenCV's camera axes (thesis eq. 2, with y down).

    Args:
        fx, fy: focal lengths [px].
        cx, cy: principal point [px].
        distortion: none, or OpenCV's (k1, k2, p1, p2, k3[, k4, k5, k6]).

    Raises:
        CameraError: a focal length that is not above zero, a number that is not finite, or a number of distortion
            coefficients other than 0, 5 or 8.
    """

    fx: float
    fy: float
    cx: float
    cy: float
    distortion: tuple[float, ...] = ()

    def __post_init__(self) -> None:
        object.__setattr__(self, "distortion", tuple(float(k) for k in self.distortion))
        for name in ("fx", "fy"):
            value = getattr(self, name)
            if not (np.isfinite(value) and value > 0):
                mirrored = " (images are mirrored against the poses: mirror the world, and make it positive)"
                raise CameraError(
                    f"intrinsics: {name} is {value}, must be a finite number of pixels above 0"
                    f"{mirrored if value < 0 else ''}"
                )
        if not np.isfinite([self.cx, self.cy, *self.distortion]).all():
            raise CameraError("intrinsics: cx, cy and distortion must be finite")
        if len(self.distortion) not in (0, 5, 8):
            raise CameraError(
                f"intrinsics: {len(self.distortion)} distortion coefficients, allowed are none, "
                "5 (k1 k2 p1 p2 k3) or 8 (k1 k2 p1 p2 k3 k4 k5 k6)"
            )

    @classmethod
    def from_matrix(cls, matrix: NDArray[np.float64], distortion: tuple[float, ...] = ()) -> "Intrinsics":
        """From a 3x3 camera matrix [[fx, 0, cx], [0, fy, cy], [0, 0, 1]]; skew is refused."""
        k = np.asarray(matrix, dtype=np.float64)
        if k.shape != (3, 3) or not np.allclose([k[0, 1], k[1, 0], k[2, 0], k[2, 1]], 0) or k[2, 2] != 1:
            raise CameraError(
                f"camera matrix: expected [[fx, 0, cx], [0, fy, cy], [0, 0, 1]], got {k.tolist()}"
            )
        return cls(fx=k[0, 0], fy=k[1, 1], cx=k[0, 2], cy=k[1, 2], distortion=distortion)

    @property
    def is_distorted(self) -> bool:
        """Whether any distortion coefficient differs from zero."""
        return any(k != 0 for k in self.distortion)

    def normalised(self, width: int, height: int) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """X/Z of each column, shape (width,), and Y/Z of each row, shape (height,), without distortion."""
        columns, rows = np.arange(width, dtype=np.float64), np.arange(height, dtype=np.float64)
        return (columns - self.cx) / self.fx, (rows - self.cy) / self.fy
