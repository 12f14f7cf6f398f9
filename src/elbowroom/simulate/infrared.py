"""Infrared (amplitude) images, as a depth camera with its own lamp takes them beside depth."""

import zlib

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import gaussian_filter

from elbowroom.geometry import DepthCamera, invert_rigid
from elbowroom.simulate.board_plate import BoardLike, is_dark
from elbowroom.simulate.range_image import RangeImage, range_image
from elbowroom.simulate.solid import Moment, Solid

Image = NDArray[np.float64]
INK, PAPER = 0.08, 0.85
"""Reflectance of a printed board's squares."""
SURFACE, DARK_SURFACE = 0.45, 0.1
"""Reflectance of everything else."""
SUBPIXELS = 5
"""The board's pattern is sampled so many times across and down each pixel."""
BLUR_PX = 0.6
"""Standard deviation of the lens' blur [px]."""
NOISE_GREY = 2.0
"""Standard deviation of noise [grey values of 255]."""
FULL_GREY = 220.0
"""Grey value of white paper that faces the camera at `FULL_AT_M`; nearer is as bright: the lamp is turned down."""
FULL_AT_M = 1.5


def infrared_image(
    camera: DepthCamera,
    moment: Moment,
    board: BoardLike | None = None,
    plate: Solid | None = None,
    *,
    noise: bool = True,
    seed: int = 0,
) -> NDArray[np.uint8]:
    """What the camera's infrared image shows, shape (h, w), grey values.

    Light of a lamp at the camera falls off with the square of distance and with the cosine of incidence (Lambert). A
    printed board's pattern is averaged over each pixel; then come the lens' blur and noise.

    Args:
        camera: distorted or not.
        moment: what is in the room.
        board, plate: the printed board and the solid of `moment` that it is; None: there is none.
        noise: False: without noise, blur and all else as it is.
        seed: of the random numbers.
    """
    image = range_image(camera, moment)
    reflectance = np.where(image.dark, DARK_SURFACE, SURFACE)
    if board is not None and plate is not None:
        without = Moment(moment.time_s, tuple(s for s in moment.solids if s is not plate), moment.joints)
        shown = image.depth < range_image(camera, without).depth
        pattern = _pattern(camera, image, shown, board, plate)
        reflectance[shown] = np.where(np.isnan(pattern), PAPER, pattern)[shown]
    grey = FULL_GREY / PAPER * reflectance * _light(image)
    grey = gaussian_filter(grey, BLUR_PX, mode="nearest")
    if noise:
        name = zlib.crc32(camera.name.encode())
        random = np.random.Generator(np.random.SFC64([seed, moment.stamp_ns % 2**64, name, 1]))
        grey = grey + NOISE_GREY * random.standard_normal(grey.shape)
    return np.clip(np.rint(grey), 0, 255).astype(np.uint8)


def _light(image: RangeImage) -> Image:
    """Light that comes back from white surfaces, about 1 where the lamp is turned down."""
    x, y = image.rays.x.astype(np.float64), image.rays.y.astype(np.float64)
    z = np.where(np.isfinite(image.depth), image.depth, 100.0).astype(np.float64)
    points = np.stack([x * z, y * z, z], axis=-1)
    distance = np.linalg.norm(points, axis=-1)
    normal = np.cross(np.gradient(points, axis=1), np.gradient(points, axis=0))
    length = np.linalg.norm(normal, axis=-1)
    cosine = np.abs((normal * points).sum(axis=-1)) / np.maximum(length * distance, 1e-12)
    return np.minimum((FULL_AT_M / distance) ** 2, 1.0) * np.maximum(cosine, 0.05)


def _pattern(
    camera: DepthCamera,
    image: RangeImage,
    shown: NDArray[np.bool_],
    board: BoardLike,
    plate: Solid,
) -> Image:
    """Reflectance of the board's face, averaged over each pixel; NaN where the board is not seen or shows its back."""
    reflectance = np.full(image.depth.shape, np.nan)
    board_from_camera = invert_rigid(plate.world_from_solid) @ camera.world_from_camera
    rows, columns = np.nonzero(shown)
    if not len(rows) or board_from_camera[2, 3] >= 0:
        return reflectance
    window = (slice(rows.min(), rows.max() + 1), slice(columns.min(), columns.max() + 1))
    x, y = image.rays.x.astype(np.float64), image.rays.y.astype(np.float64)
    (x_down, x_right), (y_down, y_right) = np.gradient(x), np.gradient(y)
    total = np.zeros(x[window].shape)
    steps = (np.arange(SUBPIXELS) + 0.5) / SUBPIXELS - 0.5
    for down in steps:
        for right in steps:
            rays = np.stack(
                [
                    (x + x_right * right + x_down * down)[window],
                    (y + y_right * right + y_down * down)[window],
                    np.ones(total.shape),
                ],
                axis=-1,
            )
            rays = rays @ board_from_camera[:3, :3].T
            depth = -board_from_camera[2, 3] / np.where(np.abs(rays[..., 2]) < 1e-9, 1e-9, rays[..., 2])
            at = rays * depth[..., None] + board_from_camera[:3, 3]
            total += np.where(is_dark(board, at[..., 0], at[..., 1]), INK, PAPER)
    reflectance[window] = total / SUBPIXELS**2
    return reflectance
