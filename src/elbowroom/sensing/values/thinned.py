"""A depth image thinned to the pixels that a look at its values needs."""

from dataclasses import dataclass
from functools import cached_property, lru_cache

import numpy as np
from numpy.typing import NDArray

from elbowroom.errors import CameraError
from elbowroom.geometry import DepthCamera, VoxelGrid
from elbowroom.geometry.lens import undistorted
from elbowroom.sensing.frame import DepthFrame

PIXELS = 4800
"""About so many pixels of an image are looked at: 80 x 60."""
UNITS_M = (0.001, 0.00025, 0.0001, 0.0002, 0.000125, 0.0005, 0.001 / 16, 1e-5, 1 / 256, 0.01)
"""Units of depth images that are in use [m], the usual ones first."""
ALONG_AN_AXIS = 0.99999
"""Cosine of the angle between the optical axis and the axis of the world that is nearest."""
CAMERAS_KEPT = 256

Floats = NDArray[np.floating]


@dataclass(frozen=True, eq=False)
class Thinned:
    """Every so many pixels of a depth image, each with its neighbours to the right and below.

    Args:
        camera: that took it.
        step: every so many pixels, in both directions.
        here, right, below: depth as it came, shape (rows, columns) [m, the camera's kind of depth].
        unit_m: metres per unit of the file that it was read from; None: not known.
    """

    camera: DepthCamera
    step: int
    here: NDArray[np.float32]
    right: NDArray[np.float32]
    below: NDArray[np.float32]
    unit_m: float | None = None

    @cached_property
    def given(self) -> NDArray[np.bool_]:
        """Where there is a number above zero, also beyond the camera's range."""
        return np.asarray((self.here > 0) & (self.here < np.inf))

    @cached_property
    def returns(self) -> NDArray[np.bool_]:
        """Where there is a return, by what the site says of the camera's range."""
        within = (self.here >= self.camera.min_depth_m) & (self.here <= self.camera.deepest_m)
        return np.asarray(self.given & within)

    @cached_property
    def depths_m(self) -> NDArray[np.float64]:
        """Depth of all returns, rising, shape (n,) [m]."""
        return np.sort(self.here[self.returns].astype(np.float64))

    @cached_property
    def ranges_m(self) -> NDArray[np.float64]:
        """Distance of each pixel's point from the camera's centre, shape (rows, columns) [m]; 0: no return."""
        depth = np.where(self.returns, self.here, 0).astype(np.float64)
        return depth if self.camera.depth_kind == "radial" else depth * self.over_planar

    @property
    def may_face_a_wall(self) -> bool:
        """Whether a wall or a floor may have one depth all over, without noise: it looks along an axis of the world."""
        along = float(np.abs(self.camera.world_from_camera[:3, 2]).max())
        return self.camera.depth_kind == "planar" and along > ALONG_AN_AXIS

    @property
    def rays_in_world(self) -> NDArray[np.float64]:
        """Direction of each pixel, of length one, shape (rows, columns, 3), world frame."""
        return rays_of(self.camera, self.step)[0]

    @property
    def over_planar(self) -> NDArray[np.float64]:
        """By pixel the length of its ray over its part along the axis, shape (rows, columns)."""
        return rays_of(self.camera, self.step)[1]

    @cached_property
    def codes(self) -> NDArray[np.int64] | None:
        """Whole numbers that all given depths are of one unit, shape (n,); None: there is no such unit."""
        depth = self.here[self.given].astype(np.float64)
        if not depth.size:
            return None
        for unit in UNITS_M if self.unit_m is None else (self.unit_m,):
            codes = np.rint(depth / unit)
            if codes.max() <= 65535 and np.abs(codes * unit - depth).max() <= 1e-6 * depth.max() + 1e-9:
                return codes.astype(np.int64)
        return None


def thinned(camera: DepthCamera, frame: DepthFrame, unit_m: float | None = None) -> Thinned:
    """About `PIXELS` of an image's pixels.

    Args:
        camera: that took it.
        frame: of the camera's size.
        unit_m: metres per unit of the file that it was read from; None: not known.
    """
    depth = frame.depth_m
    step = max(1, int(np.ceil(np.sqrt(depth.size / PIXELS))))
    columns, rows = np.arange(0, depth.shape[1], step), np.arange(0, depth.shape[0], step)
    beside, beneath = np.minimum(columns + 1, depth.shape[1] - 1), np.minimum(rows + 1, depth.shape[0] - 1)
    return Thinned(
        camera,
        step,
        depth[np.ix_(rows, columns)],
        depth[np.ix_(rows, beside)],
        depth[np.ix_(beneath, columns)],
        unit_m,
    )


@lru_cache(maxsize=CAMERAS_KEPT)
def rays_of(camera: DepthCamera, step: int) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Directions of every so many pixels, of length one, world frame, shape (rows, columns, 3); and how much longer
    than their part along the axis they are, shape (rows, columns).

    Args:
        camera: its lens is taken out as far as its model reaches.
        step: every so many pixels.
    """
    u, v = np.meshgrid(np.arange(0.0, camera.width, step), np.arange(0.0, camera.height, step))
    k = camera.intrinsics
    try:
        x, y = undistorted(k, u, v)
    except CameraError:  # where the model folds back, the pinhole is near enough for a look
        x, y = (u - k.cx) / k.fx, (v - k.cy) / k.fy
    in_camera = np.stack([x, y, np.ones_like(x)], axis=-1)
    length = np.linalg.norm(in_camera, axis=-1)
    return (in_camera / length[..., None]) @ camera.world_from_camera[:3, :3].T, length


def way_through(
    grid: VoxelGrid, centre_in_world: Floats, rays_in_world: Floats
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Where rays enter and leave the grid [m from the camera]; a ray that misses it leaves before it enters.

    Args:
        grid: the watched box.
        centre_in_world: shape (3,) [m].
        rays_in_world: of length one, shape (..., 3).
    """
    with np.errstate(divide="ignore", invalid="ignore"):
        one = (grid.lower_m - centre_in_world) / rays_in_world
        other = (grid.upper_m - centre_in_world) / rays_in_world
    enters = np.nan_to_num(np.minimum(one, other), nan=-np.inf).max(axis=-1)
    leaves = np.nan_to_num(np.maximum(one, other), nan=np.inf).min(axis=-1)
    return np.maximum(enters, 0.0), leaves
