"""What a camera showed of the still room when it was commissioned."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from elbowroom.errors import CalibrationError
from elbowroom.geometry import DepthCamera
from elbowroom.geometry.twist import CAMERA_MOTIONS
from elbowroom.monitor.health.drift.fit import MOVE_PRIOR_M, TURN_PRIOR_RAD
from elbowroom.monitor.health.drift.kernels.watch import LEAST_SIGMA_M, Spots
from elbowroom.monitor.health.drift.tolerance import Tolerance


@dataclass(frozen=True, slots=True, eq=False)
class CameraReference:
    """Spots of one camera's image on surfaces that stood still.

    Args:
        camera: its name.
        width, height: of its image [px].
        lens: fx, fy, cx, cy and eight coefficients of distortion, 0 where there are fewer.
        radial: whether depth is distance from the camera's centre.
        pixel: places in the flattened image, int64, shape (n,), none twice.
        depth_m: where the surface lies [m, the camera's kind].
        sigma_m: how far single returns scattered [m].
        ray: X/Z and Y/Z of each pixel, shape (n, 2).
        normal: of the surface, unit, towards the camera, camera frame, shape (n, 3).

    Raises:
        CalibrationError: arrays that do not fit each other or the image, or hold what is no number.
    """

    camera: str
    width: int
    height: int
    lens: tuple[float, ...]
    radial: bool
    pixel: NDArray[np.int64]
    depth_m: NDArray[np.float64]
    sigma_m: NDArray[np.float64]
    ray: NDArray[np.float64]
    normal: NDArray[np.float64]

    def __post_init__(self) -> None:
        n = len(self.pixel)
        shapes = {"pixel": (n,), "depth_m": (n,), "sigma_m": (n,), "ray": (n, 2), "normal": (n, 3)}
        for name, shape in shapes.items():
            kind = np.int64 if name == "pixel" else np.float64
            array = np.array(getattr(self, name), dtype=kind, order="C")
            if array.shape != shape or not np.isfinite(array).all():
                raise CalibrationError(
                    f"reference of camera {self.camera}: {name} of shape {array.shape}, must be {shape} and finite"
                )
            array.setflags(write=False)
            object.__setattr__(self, name, array)
        if n and not (self.pixel.min() >= 0 and self.pixel.max() < self.width * self.height):
            raise CalibrationError(
                f"reference of camera {self.camera}: pixels beyond its {self.width} x {self.height}"
            )
        if len(np.unique(self.pixel)) != n:
            raise CalibrationError(f"reference of camera {self.camera}: a pixel is there twice")
        if n and not ((self.depth_m > 0).all() and (self.sigma_m >= 0).all() and (self._scale > 0).all()):
            raise CalibrationError(
                f"reference of camera {self.camera}: depth must be above 0, scatter not below, "
                "and surfaces must face the camera"
            )

    @property
    def _direction(self) -> NDArray[np.float64]:
        """Way in the camera's frame per metre of depth of its kind, shape (n, 3)."""
        direction = np.column_stack([self.ray, np.ones(len(self.ray))])
        return direction / np.linalg.norm(direction, axis=1, keepdims=True) if self.radial else direction

    @property
    def _scale(self) -> NDArray[np.float64]:
        return -np.asarray(np.sum(self._direction * self.normal, axis=1))

    @property
    def points_in_camera(self) -> NDArray[np.float64]:
        """The spots, camera frame, shape (n, 3) [m]."""
        return self._direction * self.depth_m[:, None]

    def spots(self) -> Spots:
        """What the kernels take: the camera moved by a small turn w and move t shows offsets
        n . t + (p x n) . w along the normals."""
        jacobian = np.hstack([np.cross(self.points_in_camera, self.normal), self.normal])
        sigma = np.maximum(self.sigma_m * self._scale, LEAST_SIGMA_M)
        return Spots(self.pixel, self.depth_m, self._scale, sigma, np.ascontiguousarray(jacobian))

    def covariance(self) -> NDArray[np.float64]:
        """How well one frame can tell a motion, nothing being in the way, shape (6, 6) [rad, m]: without the prior,
        where the spots do not show some direction, the prior's."""
        spots = self.spots()
        weighted = spots.jacobian / spots.sigma[:, None]
        prior = np.diag([TURN_PRIOR_RAD**-2.0] * 3 + [MOVE_PRIOR_M**-2.0] * 3)
        return np.linalg.inv(weighted.T @ weighted + prior)

    def unseen_motions(self, turn_rad: float, move_m: float) -> tuple[str, ...]:
        """Which motions of the camera its spots do not show: a third of the tolerance is above their sigma.

        Args:
            turn_rad, move_m: tolerances [rad], [m].
        """
        sigma = np.sqrt(np.diag(self.covariance()))
        limits = np.array([turn_rad] * 3 + [move_m] * 3) / 3
        return tuple(name for name, s, limit in zip(CAMERA_MOTIONS, sigma, limits, strict=True) if s > limit)

    def row(self, tolerance: Tolerance) -> dict[str, Any]:
        """A row of kind "reference": what it shows, and which motions it does not show.

        Args:
            tolerance: by how much a camera may move.
        """
        sigma = np.sqrt(np.diag(self.covariance()))
        return {
            "kind": "reference",
            "camera": self.camera,
            "spots": len(self.pixel),
            "range_m": [float(self.depth_m.min()), float(self.depth_m.max())],
            "turn_sigma_deg": np.degrees(sigma[:3]).tolist(),
            "move_sigma_mm": (1e3 * sigma[3:]).tolist(),
            "not_shown": list(self.unseen_motions(tolerance.turn_rad, tolerance.move_m)),
        }

    def require(self, camera: DepthCamera) -> None:
        """Checks that the reference is of this camera.

        Raises:
            CalibrationError: another size, lens or kind of depth.
        """
        for what, mine, its in (
            ("image", f"{self.width}x{self.height}", f"{camera.width}x{camera.height}"),
            ("depth", _kind(self.radial), camera.depth_kind),
        ):
            if mine != its:
                raise CalibrationError(
                    f"reference of camera {self.camera}: commissioned with {what} {mine}, the site says {its}; "
                    "commission again"
                )
        if not np.allclose(self.lens, lens_of(camera), rtol=1e-6, atol=1e-9):
            raise CalibrationError(
                f"reference of camera {self.camera}: commissioned with other intrinsics than the site's; "
                "commission again"
            )


def _kind(radial: bool) -> str:
    return "radial" if radial else "planar"


def lens_of(camera: DepthCamera) -> tuple[float, ...]:
    """fx, fy, cx, cy and eight coefficients of distortion."""
    k = camera.intrinsics
    return (k.fx, k.fy, k.cx, k.cy, *(*k.distortion, *(0.0,) * 8)[:8])


def require_references(references: Sequence[CameraReference], cameras: Sequence[DepthCamera]) -> None:
    """Checks that references and cameras are of one room.

    Raises:
        CalibrationError: a reference of an unknown camera, a camera twice, a camera without one, or of another kind.
    """
    named = [reference.camera for reference in references]
    doubled = sorted({name for name in named if named.count(name) > 1})
    if doubled:
        raise CalibrationError(f"reference: camera {doubled[0]} is there twice")
    known = {camera.name: camera for camera in cameras}
    unknown, missing = sorted(set(named) - set(known)), sorted(set(known) - set(named))
    if unknown or missing:
        which = (
            f"has camera {unknown[0]}, which the site has not" if unknown else f"lacks camera {missing[0]}"
        )
        raise CalibrationError(f"reference: {which}; it is of another site, commission this one")
    for reference in references:
        reference.require(known[reference.camera])
