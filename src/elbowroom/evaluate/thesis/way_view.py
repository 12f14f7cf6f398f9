"""How far the way of a motion is in view, by exact rays: up to the first voxel that no one camera sees all of.

The way of a motion is the voxels that its moving links come to touch, without those that the body covers already. A
voxel is in view if no solid touches it and one camera alone sees all of it: its centre, and its eight corners
with half a pixel to spare, since that is how far a pixel looks to each side. Rays are cast against the exact
meshes of the room and of the machine where it stands. No image, no noise, no verdict.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from elbowroom.geometry import DepthCamera, VoxelGrid, bits
from elbowroom.geometry.ray_scene import RayScene
from elbowroom.machine import Machine, body_words
from elbowroom.motion import Motion
from elbowroom.simulate import Moment, true_occupancy
from elbowroom.simulate.kernels.touch import touch_surface

PLACES = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)] + [[0, 0, 0]]) * 0.49
"""Of a voxel, where it is looked at, in edges from its centre: just within its corners, and its centre."""
SPARE_PX = 0.5
"""So much farther out, across the ray, a corner has to be in view: a pixel looks half a pixel to each side."""
BEFORE_M = 2e-4
"""What is hit this little before a place hides it no more than rounding does [m]."""
STEP_IN_VOXELS = 1 / 8
"""At most so far any point of the moving links goes between two looks at where they are."""
PIECES = 64
"""In so many pieces the length of a point's path is measured; voxels are grown by what they then move in a step."""
ROUNDING_M = 1e-9
"""By this much more voxels are grown, so that rounding misses none [m]."""


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
        body_growth_m: by how much the body is grown that covers voxels [m]; None: half a voxel.
    """

    def __init__(
        self, machine: Machine, moment: Moment, grid: VoxelGrid, body_growth_m: float | None = None
    ) -> None:
        self._machine, self._joints, self._grid = machine, moment.joints, grid
        self._body = bits.unpack(body_words(machine, moment.joints, grid, body_growth_m), grid)
        self._occupied = true_occupancy(grid, moment).occupied
        firsts = np.cumsum([0] + [len(solid.mesh.vertices) for solid in moment.solids])
        self._scene = RayScene(
            np.concatenate([solid.vertices_in_world for solid in moment.solids]),
            np.concatenate(
                [solid.mesh.faces + first for solid, first in zip(moment.solids, firsts[:-1], strict=True)]
            ),
        )

    def way(self, motion: Motion, length: float) -> Way:
        """The voxels of a motion's way: none is missed, and none lies beside it by more than a sixteenth of a voxel.

        Args:
            motion: joint and direction.
            length: how far it is followed [m or rad along the joint]; below zero there is no way.
        """
        machine, grid = self._machine, self._grid
        moving = set(machine.moved_links(motion.joint)) & set(machine.checked_links)
        rows = [row for row, link in enumerate(machine.links) if link.name in moving]
        if length <= 0 or not rows:
            return Way(np.empty((0, 3)), np.empty(0))
        triangles = np.concatenate([machine.links[row].triangles for row in rows])
        link = np.repeat(rows, [len(machine.links[row].faces) for row in rows])

        def placed(travel: float) -> NDArray[np.float64]:
            here = {**self._joints, motion.joint: self._joints[motion.joint] + motion.direction * travel}
            pose = machine.world_from_link_array(machine.positions(here)[None])[0, link]
            moved: NDArray[np.float64] = np.einsum("nij,nkj->nki", pose[:, :3, :3], triangles)
            return moved + pose[:, None, :3, 3]

        def moved_m(travel: float) -> float:
            return float(np.linalg.norm(placed(travel) - placed(0.0), axis=2).max())

        # in pieces, since a chord is shorter than its arc
        path_m = PIECES * moved_m(length / PIECES)
        steps = int(np.ceil(path_m / (STEP_IN_VOXELS * grid.voxel_size_m)))
        step = length / steps
        # each step is looked at in its middle, with voxels grown by how far anything moves in half of it
        grown_m = moved_m(step / 2) + ROUNDING_M
        touched = self._body.astype(np.uint16)
        for number in range(steps):
            triangles_now = placed((number + 0.5) * step)
            touch_surface(triangles_now, grid.lower_m, grid.voxel_size_m, -grown_m, touched, number + 2)
        index = np.argwhere(touched > 1)
        first = touched[tuple(index.T)].astype(np.float64) - 2
        return Way(grid.lower_m + (index + 0.5) * grid.voxel_size_m, first * step)

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
            hits = self._scene.distances(origins, directions, far)
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
