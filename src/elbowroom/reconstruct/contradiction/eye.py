"""A camera as somebody says that it sees: where it is, which way its images lie, its lens, its unit of depth."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from elbowroom.errors import CameraError
from elbowroom.geometry import DepthCamera, Intrinsics
from elbowroom.geometry.lens import distorted, undistorted, usable_radius
from elbowroom.geometry.margin import Margin
from elbowroom.geometry.noise import NoiseModel

Array = NDArray[np.float64]
NEAREST_M = 0.02
"""What is nearer to a camera's plane is not looked up in its image [m]."""
WIDEST = 20.0
"""Tangent of the widest angle to the optical axis at which anything is looked up."""


@dataclass(frozen=True, slots=True, eq=False)
class Eye:
    """How a camera sees, with whatever a mistake can have changed: unlike a camera's pose, axes may mirror.

    Args:
        name: of the camera.
        width, height: size of its images [px].
        axes: of the camera in the world, shape (3, 3), columns x right, y down, z forward; orthonormal.
        centre: in the world, shape (3,) [m].
        intrinsics: pinhole and distortion.
        radial: whether depth is the distance from the centre, not along the optical axis.
        scale: what its depths are multiplied by.
        least_m, greatest_m: the least and the greatest depth that is a return [m].
        noise: of depth; None: exact.
        margin: what its depths are not trusted to.
    """

    name: str
    width: int
    height: int
    axes: Array
    centre: Array
    intrinsics: Intrinsics
    radial: bool
    scale: float
    least_m: float
    greatest_m: float
    noise: NoiseModel | None
    margin: Margin

    @classmethod
    def of(cls, camera: DepthCamera, margin: Margin) -> "Eye":
        """As a site says of its camera.

        Args:
            camera: distorted or not.
            margin: of cameras without one of their own.
        """
        return cls(
            name=camera.name,
            width=camera.width,
            height=camera.height,
            axes=camera.world_from_camera[:3, :3],
            centre=camera.centre_in_world,
            intrinsics=camera.intrinsics,
            radial=camera.depth_kind == "radial",
            scale=1.0,
            least_m=camera.min_depth_m,
            greatest_m=camera.deepest_m,
            noise=camera.noise,
            margin=camera.margin or margin,
        )

    def uncertainty_m(self, depth_m: Array) -> Array:
        """The margin at depths of its kind [m], the shape of `depth_m`."""
        own = self.margin
        wide = own.bias_m + own.range_linear * depth_m + own.range_quadratic * depth_m**2
        return wide if self.noise is None else wide + own.sigmas * self.noise.sigma(depth_m)

    def directions(self, u: Array, v: Array) -> Array:
        """Directions (x, y, 1) that pixels see, shape (n, 3); NaN where the lens model leads to none."""
        try:
            x, y = undistorted(self.intrinsics, u, v)
        except CameraError:
            return np.full((len(u), 3), np.nan)
        return np.stack([x, y, np.ones_like(x)], axis=1)

    def depth_of(self, in_camera: Array) -> Array:
        """Depth of points in the camera's axes, of its own kind, shape (n,) [m]."""
        return np.linalg.norm(in_camera, axis=1) if self.radial else in_camera[:, 2]

    def pixels_of(self, in_camera: Array) -> tuple[Array, Array]:
        """Column and row that see points in the camera's axes, shape (n,) [px]; -1 where none does."""
        z = in_camera[:, 2]
        before = z > NEAREST_M
        per_z = 1.0 / np.where(before, z, 1.0)
        x, y = in_camera[:, 0] * per_z, in_camera[:, 1] * per_z
        k = self.intrinsics
        if not k.is_distorted:
            u, v = k.fx * x + k.cx, k.fy * y + k.cy
            return np.where(before, u, -1.0), np.where(before, v, -1.0)
        radius = np.hypot(x, y)
        seen = before & (radius < WIDEST)
        seen &= radius <= usable_radius(k, float(radius[seen].max(initial=0.1)))
        u, v = distorted(k, np.where(seen, x, 0.0), np.where(seen, y, 0.0))
        return np.where(seen, u, -1.0), np.where(seen, v, -1.0)
