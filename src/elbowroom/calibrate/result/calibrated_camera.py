"""A camera whose pose was found from images, and how sure that is."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from elbowroom.errors import CalibrationError
from elbowroom.geometry import DepthCamera


@dataclass(frozen=True, slots=True, eq=False)
class CalibratedCamera:
    """What calibration found of one camera.

    Args:
        camera: with the pose and intrinsics that were found.
        before: as the site had it; None: it had none.
        covariance: of the pose, shape (6, 6): rotation vector [rad], then translation [m], in the camera's frame:
            true world_from_camera = camera.world_from_camera @ exp(error).
        residuals_px: distances between corners seen and corners projected, shape (n,) [px].
        residuals_m: distances between depth measured and the surface, along the ray, shape (m,) [m].
        notes: what is weak, and what to capture next; a sentence each.

    Raises:
        CalibrationError: a covariance that is none.
    """

    camera: DepthCamera
    before: DepthCamera | None
    covariance: NDArray[np.float64]
    residuals_px: NDArray[np.float64]
    residuals_m: NDArray[np.float64]
    notes: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        covariance = np.array(self.covariance, dtype=np.float64)
        if covariance.shape != (6, 6) or not np.isfinite(covariance).all():
            raise CalibrationError(
                f"camera {self.camera.name}: covariance has shape {covariance.shape}, must be finite (6, 6)"
            )
        if np.linalg.eigvalsh((covariance + covariance.T) / 2).min() < -1e-12:
            raise CalibrationError(f"camera {self.camera.name}: covariance has a negative variance")
        for name, values in (
            ("covariance", covariance),
            ("residuals_px", np.array(self.residuals_px, dtype=np.float64)),
            ("residuals_m", np.array(self.residuals_m, dtype=np.float64)),
        ):
            values.setflags(write=False)
            object.__setattr__(self, name, values)
