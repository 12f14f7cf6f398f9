"""Exact depth of solids at pixel centres, by rays that are cast in each solid's own frame.

A ray-casting scene is built once for each mesh and kept; a solid that moves costs no new scene, its rays are
turned instead. What never moves is cast once for each camera.
"""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from elbowroom.geometry import DepthCamera
from elbowroom.geometry.kept import kept
from elbowroom.geometry.ray_scene import RayScene
from elbowroom.sensing.rays import PixelRays, pixel_rays
from elbowroom.simulate.kernels import sensor as kernels
from elbowroom.simulate.solid import Mesh, Moment, Solid

CAMERAS_KEPT = 64
"""For so many cameras, rays and the image of what never moves are kept."""


@dataclass(frozen=True, slots=True, eq=False)
class RangeImage:
    """What one camera sees, before its sensor makes depth of it.

    Args:
        depth: planar depth at pixel centres, infinite where nothing is, float32, shape (h, w) [m].
        dark: where a dark surface is seen, shape (h, w).
        rays: the pixels' rays.
    """

    depth: NDArray[np.float32]
    dark: NDArray[np.bool_]
    rays: PixelRays


def range_image(camera: DepthCamera, moment: Moment) -> RangeImage:
    """Casts the rays of one camera.

    Args:
        camera: distorted or not; its range, noise and kind of depth play no part here.
        moment: the solids.

    Raises:
        CameraError: the lens model folds back within the image.
    """
    still = _static_image(camera, moment.static_solids)
    image = RangeImage(still.depth.copy(), still.dark.copy(), still.rays)
    _cast_all(camera, moment.moving_solids, image)
    return image


@lru_cache(maxsize=CAMERAS_KEPT)
def _static_image(camera: DepthCamera, solids: tuple[Solid, ...]) -> RangeImage:
    shape = (camera.height, camera.width)
    nothing = np.full(shape, np.inf, dtype=np.float32)
    image = RangeImage(nothing, np.zeros(shape, dtype=np.bool_), pixel_rays(camera))
    _cast_all(camera, solids, image)
    return image


def _cast_all(camera: DepthCamera, solids: tuple[Solid, ...], image: RangeImage) -> None:
    camera_from_world = camera.camera_from_world
    for solid in solids:
        _cast(camera_from_world, solid, image)


def _cast(camera_from_world: NDArray[np.float64], solid: Solid, image: RangeImage) -> None:
    """Lets a solid cover what lies behind it; only pixels about the mesh's boxes are cast."""
    origin, pixels, turned, known = kernels.gather_rays(
        solid.mesh.boxes,
        solid.world_from_solid,
        camera_from_world,
        image.rays,
        image.depth,
    )
    if len(pixels):
        # all rays share one origin: an array of strides (0, 4) over three numbers
        origins = np.ndarray(turned.shape, dtype=np.float32, buffer=origin.data, strides=(0, 4))
        hits = _scene_of(solid.mesh).distances(origins, turned, known)
        kernels.keep_nearer(hits, pixels, solid.is_dark, image.depth, image.dark)


@kept
def _scene_of(mesh: Mesh) -> RayScene:
    return RayScene(mesh.vertices, mesh.faces)
