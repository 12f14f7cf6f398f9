"""A fixed depth camera: size of image, intrinsics, pose, kind of depth, noise."""

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from elbowroom.errors import CameraError
from elbowroom.geometry.intrinsics import Intrinsics
from elbowroom.geometry.margin import Margin
from elbowroom.geometry.noise import NoiseModel
from elbowroom.geometry.transforms import invert_rigid, nearest_rigid

DepthKind = Literal["planar", "radial"]
MAX_SIDE_PX = 16384
AT_THE_END = 1e-6
"""Depths within this share of the greatest range are at it: units of float32 are that wide."""


@dataclass(frozen=True, slots=True, eq=False)
class DepthCamera:
    """A depth camera that does not move.

    Args:
        name: unique among the cameras of a room.
        width, height: size of the image [px].
        world_from_camera: pose, shape (4, 4), rigid; OpenCV camera axes (x right, y down, z forward).
        intrinsics: pinhole and distortion.
        depth_kind: "planar" (distance along the optical axis) or "radial" (distance from the camera centre).
        noise: sigma of depth over depth; None: exact.
        margin: goes before the margin of the call that uses this camera; None: the call's.
        min_depth_m, max_depth_m: what lies outside, or at the greatest, is no return [m, in its kind of depth].
        flying_pixels: whether steps in depth carve only to the nearer side; None: only where there is a noise model.
        mask: pixels that say nothing whatever they deliver, as if outside the image, shape (height, width), bool; None:
            none. They free nothing and dispute nothing.
        clock_bound_ns: by how much its stamps may be off the room's clock, or off the middle of exposure [ns].

    Raises:
        CameraError: a value that no camera can have.
    """

    name: str
    width: int
    height: int
    world_from_camera: NDArray[np.float64]
    intrinsics: Intrinsics
    depth_kind: DepthKind = "planar"
    noise: NoiseModel | None = None
    margin: Margin | None = None
    min_depth_m: float = 0.0
    max_depth_m: float = float("inf")
    flying_pixels: bool | None = None
    mask: NDArray[np.bool_] | None = None
    clock_bound_ns: int = 0

    def __post_init__(self) -> None:
        if not self.name or "/" in self.name or "\\" in self.name:
            raise CameraError(f"camera: name is {self.name!r}, must be a non-empty word without slashes")
        for side in ("width", "height"):
            value = getattr(self, side)
            if value != int(value) or not 1 <= value <= MAX_SIDE_PX:
                raise CameraError(f"camera {self.name}: {side} is {value}, must be 1 to {MAX_SIDE_PX} pixels")
        if self.depth_kind not in ("planar", "radial"):
            raise CameraError(
                f"camera {self.name}: depth_kind is {self.depth_kind!r}, allowed are planar, radial"
            )
        if not 0 <= self.min_depth_m < self.max_depth_m:
            raise CameraError(
                f"camera {self.name}: depth from {self.min_depth_m} to {self.max_depth_m} m is no range; "
                "min_depth_m must be at least 0 and below max_depth_m"
            )
        if self.clock_bound_ns < 0:
            raise CameraError(
                f"camera {self.name}: clock_bound_ns is {self.clock_bound_ns}, must be at least 0"
            )
        if self.mask is not None:
            object.__setattr__(self, "mask", _checked_mask(self.mask, self))
        pose = nearest_rigid(self.world_from_camera, f"camera {self.name}: world_from_camera")
        pose.setflags(write=False)
        object.__setattr__(self, "world_from_camera", pose)
        if self.flying_pixels is None:
            object.__setattr__(self, "flying_pixels", self.noise is not None)

    @property
    def deepest_m(self) -> float:
        """The greatest depth that is a return [m]: just short of `max_depth_m`, often written for none."""
        return self.max_depth_m * (1.0 - AT_THE_END)

    @property
    def camera_from_world(self) -> NDArray[np.float64]:
        """Inverse pose, shape (4, 4)."""
        return invert_rigid(self.world_from_camera)

    @property
    def centre_in_world(self) -> NDArray[np.float64]:
        """The camera's centre, shape (3,), world frame [m]."""
        return self.world_from_camera[:3, 3]

    @property
    def radial_over_planar(self) -> NDArray[np.float64]:
        """Per pixel: distance from the centre over distance along the axis, shape (height, width), no distortion."""
        x, y = self.intrinsics.normalised(self.width, self.height)
        return np.sqrt(1.0 + x[None, :] ** 2 + y[:, None] ** 2)

    def points_in_world(self, depth_m: NDArray[np.floating]) -> NDArray[np.float64]:
        """The measured points of an undistorted depth image.

        Args:
            depth_m: shape (height, width) [m, this camera's kind].

        Returns:
            shape (height, width, 3), world frame [m]; meaningless where there is no return.
        """
        x, y = self.intrinsics.normalised(self.width, self.height)
        z = np.asarray(depth_m, dtype=float)
        if self.depth_kind == "radial":
            z = z / self.radial_over_planar
        in_camera = np.stack([x[None, :] * z, y[:, None] * z, z], axis=-1)
        return in_camera @ self.world_from_camera[:3, :3].T + self.centre_in_world


def _checked_mask(mask: NDArray[np.bool_], camera: DepthCamera) -> NDArray[np.bool_] | None:
    """A mask of the camera's size, read-only; None where it masks nothing."""
    given = np.asarray(mask)
    if given.dtype != np.bool_ or given.shape != (camera.height, camera.width):
        raise CameraError(
            f"camera {camera.name}: mask is {given.dtype} {given.shape}, must be bool of shape "
            f"({camera.height}, {camera.width})"
        )
    if not given.any():
        return None
    own = np.ascontiguousarray(given).copy()
    own.setflags(write=False)
    return own
