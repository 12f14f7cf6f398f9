"""A person who walks through the planned room, and who sees them where."""

import itertools
import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from elbowroom.geometry import DepthCamera
from elbowroom.geometry.lens import project
from elbowroom.geometry.ray_scene import RayScene
from elbowroom.page.plan.ground import Ground
from elbowroom.page.plan.layout import Layout, PlacedPerson
from elbowroom.page.plan.stale import Stop, never, unless

Array = NDArray[np.float64]
STEP_M = 0.1
"""Of a walk [m]."""
FLOOR_STEP_M = 0.25
"""Between two places of the floor that are asked [m]."""
POINTS = 160
"""So many places of a body's surface stand for it."""
SHARE = 0.05
"""A camera sees a person of whom it sees so much of the surface."""
OFF_M = 0.01
"""A place of a body lies so far before its surface, so that the surface does not hide it from itself [m]."""
WALKER = "walker"


@dataclass(frozen=True, slots=True)
class Place:
    """Somebody at a place.

    Args:
        person: where they stand.
        by: names of the cameras that see them.
        seen_pct: how much of the body's surface some camera sees [%].
    """

    person: PlacedPerson
    by: tuple[str, ...]
    seen_pct: float


@dataclass(slots=True, eq=False)
class Watch:
    """Asks of places of a room who sees somebody there.

    Args:
        ground: the room.
        layout: cameras, machine, things and other people.
    """

    ground: Ground
    layout: Layout
    _scene: RayScene | None = field(init=False)
    _triangles: Array = field(init=False)

    def __post_init__(self) -> None:
        others = tuple(one for one in self.layout.people if one.name != WALKER)
        there = replace(self.layout, people=others)
        moment = self.ground.moment_of(there, self.ground.fixed_with(there))
        parts = [solid.vertices_in_world[solid.mesh.faces] for solid in moment.solids]
        self._triangles = np.concatenate([np.zeros((0, 3, 3)), *parts])
        self._scene = _scene(self._triangles) if len(self._triangles) else None

    def at(self, person: PlacedPerson) -> Place:
        """Who sees somebody.

        Args:
            person: who stands there.
        """
        body = np.concatenate([s.vertices_in_world[s.mesh.faces] for s in person.solids(self.ground.floor_m)])
        points, normals = _surface(body)
        own, by = _scene(body), []
        seen = np.zeros(len(points), dtype=bool)
        for placed in self.layout.cameras:
            mine = self._seen(placed.camera, points, normals, own)
            if mine.mean() >= SHARE:
                by.append(placed.name)
            seen |= mine
        return Place(person, tuple(by), 100.0 * float(seen.mean()))

    def _seen(self, camera: DepthCamera, points: Array, normals: Array, own: RayScene) -> NDArray[np.bool_]:
        """Which places of a body a camera sees."""
        eye = camera.centre_in_world
        ways = eye - points
        seen = np.einsum("ij,ij->i", ways, normals) > 0
        seen &= _in_image(camera, points)
        index = np.flatnonzero(seen)
        if len(index):
            starts, rays = points[index].astype(np.float32), ways[index].astype(np.float32)
            hidden = own.occluded(starts, rays, np.ones(len(index)))
            if self._scene is not None:
                # up to just before the camera: it may hang on a wall
                hidden |= self._scene.occluded(starts, rays, np.full(len(index), 0.999))
            seen[index[hidden]] = False
        return seen


def walked(
    ground: Ground,
    layout: Layout,
    way_m: Sequence[tuple[float, float]],
    height_m: float = 1.75,
    is_stale: Stop = never,
) -> Iterator[Place]:
    """Walks along a way, and says at each step who sees the walker.

    Args:
        ground: the room.
        layout: where all else is.
        way_m: corners of the way, x and y [m]; two at least.
        height_m: of the walker [m].
        is_stale: asked before each step.

    Raises:
        Stale: nobody wants to know any more.
    """
    watch, corners = Watch(ground, layout), np.array(way_m, dtype=np.float64)
    for start, end in itertools.pairwise(corners):
        length = float(np.linalg.norm(end - start))
        heading = math.atan2(end[1] - start[1], end[0] - start[0])
        for share in np.linspace(0.0, 1.0, max(2, round(length / STEP_M) + 1)):
            unless(is_stale)
            x, y = start + share * (end - start)
            yield watch.at(PlacedPerson(WALKER, float(x), float(y), heading, height_m))


def over_floor(
    ground: Ground, layout: Layout, height_m: float = 1.75, is_stale: Stop = never
) -> Iterator[Place]:
    """Asks all over the floor, row by row, who sees somebody there; places where a thing stands are left out.

    Args:
        ground: the room.
        layout: where all else is.
        height_m: of who stands there [m].
        is_stale: asked before each place.

    Raises:
        Stale: nobody wants to know any more.
    """
    watch, fixed = Watch(ground, layout), ground.fixed_with(layout)
    lower, upper = np.stack([ground.grid.lower_m, ground.grid.upper_m])[:, :2]
    free = None if fixed is None else ~fixed.occupied(ground.grid)
    for y in _rows(lower[1], upper[1]):
        for x in _rows(lower[0], upper[0]):
            unless(is_stale)
            if free is not None and not _has_room(ground, free, float(x), float(y), height_m):
                continue
            yield watch.at(PlacedPerson(WALKER, float(x), float(y), 0.0, height_m))


def _rows(low: float, high: float) -> Array:
    count = max(1, round((high - low) / FLOOR_STEP_M))
    return np.asarray(low + (np.arange(count) + 0.5) * (high - low) / count)


def _has_room(ground: Ground, free: NDArray[np.bool_], x: float, y: float, height_m: float) -> bool:
    """Whether nothing fixed stands at a place, between knee and head."""
    grid = ground.grid
    heights = np.arange(ground.floor_m + 0.3, ground.floor_m + height_m, grid.voxel_size_m)
    index = grid.index_of(np.stack([np.full_like(heights, x), np.full_like(heights, y), heights], axis=1))
    inside = ((index >= 0) & (index < grid.shape)).all(axis=1)
    return bool(free[tuple(index[inside].T)].all())


def _surface(body: Array) -> tuple[Array, Array]:
    """Places spread evenly over triangles, a little before them, and their normals, shape (n, 3) each."""
    normals = np.cross(body[:, 1] - body[:, 0], body[:, 2] - body[:, 0])
    areas = np.linalg.norm(normals, axis=1)
    normals /= np.maximum(areas, 1e-12)[:, None]
    edges = np.cumsum(areas)
    # the middles of equal shares of the whole area
    chosen = np.searchsorted(edges, (np.arange(POINTS) + 0.5) / POINTS * edges[-1])
    return body[chosen].mean(axis=1) + OFF_M * normals[chosen], normals[chosen]


def _in_image(camera: DepthCamera, points: Array) -> NDArray[np.bool_]:
    """Which points fall on a pixel, within the sensor's range."""
    local = (points - camera.centre_in_world) @ camera.world_from_camera[:3, :3]
    depth = local[:, 2] if camera.depth_kind == "planar" else np.linalg.norm(local, axis=1)
    ahead = local[:, 2] > 1e-6
    pixels = np.full((len(points), 2), -1.0)
    if ahead.any():
        pixels[ahead] = project(camera.intrinsics, local[ahead])[0]
    u, v = pixels.T
    within = (u >= -0.5) & (u < camera.width - 0.5) & (v >= -0.5) & (v < camera.height - 0.5)
    return np.asarray(ahead & within & (depth >= camera.min_depth_m) & (depth <= camera.max_depth_m))


def _scene(triangles: Array) -> RayScene:
    return RayScene(triangles.reshape(-1, 3), np.arange(3 * len(triangles)).reshape(-1, 3))
