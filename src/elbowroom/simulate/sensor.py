"""Depth images of a moment: rays cast for every pixel, then what a real sensor makes of them."""

import zlib
from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from weakref import WeakKeyDictionary

import numpy as np
from embreex.mesh_construction import TriangleMesh
from embreex.rtcore_scene import EmbreeScene
from numpy.typing import NDArray

from elbowroom.geometry import DepthCamera, invert_rigid
from elbowroom.geometry.parallel import spread
from elbowroom.sensing import DepthFrame
from elbowroom.simulate import _kernels_sensor as kernels
from elbowroom.simulate.rays import PixelRays, pixel_rays
from elbowroom.simulate.solid import Mesh, Moment, Solid

DARK_MISSING = 0.10
"""Share of pixels without return on a dark surface."""
GRAZING_MISSING = 0.30
"""Share of pixels without return on a surface that is seen at a grazing angle."""
GRAZING_TANGENT = 8.0
"""Tangent of the angle of incidence from which a surface is grazed: 83 degrees."""


def render(
    cameras: Sequence[DepthCamera],
    moment: Moment,
    *,
    noise: bool = True,
    seed: int = 0,
    flying_pixels: float = 0.3,
    missing: float = 0.002,
    threads: int | None = None,
) -> list[DepthFrame]:
    """What the cameras deliver at a moment, in their order.

    Depth is exact at pixel centres (up to float32) before noise. The same seed, moment and camera give the
    same image, whatever the other cameras and the threads are.

    Args:
        cameras: planar or radial, distorted or not. One without a noise model stays exact.
        moment: what is in the room; its time becomes the frames' stamp.
        noise: False: exact depth, whatever the cameras' models are.
        seed: of the random numbers.
        flying_pixels: share of the pixels at a depth step that get a depth between its two sides.
        missing: share of the pixels anywhere that have no return; dark and grazed surfaces lose more.
        threads: None: one a core.
    """
    static, moving = moment.static_solids, moment.moving_solids

    def one(camera: DepthCamera) -> DepthFrame:
        image = _static_image(camera, static).copy()
        for solid in moving:
            _cast(camera, solid, image)
        model = camera.noise if noise else None
        out = np.empty_like(image.depth)
        radial = camera.depth_kind == "radial"
        lengths = _rays_of(camera).lengths
        if model is None:
            kernels.as_delivered(image.depth, lengths, camera.min_depth_m, camera.max_depth_m, radial, out)
        else:
            random = np.random.Generator(
                np.random.SFC64([seed, moment.stamp_ns % 2**64, zlib.crc32(camera.name.encode())])
            )
            kernels.disturb(
                image.depth,
                image.dark,
                lengths,
                random.standard_normal(out.shape, dtype=np.float32),
                random.integers(0, 2**32, out.shape, dtype=np.uint32),
                (model.constant_m, model.linear, model.quadratic, model.offset_m),
                (
                    flying_pixels,
                    missing,
                    DARK_MISSING,
                    GRAZING_MISSING,
                    camera.min_depth_m,
                    camera.max_depth_m,
                    GRAZING_TANGENT / min(camera.intrinsics.fx, camera.intrinsics.fy),
                ),
                radial,
                out,
            )
        return DepthFrame(camera=camera.name, stamp_ns=moment.stamp_ns, depth_m=out)

    return spread(one, cameras, threads)


@dataclass(frozen=True, slots=True, eq=False)
class _Image:
    """Exact planar depth, infinite where nothing is [m], and where a dark surface is seen; both writable."""

    depth: NDArray[np.float32]
    dark: NDArray[np.bool_]

    def copy(self) -> "_Image":
        return _Image(self.depth.copy(), self.dark.copy())


@lru_cache(maxsize=64)
def _rays_of(camera: DepthCamera) -> PixelRays:
    return pixel_rays(camera)


@lru_cache(maxsize=64)
def _static_image(camera: DepthCamera, solids: tuple[Solid, ...]) -> _Image:
    shape = (camera.height, camera.width)
    image = _Image(np.full(shape, np.inf, dtype=np.float32), np.zeros(shape, dtype=np.bool_))
    for solid in solids:
        _cast(camera, solid, image)
    return image


_scenes: WeakKeyDictionary[Mesh, EmbreeScene] = WeakKeyDictionary()


def _scene_of(mesh: Mesh) -> EmbreeScene:
    scene = _scenes.get(mesh)
    if scene is None:
        scene = EmbreeScene()
        TriangleMesh(scene, mesh.vertices.astype(np.float32), mesh.faces)
        _scenes[mesh] = scene
    return scene


def _cast(camera: DepthCamera, solid: Solid, image: _Image) -> None:
    """Lets a solid cover what lies behind it: rays of the pixels about it, in the solid's own frame."""
    rays = _rays_of(camera)
    camera_from_solid = camera.camera_from_world @ solid.world_from_solid
    rows, columns = _rectangle(rays, camera_from_solid, solid.mesh.bounds)
    count = (rows[1] - rows[0]) * (columns[1] - columns[0])
    if count <= 0:
        return
    solid_from_camera = invert_rigid(camera_from_solid)
    turned = np.empty((count, 3), dtype=np.float32)
    known = np.empty(count, dtype=np.float32)
    kernels.turn_rays(rays.directions, solid_from_camera[:3, :3], rows, columns, image.depth, turned, known)
    origins = np.broadcast_to(solid_from_camera[:3, 3].astype(np.float32), turned.shape)
    hits = _scene_of(solid.mesh).run(origins, turned, dists=known, query="DISTANCE")
    kernels.keep_nearer(hits, solid.is_dark, rows, columns, image.depth, image.dark)


Range = tuple[int, int]


def _rectangle(
    rays: PixelRays, camera_from_solid: NDArray[np.float64], bounds: NDArray[np.float64]
) -> tuple[Range, Range]:
    """Rows and columns that a box in a solid's frame may be seen in, all if it reaches behind the camera."""
    corners = np.array([(x, y, z) for x in bounds[:, 0] for y in bounds[:, 1] for z in bounds[:, 2]])
    in_camera = corners @ camera_from_solid[:3, :3].T + camera_from_solid[:3, 3]
    if (in_camera[:, 2] <= 0).all():
        return (0, 0), (0, 0)
    if (in_camera[:, 2] < 1e-3).any():
        return (0, rays.y_range.shape[1]), (0, rays.x_range.shape[1])
    seen = in_camera[:, :2] / in_camera[:, 2:]
    low, high = seen.min(axis=0) - 1e-6, seen.max(axis=0) + 1e-6
    return _range(rays.y_range, low[1], high[1]), _range(rays.x_range, low[0], high[0])


def _range(ranges: NDArray[np.float64], low: float, high: float) -> Range:
    """First and one past the last row (or column) whose pixels' rays meet an interval."""
    meeting = np.flatnonzero((ranges[0] <= high) & (ranges[1] >= low))
    return (int(meeting[0]), int(meeting[-1]) + 1) if len(meeting) else (0, 0)
