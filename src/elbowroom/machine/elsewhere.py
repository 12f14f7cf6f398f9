"""Whether cameras see through links where the machine is said to be: then it stands elsewhere, or otherwise.

Cameras that agree with each other say nothing of where the machine stands among them: a base that is turned, a world
that is another one, joints in another order or unit read as valid. The machine's own pixels tell.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import maximum_filter, minimum_filter
from scipy.spatial import KDTree

from elbowroom.geometry import DepthCamera
from elbowroom.machine.excess import VOXEL_M
from elbowroom.machine.joint_state import Joints
from elbowroom.machine.machine import Machine
from elbowroom.machine.rasterise import rasterise
from elbowroom.machine.samples import body_samples

PIXELS = 3000
"""About so many of an image's pixels are looked at."""
BEHIND_M, SIGMAS = 0.1, 4.0
"""What is measured so far behind the model is not the machine; hulls and boxes are larger by less [m]."""
LEAST_PIXELS = 15
"""Of a link; fewer tell nothing."""
THROUGH = 0.8
"""Of a link's pixels that see the model or past it: where so many see past it, the link is not there."""


@dataclass(frozen=True, slots=True)
class Elsewhere:
    """What cameras see where the machine is said to be.

    Args:
        links: that are not there, in the order of the machine.
        shown: all links that enough pixels say something of.
        through: pixels that see through the machine.
        agree: pixels that see it.
        cameras: how many cameras see through links that are not there.
    """

    links: tuple[str, ...]
    shown: tuple[str, ...]
    through: int
    agree: int
    cameras: int

    @property
    def share(self) -> float:
        """Of the pixels that say something, those that see through the machine, 0 to 1."""
        return self.through / max(self.through + self.agree, 1)


class _Seen(NamedTuple):
    """By pixel of one image that says something: the link that is drawn there, and whether it is seen through."""

    link: NDArray[np.int64]
    through: NDArray[np.bool_]


def elsewhere(
    machine: Machine,
    cameras: Sequence[DepthCamera],
    depths: Sequence[NDArray[np.float32]],
    joints_per_camera: Sequence[Joints],
) -> Elsewhere:
    """Counts, link by link, pixels that see the machine and pixels that see through it.

    What is measured before the model hides it, and says nothing; nor does a pixel without a return.

    Args:
        machine: where it is said to be.
        cameras: without distortion.
        depths: for each camera, shape (height, width) [m, its kind].
        joints_per_camera: for each camera, joint positions at its frame's time, by name [m or rad].

    Raises:
        CameraError: a camera has distortion.
        MachineError: joints that are not possible.
    """
    surface = _Surface(machine.as_seen)
    seen = [
        _seen(surface, camera, np.asarray(depth, dtype=np.float64), joints)
        for camera, depth, joints in zip(cameras, depths, joints_per_camera, strict=True)
    ]
    count = len(machine.links)
    every, past = (
        np.array([np.bincount(one.link[which(one)], minlength=count) for one in seen]).reshape(-1, count)
        for which in (lambda one: slice(None), lambda one: one.through)
    )
    is_shown = every.sum(axis=0) >= LEAST_PIXELS
    is_lost = is_shown & (past.sum(axis=0) >= THROUGH * every.sum(axis=0))
    names = np.array(machine.link_names)
    through = int(past.sum())
    return Elsewhere(
        tuple(map(str, names[is_lost])),
        tuple(map(str, names[is_shown])),
        through,
        int(every.sum()) - through,
        int(np.count_nonzero(past[:, is_lost].sum(axis=1))),
    )


class _Surface:
    """The machine's surface as points, a tree of them for each position that it had."""

    def __init__(self, machine: Machine) -> None:
        self.machine = machine
        self._trees: dict[bytes, KDTree] = {}

    def links_at(self, places: NDArray[np.float64], joints: Joints) -> NDArray[np.int64]:
        """The link on whose surface each place lies, shape (n,)."""
        if not len(places):
            return np.zeros(0, dtype=np.int64)
        of_point = body_samples(self.machine, VOXEL_M, unchecked=True).point_link
        return np.asarray(of_point[self._tree(joints).query(places)[1]], dtype=np.int64)

    def _tree(self, joints: Joints) -> KDTree:
        positions = self.machine.positions(joints)
        key = np.asarray(positions, dtype=np.float64).tobytes()
        if key not in self._trees:
            samples = body_samples(self.machine, VOXEL_M, unchecked=True)
            pose = self.machine.world_from_link_array(np.atleast_2d(positions))[0][samples.point_link]
            placed = (
                np.einsum("nij,nj->ni", pose[:, :3, :3], samples.points.astype(np.float64)) + pose[:, :3, 3]
            )
            self._trees[key] = KDTree(placed)
        return self._trees[key]


def _seen(surface: _Surface, camera: DepthCamera, depth: NDArray[np.float64], joints: Joints) -> _Seen:
    """What one image says of the machine."""
    drawn = rasterise(surface.machine, camera, joints).astype(np.float64)
    # what lies on an edge of the machine may be seen past it
    farthest, nearest = maximum_filter(drawn, 3), minimum_filter(drawn, 3)
    within = np.isfinite(farthest) & (depth >= max(camera.min_depth_m, 1e-6)) & (depth <= camera.max_depth_m)
    step = max(1, round(np.sqrt(np.count_nonzero(within) / PIXELS)))
    at = np.zeros_like(within)
    at[::step, ::step] = within[::step, ::step]
    sigma = 0.0 if camera.noise is None else camera.noise.sigma(farthest[at])
    slack = BEHIND_M + SIGMAS * sigma
    through = depth[at] > farthest[at] + slack
    says = through | (depth[at] > nearest[at] - slack)
    places = camera.points_in_world(np.where(at, drawn, 0.0))[at]
    return _Seen(surface.links_at(places, joints)[says], through[says])
