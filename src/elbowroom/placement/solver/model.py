"""Points, candidates, and which candidate sees which point from which direction: geometry in closed form.

Nothing here is shared with `placement.verification`, which projects through the code that carves.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from elbowroom.files.progress import Progress, silent
from elbowroom.geometry import DepthCamera
from elbowroom.geometry.lens import distorted, usable_radius
from elbowroom.geometry.ray_scene import RayScene
from elbowroom.placement.requirement import Requirement

REACHED = 1.0 - 1e-5
"""A ray that is stopped no earlier than at this share of its way has reached its point."""
STRAIGHT_M = 1e-6
"""A camera no farther aside is straight above a point: it has no direction in the horizontal plane [m]."""


@dataclass(frozen=True, slots=True, eq=False)
class Model:
    """What each candidate sees of each point.

    Args:
        requirement: what a point must have.
        sees: uint8, shape (candidates, points).
        azimuth: direction from the point to each place, in [0, 2 pi), NaN straight above, shape (places, points) [rad].
        place_of: index of each candidate's place, shape (candidates,). A place holds one camera.
        price: of each candidate, shape (candidates,).
        kept: candidates that hang there already: they are always chosen.
    """

    requirement: Requirement
    sees: NDArray[np.uint8]
    azimuth: NDArray[np.float64]
    place_of: NDArray[np.int64]
    price: NDArray[np.float64]
    kept: tuple[int, ...] = ()

    @property
    def points(self) -> int:
        """Number of points."""
        return int(self.sees.shape[1])

    @property
    def candidates(self) -> int:
        """Number of candidates."""
        return int(self.sees.shape[0])

    def at(self, points: NDArray[np.int64]) -> "Model":
        """The same for some of the points."""
        return Model(
            self.requirement,
            np.ascontiguousarray(self.sees[:, points]),
            np.ascontiguousarray(self.azimuth[:, points]),
            self.place_of,
            self.price,
            self.kept,
        )


def build_model(
    cameras: Sequence[DepthCamera],
    place_of: Sequence[int] | NDArray[np.int64],
    price: Sequence[float],
    points_in_world: NDArray[np.float64],
    triangles: NDArray[np.float64] | None,
    requirement: Requirement,
    *,
    kept: Sequence[int] = (),
    progress: Progress = silent,
) -> Model:
    """Casts one ray from each place to each point, and asks of each candidate whether it lies in its field of view.

    Args:
        cameras: candidates.
        place_of: index of the place of each, from 0.
        price: of each.
        points_in_world: shape (n, 3) [m].
        triangles: surfaces of the room, shape (m, 3, 3), world frame [m]; None: not known, so nothing blocks sight.
        requirement: what a point must have.
        kept: candidates that are always chosen.
        progress: called with what is being done.
    """
    places = int(np.max(place_of)) + 1
    sees = np.zeros((len(cameras), len(points_in_world)), dtype=np.uint8)
    azimuth = np.zeros((places, len(points_in_world)))
    for place in range(places):
        progress(f"place {place + 1} of {places}")
        here = [n for n, at in enumerate(place_of) if at == place]
        eye = cameras[here[0]].centre_in_world
        ways = points_in_world - eye
        stop = _stops(triangles, ways, eye)
        azimuth[place] = np.mod(np.arctan2(-ways[:, 1], -ways[:, 0]), 2 * math.pi)
        azimuth[place, np.hypot(ways[:, 0], ways[:, 1]) < STRAIGHT_M] = np.nan
        for n in here:
            sees[n] = _in_view(cameras[n], ways, stop)
    return Model(
        requirement,
        sees,
        azimuth,
        np.array(place_of, dtype=np.int64),
        np.array(price, dtype=np.float64),
        tuple(kept),
    )


def _stops(
    triangles: NDArray[np.float64] | None, ways: NDArray[np.float64], eye: NDArray[np.float64]
) -> NDArray[np.float64] | None:
    """Where the ray to each point first meets a surface, as a multiple of the way; infinite: nowhere."""
    if triangles is None:
        return None
    vertices = (triangles - eye).reshape(-1, 3)
    scene = RayScene(vertices, np.arange(len(vertices)).reshape(-1, 3))
    rays = ways.astype(np.float32)
    way = scene.distances(np.zeros_like(rays), rays).astype(np.float64)
    return np.where(way < 1e30, way, np.inf)


def _in_view(
    camera: DepthCamera, ways: NDArray[np.float64], stop: NDArray[np.float64] | None
) -> NDArray[np.bool_]:
    """Whether a candidate sees points: in its image, in its range, nothing before them, a return from behind them."""
    right, down, forward = camera.world_from_camera[:3, :3].T
    ahead = ways @ forward
    safe = np.where(ahead > 1e-9, ahead, 1.0)
    x, y = ways @ right / safe, ways @ down / safe
    k = camera.intrinsics
    inside = ahead > 1e-9
    if k.is_distorted:
        widest = float(np.hypot(camera.width / k.fx, camera.height / k.fy))
        inside &= np.hypot(x, y) < usable_radius(k, widest)
    u, v = distorted(k, x, y)
    inside &= (u > -0.5) & (u < camera.width - 0.5) & (v > -0.5) & (v < camera.height - 0.5)
    depth = ahead if camera.depth_kind == "planar" else np.linalg.norm(ways, axis=1)
    inside &= (depth >= camera.min_depth_m) & (depth <= camera.max_depth_m)
    if stop is None:
        return inside
    behind = np.where(np.isfinite(stop), stop * np.maximum(depth, 0.0), np.inf)
    returns = np.isfinite(stop) & (behind >= camera.min_depth_m) & (behind <= camera.max_depth_m)
    return inside & (stop >= REACHED) & returns
