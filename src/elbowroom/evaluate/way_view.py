"""How far the way of a motion is in view, by exact rays: what no reconstruction from these cameras can go beyond.

The way of a motion is the voxels that its moving links come to touch, without those that the body covers already. A
voxel is in view if no solid touches it and one camera alone sees all of it: its centre, and its eight corners
with half a pixel to spare, since that is how far a pixel looks to each side. Rays are cast against the exact
meshes of the room and of the machine where it stands. No image, no noise, no verdict.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from embreex.mesh_construction import TriangleMesh
from embreex.rtcore_scene import EmbreeScene
from numpy.typing import NDArray

from elbowroom.geometry import DepthCamera, VoxelGrid, bits
from elbowroom.machine import Machine, body_samples, body_words
from elbowroom.motion import Motion
from elbowroom.simulate import Moment, true_occupancy

PLACES = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)] + [[0, 0, 0]]) * 0.49
"""Of a voxel, where it is looked at, in edges from its centre: just within its corners, and its centre."""
SPARE_PX = 0.5
"""So much farther out, across the ray, a corner has to be in view: a pixel looks half a pixel to each side."""
BEFORE_M = 2e-4
"""What is hit this little before a place hides it no more than rounding does [m]."""
STEP_IN_VOXELS = 0.5
"""So far the fastest point of the moving links goes between two looks at where they are."""


@dataclass(frozen=True, slots=True, eq=False)
class Way:
    """The voxels that a motion comes to touch.

    Args:
        centres: of the voxels, shape (n, 3), world frame [m].
        travel: at which each is touched first, shape (n,) [m or rad along the joint].
    """

    centres: NDArray[np.float64]
    travel: NDArray[np.float64]


class WayView:
    """What cameras could see at most at one moment.

    Args:
        machine: whose motions.
        moment: its joints, its links and all other solids.
        grid: the voxels.
    """

    def __init__(self, machine: Machine, moment: Moment, grid: VoxelGrid) -> None:
        self._machine, self._joints, self._grid = machine, moment.joints, grid
        self._body = bits.unpack(body_words(machine, moment.joints, grid), grid)
        self._occupied = true_occupancy(grid, moment).occupied
        self._scene = EmbreeScene()
        firsts = np.cumsum([0] + [len(solid.mesh.vertices) for solid in moment.solids])
        TriangleMesh(
            self._scene,
            np.concatenate([solid.vertices_in_world for solid in moment.solids]).astype(np.float32),
            np.concatenate(
                [solid.mesh.faces + first for solid, first in zip(moment.solids, firsts[:-1], strict=True)]
            ).astype(np.int32),
        )

    def way(self, motion: Motion, length: float) -> Way:
        """The voxels of a motion's way.

        Args:
            motion: joint and direction.
            length: how far it is followed [m or rad along the joint]; below zero there is no way.
        """
        machine, grid = self._machine, self._grid
        samples = body_samples(machine, grid.voxel_size_m)
        rows = [
            row for row, link in enumerate(machine.links) if link.name in machine.moved_links(motion.joint)
        ]
        moving = np.isin(samples.point_link, rows)
        points, link = samples.points[moving].astype(np.float64), samples.point_link[moving]
        ends = [self._places(motion, travel, points, link) for travel in (0.0, max(length, 0.0))]
        moved_m = float(np.linalg.norm(ends[1] - ends[0], axis=1).max())
        steps = int(np.ceil(moved_m / (STEP_IN_VOXELS * grid.voxel_size_m))) + 1 if length > 0 else 0
        seen_before = self._body.copy()
        centres: list[NDArray[np.float64]] = []
        travels: list[NDArray[np.float64]] = []
        for travel in np.linspace(0.0, length, steps).tolist():
            moved = self._places(motion, travel, points, link)
            index = np.floor((moved - grid.lower_m) / grid.voxel_size_m).astype(np.int64)
            index = index[((index >= 0) & (index < grid.shape)).all(axis=1)]
            fresh = np.unique(index[~seen_before[tuple(index.T)]], axis=0)
            seen_before[tuple(fresh.T)] = True
            centres.append(grid.lower_m + (fresh + 0.5) * grid.voxel_size_m)
            travels.append(np.full(len(fresh), travel))
        if not centres:
            return Way(np.empty((0, 3)), np.empty(0))
        return Way(np.concatenate(centres), np.concatenate(travels))

    def _places(
        self, motion: Motion, travel: float, points: NDArray[np.float64], link: NDArray[np.int32]
    ) -> NDArray[np.float64]:
        """Points of links, shape (n, 3), after some travel, world frame [m]."""
        here = {**self._joints, motion.joint: self._joints[motion.joint] + motion.direction * travel}
        pose = self._machine.world_from_link_array(self._machine.positions(here)[None])[0, link]
        moved: NDArray[np.float64] = np.einsum("nij,nj->ni", pose[:, :3, :3], points) + pose[:, :3, 3]
        return moved

    def seen_by(self, camera: DepthCamera, centres: NDArray[np.float64]) -> NDArray[np.bool_]:
        """Which voxels one camera sees all of: in its image and range, nothing in them or before them.

        Args:
            camera: planar, without distortion.
            centres: of the voxels, shape (n, 3) [m].
        """
        seen = ~self._occupied[tuple(self._grid.index_of(centres).T)]
        turned = PLACES @ camera.world_from_camera[:3, :3]
        across = np.linalg.norm(turned[:, :2], axis=1, keepdims=True)
        outward = np.hstack([turned[:, :2] / np.maximum(across, 1e-9), np.zeros((len(PLACES), 1))])
        outward = outward @ camera.world_from_camera[:3, :3].T
        axis = camera.world_from_camera[:3, 2]
        for place, out in zip(PLACES, outward, strict=True):
            left = np.flatnonzero(seen)
            depth = (centres[left] - camera.centre_in_world) @ axis
            spare_m = SPARE_PX * np.abs(depth) / camera.intrinsics.fx
            points = centres[left] + place * self._grid.voxel_size_m + spare_m[:, None] * out
            seen[left] = self._sees(camera, points)
        return seen

    def _sees(self, camera: DepthCamera, points: NDArray[np.float64]) -> NDArray[np.bool_]:
        """Which points a camera sees, shape (n,)."""
        rays = points - camera.centre_in_world
        x, y, z = (rays @ camera.world_from_camera[:3, :3]).T
        lens = camera.intrinsics
        ahead = z > max(camera.min_depth_m, 1e-6)
        depth = np.where(ahead, z, 1.0)
        u, v = lens.fx * x / depth + lens.cx, lens.fy * y / depth + lens.cy
        inside = (
            ahead
            & (z < camera.max_depth_m)
            & (u > 0)
            & (u < camera.width - 1)
            & (v > 0)
            & (v < camera.height - 1)
        )
        if inside.any():
            directions = rays[inside].astype(np.float32)
            origins = np.repeat(camera.centre_in_world.astype(np.float32)[None], len(directions), axis=0)
            far = np.full(len(directions), 1e30, dtype=np.float32)
            # directions are not of unit length: 1 is the point itself
            hits = self._scene.run(origins, directions, dists=far, query="DISTANCE")
            inside[inside] = hits > 1.0 - BEFORE_M / np.linalg.norm(directions, axis=1)
        return inside

    def travel_in_view(self, way: Way, cameras: Sequence[DepthCamera], length: float) -> float:
        """How far the way is in view: the travel at which it meets the first voxel that no camera sees all of.

        Args:
            way: of the motion.
            cameras: that look.
            length: of the way; the answer if all of it is in view [m or rad along the joint].
        """
        seen = np.zeros(len(way.centres), dtype=np.bool_)
        for camera in cameras:
            left = np.flatnonzero(~seen)
            seen[left] = self.seen_by(camera, way.centres[left])
        return float(way.travel[~seen].min(initial=length))
