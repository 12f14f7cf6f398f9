"""How much larger the machine's model is than what cameras see of it, link by link.

Collision geometry is laid around a machine. Where it explains images as well, what cameras measure lies within it: so
does a hand in it. This says of which links that is so, and by how much.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Self

import numpy as np
from numpy.typing import NDArray

from elbowroom.geometry import DepthCamera
from elbowroom.machine.joint_state import Joints
from elbowroom.machine.machine import Machine
from elbowroom.machine.rasterise import rasterise
from elbowroom.machine.samples import BodySamples, body_samples

if TYPE_CHECKING:
    from scipy.spatial import KDTree

BLOCK_PX = 5
"""Pixels along the edge of a block, of which the middling depth counts: noise is less by that."""
LEAST_RETURNS = 13
"""Of a block; most of it."""
VOXEL_M = 0.03
"""The machine is sampled as for voxels of this size: a block is its own if it lies so near to a sample [m]."""
LEAST_BLOCKS = 8
"""Of a link, for it to be said anything."""
HIGH_PCT = 90.0
"""An excess is what so many of a link's blocks do not go beyond [%]."""
SIGMAS = 3.0
"""A block lies behind the model if it does so by this many sigmas of its middling depth."""


@dataclass(frozen=True, slots=True)
class Excess:
    """By how much the model of one link is larger than what cameras see of it.

    Args:
        link: its name.
        excess_m: how deep in the model its surface is seen, in the most of its blocks [m].
        share: of the blocks of pixels that show the link, how many are that deep, 0 to 1.
        blocks: how many show it.
    """

    link: str
    excess_m: float
    share: float
    blocks: int


def excess_of(
    machine: Machine,
    cameras: Sequence[DepthCamera],
    depths: Sequence[NDArray[np.float32]],
    joints_per_camera: Sequence[Joints],
    least_m: float = 0.01,
) -> tuple[Excess, ...]:
    """The links whose model is larger than what is seen of them, the worst first.

    What lies in front of the model or beside it says nothing.

    Args:
        machine: whose model, as it explains pixels (`Machine.as_seen`).
        cameras: without distortion.
        depths: for each camera, shape (height, width) [m, its kind].
        joints_per_camera: for each camera, joint positions at its frame's time, by name [m or rad].
        least_m: less is not told [m].

    Raises:
        CameraError: a camera has distortion.
        MachineError: joints that are not possible.
    """
    seen = machine.as_seen
    samples = body_samples(seen, VOXEL_M, unchecked=True)
    deep: dict[int, list[float]] = {}
    bodies: dict[bytes, _Body] = {}  # of cameras whose frames are of one time there is one
    for camera, depth, joints in zip(cameras, depths, joints_per_camera, strict=True):
        points, behind, sure = _blocks(
            camera, np.asarray(depth, dtype=np.float64), rasterise(seen, camera, joints)
        )
        placed = seen.world_from_link_array(np.atleast_2d(seen.positions(joints)))[0]
        if not len(points):
            continue
        pose = placed.tobytes()
        if pose not in bodies:
            bodies = {pose: _Body.of(samples, placed)}
        link, within = bodies[pose].depth_in(points)
        for row, depth_in, away, least in zip(link, within, behind, sure, strict=True):
            if row >= 0:
                deep.setdefault(int(row), []).append(min(depth_in, away) if away > least else 0.0)
    found = [_excess(seen.link_names[row], np.array(values), least_m) for row, values in deep.items()]
    return tuple(sorted((one for one in found if one is not None), key=lambda one: -one.excess_m))


def _excess(link: str, deep: NDArray[np.float64], least_m: float) -> Excess | None:
    """What is told of one link whose blocks lie so deep in it [m]; None: nothing."""
    share = float(np.mean(deep > least_m))
    if len(deep) < LEAST_BLOCKS or share < 1 - HIGH_PCT / 100:
        return None
    return Excess(link, float(np.percentile(deep[deep > least_m], HIGH_PCT)), share, len(deep))


def _blocks(
    camera: DepthCamera, depth: NDArray[np.float64], drawn: NDArray[np.float32]
) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
    """The blocks of an image that see the model or past it.

    Returns:
        Points in the world, shape (n, 3) [m]; how far behind the model they lie along their rays, and from where on
        that is sure, shape (n,) [m].
    """
    usable = np.isfinite(drawn) & (depth >= max(camera.min_depth_m, 1e-6)) & (depth <= camera.max_depth_m)
    rows, columns = (side // BLOCK_PX for side in depth.shape)
    cut = (slice(rows * BLOCK_PX), slice(columns * BLOCK_PX))

    def by_block(image: NDArray[np.float64]) -> NDArray[np.float64]:
        blocks = image[cut].reshape(rows, BLOCK_PX, columns, BLOCK_PX).swapaxes(1, 2)
        return blocks.reshape(rows * columns, -1)

    enough = np.flatnonzero(by_block(usable.astype(float)).sum(axis=1) >= LEAST_RETURNS)
    if not len(enough):
        return np.zeros((0, 3)), np.zeros(0), np.zeros(0)
    valid = np.where(usable, 1.0, np.nan)
    measured, off = (
        np.nanmedian(by_block(image * valid)[enough], axis=1)
        for image in (depth, depth - np.where(usable, drawn, 0.0))
    )
    row, column = np.divmod(enough, columns)
    middle = row * BLOCK_PX + BLOCK_PX // 2, column * BLOCK_PX + BLOCK_PX // 2
    image = np.zeros(depth.shape)
    image[middle] = measured
    noise = 0.0 if camera.noise is None else camera.noise.sigma(measured)
    sure = SIGMAS * 1.25 * np.broadcast_to(noise, off.shape) / np.sqrt(LEAST_RETURNS)
    return camera.points_in_world(image)[middle], off, sure


@dataclass(frozen=True, slots=True, eq=False)
class _Body:
    """The machine's samples in one pose, to be asked what is near.

    Args:
        link: of each sample, shape (n,).
        all, surface: trees of all samples, and of those on the surface.
    """

    link: NDArray[np.int32]
    all: "KDTree"
    surface: "KDTree"

    @classmethod
    def of(cls, samples: BodySamples, world_from_link: NDArray[np.float64]) -> Self:
        """The samples where the links are.

        Args:
            samples: of the body.
            world_from_link: shape (links, 4, 4).
        """
        from scipy.spatial import KDTree  # slow to load, and no pass needs it

        link = np.concatenate([samples.point_link, samples.interior_link])
        within = np.concatenate([samples.points, samples.interior]).astype(np.float64)
        pose = world_from_link[link]
        placed = np.einsum("nij,nj->ni", pose[:, :3, :3], within) + pose[:, :3, 3]
        return cls(link, KDTree(placed), KDTree(placed[: len(samples.points)]))

    def depth_in(self, points: NDArray[np.float64]) -> tuple[NDArray[np.int32], NDArray[np.float64]]:
        """For points in the world, the link that each lies on or in, -1: none; how far it is from the surface [m]."""
        away, nearest = self.all.query(points)
        depth, _ = self.surface.query(points)
        return np.where(away <= VOXEL_M, self.link[nearest], -1), depth
