"""Depth images of a moment, as real sensors deliver them."""

import zlib
from collections.abc import Sequence

import numpy as np

from elbowroom.errors import InputError
from elbowroom.geometry import DepthCamera
from elbowroom.geometry.parallel import spread
from elbowroom.sensing import DepthFrame, NoiseModel
from elbowroom.simulate.inside import check_outside
from elbowroom.simulate.kernels import sensor as kernels
from elbowroom.simulate.range_image import RangeImage, range_image
from elbowroom.simulate.solid import Moment

DARK_MISSING = 0.10
"""Share of pixels without return on a dark surface."""
GRAZING_MISSING = 0.02
"""Share of pixels without return on a surface that is seen at a grazing angle: of the two real cameras that were
measured the worse one's (docs/benchmarks.md, "Pixels that real cameras lose"), rounded up."""
GRAZING_TANGENT = 8.0
"""Tangent of the angle of incidence from which a surface is grazed: 83 degrees."""


def render(
    cameras: Sequence[DepthCamera],
    moment: Moment,
    *,
    noise: bool = True,
    seed: int = 0,
    flying_pixels: float = 0.3,
    missing: float = 0.0005,
) -> list[DepthFrame]:
    """What the cameras deliver at a moment, in their order.

    Depth is exact at pixel centres (up to float32) before noise. The same seed, moment and camera give the
    same image, whatever the other cameras and the threads are.

    Args:
        cameras: planar or radial, distorted or not. One without a noise model stays exact: no noise, no
            flying pixels, no missing returns but for what lies outside its range.
        moment: what is in the room; its time becomes the frames' stamp.
        noise: False: all cameras are exact, whatever their models are.
        seed: of the random numbers, 0 or more.
        flying_pixels: share of the pixels at a step in depth that get a depth between its two sides.
        missing: share of the pixels anywhere that have no return; dark and grazed surfaces lose more. Of real cameras
            0.03 % was measured.

    Raises:
        InputError: a share outside 0 to 1, a seed below 0, a camera inside a solid that never moves.
        CameraError: a lens model that folds back within the image.
    """
    for name, share in (("flying_pixels", flying_pixels), ("missing", missing)):
        if not 0 <= share <= 1:
            raise InputError(f"render: {name} is {share}, must be a share from 0 to 1")
    if seed < 0:
        raise InputError(f"render: seed is {seed}, must be 0 or more")
    check_outside(cameras, moment.static_solids)

    def one(camera: DepthCamera) -> DepthFrame:
        image = range_image(camera, moment)
        depth = np.empty_like(image.depth)
        if noise and camera.noise is not None:
            random = _random(seed, moment, camera)
            _disturb(image, camera, camera.noise, flying_pixels, missing, random, depth)
        else:
            limits = (camera.min_depth_m, camera.max_depth_m)
            kernels.as_delivered(image.depth, image.rays, limits, camera.depth_kind == "radial", depth)
        return DepthFrame(camera=camera.name, stamp_ns=moment.stamp_ns, depth_m=depth)

    return spread(one, cameras)


def _random(seed: int, moment: Moment, camera: DepthCamera) -> np.random.Generator:
    """Random numbers that only seed, time and the camera's name determine."""
    name = zlib.crc32(camera.name.encode())
    return np.random.Generator(np.random.SFC64([seed, moment.stamp_ns % 2**64, name]))


def _disturb(
    image: RangeImage,
    camera: DepthCamera,
    model: NoiseModel,
    flying_pixels: float,
    missing: float,
    random: np.random.Generator,
    depth: np.ndarray,
) -> None:
    sensor = kernels.Sensor(
        flying=flying_pixels,
        missing=missing,
        dark_missing=DARK_MISSING,
        grazing_missing=GRAZING_MISSING,
        grazed=GRAZING_TANGENT / min(camera.intrinsics.fx, camera.intrinsics.fy),
        least=camera.min_depth_m,
        greatest=camera.max_depth_m,
        constant=model.constant_m,
        linear=model.linear,
        quadratic=model.quadratic,
        offset=model.offset_m,
        radial=camera.depth_kind == "radial",
    )
    normal = random.standard_normal(depth.shape, dtype=np.float32)
    uniform = random.integers(0, 2**32, depth.shape, dtype=np.uint32)
    kernels.disturb(image.depth, image.dark, image.rays, normal, uniform, sensor, depth)
