"""How well what two cameras measured fits together."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from elbowroom.geometry import DepthCamera

WITHIN_M = 0.05
"""Depths that differ by less agree [m]."""


@dataclass(frozen=True, slots=True)
class Agreement:
    """Pixels of one camera whose points another camera looks at, with a return of its own there.

    Args:
        compared: how many there are.
        agree: whose depth in the other camera is within `WITHIN_M` of what that one measured.
        hidden: that lie farther than what the other camera measured: something else is before them.
        conflict: that lie nearer: the other camera saw through them.
    """

    compared: int
    agree: int
    hidden: int
    conflict: int

    @property
    def agree_pct(self) -> float:
        """Share that agrees [%]; 0 if nothing is compared."""
        return 100.0 * self.agree / self.compared if self.compared else 0.0

    @property
    def hidden_pct(self) -> float:
        """Share that is hidden [%]."""
        return 100.0 * self.hidden / self.compared if self.compared else 0.0

    @property
    def conflict_pct(self) -> float:
        """Share that is seen through [%]."""
        return 100.0 * self.conflict / self.compared if self.compared else 0.0

    def __add__(self, other: "Agreement") -> "Agreement":
        """Of both together."""
        return Agreement(
            self.compared + other.compared,
            self.agree + other.agree,
            self.hidden + other.hidden,
            self.conflict + other.conflict,
        )


def agreement(
    one: DepthCamera,
    planar_one: NDArray[np.float32],
    other: DepthCamera,
    planar_other: NDArray[np.float32],
    within_m: float = WITHIN_M,
) -> Agreement:
    """Compares each measured point of one camera with the depth of the pixel of another that looks there.

    Args:
        one, other: pinhole cameras at their places.
        planar_one, planar_other: their images of one moment, depth along the axis [m]; 0: no return.
        within_m: how far apart depths that agree may be [m].
    """
    x, y = np.meshgrid(*one.intrinsics.normalised(one.width, one.height))
    there = planar_one > 0
    z = planar_one[there].astype(float)
    in_one = np.stack([x[there] * z, y[there] * z, z, np.ones_like(z)], axis=-1)
    in_other = in_one @ (other.camera_from_world @ one.world_from_camera).T
    ahead = in_other[:, 2] > 1e-6
    point = in_other[ahead]
    k = other.intrinsics
    u = np.rint(k.fx * point[:, 0] / point[:, 2] + k.cx)
    v = np.rint(k.fy * point[:, 1] / point[:, 2] + k.cy)
    inside = (u >= 0) & (u < other.width) & (v >= 0) & (v < other.height)
    measured = planar_other[v[inside].astype(np.intp), u[inside].astype(np.intp)]
    valid = measured > 0
    beyond = point[inside, 2][valid] - measured[valid]
    return Agreement(
        int(valid.sum()),
        int((np.abs(beyond) < within_m).sum()),
        int((beyond >= within_m).sum()),
        int((beyond <= -within_m).sum()),
    )


def seen_from(
    camera: DepthCamera, other: DepthCamera, planar_other: NDArray[np.float32]
) -> NDArray[np.float32]:
    """What another camera measured, as seen from this one: depth along the axis of the nearest point in each pixel.

    Args:
        camera, other: pinhole cameras at their places.
        planar_other: the other's image, depth along its axis [m]; 0: no return.

    Returns:
        shape (height, width) of `camera`, float32 [m]; 0 where no point falls.
    """
    x, y = np.meshgrid(*other.intrinsics.normalised(other.width, other.height))
    there = planar_other > 0
    z = planar_other[there].astype(float)
    in_other = np.stack([x[there] * z, y[there] * z, z, np.ones_like(z)], axis=-1)
    point = in_other @ (camera.camera_from_world @ other.world_from_camera).T
    point = point[point[:, 2] > 1e-6]
    k = camera.intrinsics
    u = np.rint(k.fx * point[:, 0] / point[:, 2] + k.cx)
    v = np.rint(k.fy * point[:, 1] / point[:, 2] + k.cy)
    inside = (u >= 0) & (u < camera.width) & (v >= 0) & (v < camera.height)
    nearest = np.full((camera.height, camera.width), np.inf, dtype=np.float32)
    np.minimum.at(
        nearest,
        (v[inside].astype(np.intp), u[inside].astype(np.intp)),
        point[inside, 2].astype(np.float32),
    )
    return np.where(np.isfinite(nearest), nearest, np.float32(0))
