"""Colour pictures of solids by ray casting: soft daylight, one lamp, corners darkened. For people, not for sensors."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from elbowroom.geometry import VoxelGrid, looking_at
from elbowroom.geometry.ray_scene import RayScene
from elbowroom.simulate.solid import Solid

GREY = (0.62, 0.62, 0.60)
MACHINE = (0.86, 0.87, 0.90)
PAPER = (1.0, 1.0, 1.0)
CORNER_REACH_M = 0.7
"""So far round a point other surfaces darken it [m]."""
CORNER_RAYS = 10
OFF_M = 1e-3


@dataclass(frozen=True, slots=True)
class View:
    """From where a picture is taken.

    Args:
        eye_m, target_m: places, world frame [m].
        field_of_view_deg: horizontal [deg].
        width, height: [px].
    """

    eye_m: tuple[float, float, float]
    target_m: tuple[float, float, float]
    field_of_view_deg: float = 50.0
    width: int = 640
    height: int = 480


def colour_picture(
    solids: Sequence[Solid],
    view: View,
    *,
    lamp_m: tuple[float, float, float] = (-1.2, -2.6, 5.0),
    smooth: int = 2,
) -> Image.Image:
    """A picture of solids in their colours; what is behind them is white.

    Args:
        solids: what is shown; those of the machine without a colour of their own are light grey.
        view: from where.
        lamp_m: place of the lamp that casts shadows, world frame [m].
        smooth: rays per side of a pixel.

    Returns:
        RGB, view.width x view.height.
    """
    colours = [np.array(s.colour or (MACHINE if s.is_machine else GREY)) for s in solids]
    triangles = [s.vertices_in_world[s.mesh.faces] for s in solids]
    colour_of_face = np.repeat(np.array(colours), [len(t) for t in triangles], axis=0)
    return shaded(np.concatenate(triangles), colour_of_face, view, lamp_m=lamp_m, smooth=smooth)


def shaded(
    triangles: NDArray[np.float64],
    colours: NDArray[np.float64],
    view: View,
    *,
    lamp_m: tuple[float, float, float] = (-1.2, -2.6, 5.0),
    smooth: int = 2,
) -> Image.Image:
    """A picture of triangles.

    Args:
        triangles: shape (n, 3, 3), world frame [m].
        colours: linear, 0 to 1, one a triangle, shape (n, 3).
        view: from where.
        lamp_m: place of the lamp that casts shadows, world frame [m].
        smooth: rays per side of a pixel.

    Returns:
        RGB, view.width x view.height.
    """
    scene = RayScene(triangles.reshape(-1, 3), np.arange(3 * len(triangles)).reshape(-1, 3))
    normals = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-12)
    directions = _rays(view, smooth)
    origin = np.asarray(view.eye_m, dtype=np.float64)
    hit, far = scene.hits(_repeated(origin, len(directions)), directions.astype(np.float32))
    seen = hit >= 0
    face = hit[seen]
    normal, towards = normals[face], directions[seen]
    normal = np.where(np.sum(normal * towards, axis=1, keepdims=True) > 0, -normal, normal)
    point = origin + far[seen, None] * towards + OFF_M * normal
    light = 0.62 * _openness(scene, point, normal) + 0.55 * _lamplight(scene, point, normal, np.array(lamp_m))
    linear = np.tile(np.array(PAPER), (len(directions), 1))
    linear[seen] = colours[face] * light[:, None]
    block = linear.reshape(view.height, smooth, view.width, smooth, 3).mean(axis=(1, 3))
    return Image.fromarray((255 * np.clip(block, 0, 1) ** (1 / 2.2)).round().astype(np.uint8))


def _rays(view: View, smooth: int) -> NDArray[np.float64]:
    """Directions of all rays, row by row, shape (n, 3), world frame, of length 1."""
    focal = view.width / 2 / np.tan(np.radians(view.field_of_view_deg) / 2)
    u = ((np.arange(view.width * smooth) + 0.5) / smooth - view.width / 2) / focal
    v = ((np.arange(view.height * smooth) + 0.5) / smooth - view.height / 2) / focal
    in_camera = np.stack([*np.meshgrid(u, v), np.ones((len(v), len(u)))], axis=-1).reshape(-1, 3)
    in_camera /= np.linalg.norm(in_camera, axis=1, keepdims=True)
    return np.asarray(in_camera @ looking_at(view.eye_m, view.target_m)[:3, :3].T)


def _repeated(origin: NDArray[np.float64], count: int) -> NDArray[np.float32]:
    return np.ascontiguousarray(np.broadcast_to(origin.astype(np.float32), (count, 3)))


def _openness(
    scene: RayScene, point: NDArray[np.float64], normal: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Share of the hemisphere about each point that nothing near covers, 0 to 1."""
    random = np.random.default_rng(0)
    free = np.zeros(len(point))
    for _ in range(CORNER_RAYS):
        way = random.standard_normal(point.shape)
        way /= np.linalg.norm(way, axis=1, keepdims=True)
        way = normal * 1.001 + way
        way /= np.linalg.norm(way, axis=1, keepdims=True)
        far = scene.distances(point, way)
        free += np.clip(far / CORNER_REACH_M, 0.0, 1.0)
    return free / CORNER_RAYS


def _lamplight(
    scene: RayScene, point: NDArray[np.float64], normal: NDArray[np.float64], lamp: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Cosine of the angle at which a lamp's light falls in, 0 in shadow."""
    way = lamp - point
    length = np.linalg.norm(way, axis=1)
    way /= length[:, None]
    far = scene.distances(point, way)
    return np.where(far >= length, np.clip(np.sum(way * normal, axis=1), 0.0, 1.0), 0.0)


def cubes(
    labels: NDArray[np.uint8], grid: VoxelGrid, colours: NDArray[np.float64], view: View, *, smooth: int = 1
) -> Image.Image:
    """Voxels as cubes in the colours of their labels; label 0 is air.

    Args:
        labels: shape of the grid, index order x, y, z.
        grid: where they are.
        colours: linear, by label, shape (n, 3).
        view, smooth: as of `colour_picture`.
    """
    solid = np.pad(labels > 0, 1)
    unit = np.array([(0, 0), (1, 0), (1, 1), (0, 0), (1, 1), (0, 1)], dtype=float)
    triangles, of_face = [], []
    for axis in range(3):
        for side in (0, 1):
            bare = solid & ~np.roll(solid, 1 - 2 * side, axis=axis)
            index = np.argwhere(bare[1:-1, 1:-1, 1:-1])
            corner = np.zeros((6, 3))
            corner[:, [(axis + 1) % 3, (axis + 2) % 3]] = unit
            corner[:, axis] = side
            triangles.append(
                (grid.lower_m + (index[:, None, :] + corner) * grid.voxel_size_m).reshape(-1, 3, 3)
            )
            of_face.append(np.repeat(labels[tuple(index.T)], 2))
    return shaded(np.concatenate(triangles), colours[np.concatenate(of_face)], view, smooth=smooth)
