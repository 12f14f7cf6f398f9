"""What cameras see in common: surfaces of each, compared with the images of the others."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from elbowroom.calibrate.refinement.kernels.overlap import (
    COMPARED,
    Overlap,
    Points,
    Sums,
    Surface,
    compare_points,
    fit_planes,
)
from elbowroom.geometry import DepthCamera, invert_rigid
from elbowroom.geometry.parallel import spread
from elbowroom.machine.rasterise import view_of
from elbowroom.sensing.planar_images import PlanarImages

HALF_WINDOW_PX = 3
BEND = 0.02
"""Of its depth, by how much a neighbourhood may bend and still be one surface."""
MOST_POINTS = 3000
"""Points of an image that are laid on another; more say the same again."""

Array = NDArray[Any]


@dataclass(frozen=True, slots=True, eq=False)
class Surfaces:
    """One camera's images as surfaces.

    Args:
        images: thinned, along the axis.
        moments: which moment each image belongs to, shape (n,).
        planes: plane q.p = 1 about each pixel, shape (n, height, width, 3), float32 [1/m]; zeros: none.
        points: thinned further, one entry per image.
    """

    images: PlanarImages
    moments: NDArray[np.int64]
    planes: NDArray[np.float32]
    points: tuple[Points, ...]

    @property
    def name(self) -> str:
        """Of the camera."""
        return self.images.camera.name


@dataclass(frozen=True, slots=True, eq=False)
class PairSums:
    """What the points of one camera say in the images of another.

    Args:
        one, other: names; the points are the one's.
        normal, gradient: by tile, shapes (tiles, 6, 6) and (tiles, 6): of the twist of the points in the other's frame.
        by_noise: the part of all tiles' normal equations that noise in the slopes of planes makes up, shape (6, 6).
        counts: points compared, agreeing, hidden, in conflict.
        offs: distance from the other's surface of the points that agree [m].
    """

    one: str
    other: str
    normal: Array
    gradient: Array
    by_noise: Array
    counts: NDArray[np.int64]
    offs: Array

    @property
    def compared(self) -> int:
        """Points that the other camera looks at and has a surface for."""
        return int(self.counts[COMPARED])


def surfaces(images: PlanarImages, moments: Sequence[int]) -> Surfaces:
    """Fits planes about the pixels of a camera's images.

    Args:
        images: one per moment.
        moments: which.
    """
    camera = images.thinned
    k, noise = camera.intrinsics, camera.noise
    half, view = half_window(camera), view_of(camera)
    planes = np.zeros((*images.depth_m.shape, 3), dtype=np.float32)
    rays = np.stack(
        [*np.meshgrid(*k.normalised(camera.width, camera.height)), np.ones((camera.height, camera.width))], -1
    )
    found = []
    for depth, plane in zip(images.depth_m, planes, strict=True):
        fit_planes(depth, view, half, BEND, plane)
        rows, columns = np.nonzero(plane.any(axis=-1))
        chosen = slice(None, None, max(1, len(rows) // MOST_POINTS))
        rows, columns = rows[chosen], columns[chosen]
        q, ray = plane[rows, columns].astype(float), rays[rows, columns]
        normals = q / np.linalg.norm(q, axis=1, keepdims=True)
        # the fit's own depth: the window's noise is averaged out
        points = ray / (q * ray).sum(axis=1, keepdims=True)
        reach = np.linalg.norm(ray, axis=1)
        distance = points[:, 2] * (reach if camera.depth_kind == "radial" else 1.0)
        sigma = noise.sigma(distance) if noise is not None else np.zeros(len(points))
        cosine = np.abs((normals * ray).sum(axis=1)) / reach
        found.append(Points(points, normals, sigma * cosine / (2 * half + 1)))
    return Surfaces(images, np.asarray(moments, dtype=np.int64), planes, tuple(found))


def half_window(camera: DepthCamera) -> int:
    """Half the window in which planes are fitted [px]."""
    return HALF_WINDOW_PX if camera.width >= 160 else 1


def pairs_of(views: Sequence[Surfaces]) -> list[tuple[Surfaces, Surfaces]]:
    """All ordered pairs of cameras that have a moment in common."""
    return [
        (one, other)
        for one in views
        for other in views
        if one is not other and len(np.intersect1d(one.moments, other.moments))
    ]


def pair_sums(
    pairs: Sequence[tuple[Surfaces, Surfaces]], poses: Mapping[str, Array], rule: Overlap
) -> list[PairSums]:
    """Compares all pairs.

    Args:
        pairs: points of the first, images of the second.
        poses: world_from_camera by name.
        rule: which points count.
    """

    def compare(pair: tuple[Surfaces, Surfaces]) -> PairSums:
        one, other = pair
        half = half_window(other.images.thinned)
        fitting = rule._replace(arm_px=float(np.sqrt((2 * half + 1) ** 2 * half * (half + 1) / 3)))
        tiles, offs = rule.tiles**2, []
        sums = Sums(
            normal=np.zeros((tiles, 6, 6)),
            gradient=np.zeros((tiles, 6)),
            by_noise=np.zeros((6, 6)),
            counts=np.zeros(4, dtype=np.int64),
        )
        other_from_one = invert_rigid(poses[other.name]) @ poses[one.name]
        view = view_of(other.images.thinned)
        _, rows, other_rows = np.intersect1d(one.moments, other.moments, return_indices=True)
        for row, at in zip(rows, other_rows, strict=True):
            points, surface = one.points[row], Surface(other.images.depth_m[at], other.planes[at])
            off = np.full(len(points.sigmas), np.nan)
            compare_points(view, surface, points, other_from_one, fitting, sums, off)
            offs.append(off[np.isfinite(off)])
        return PairSums(one.name, other.name, *sums, np.concatenate(offs))

    return spread(compare, pairs)
