"""A plate with holes in a depth image: which pixels are near, next to holes, and the plane that they lie in."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from elbowroom.extras import package
from elbowroom.geometry import DepthCamera
from elbowroom.sensing.rays import PixelRays

Image = NDArray[np.float32]
STEP_M = 0.06
"""What is behind a hole must be so much farther than the plate [m]."""
STEP_SIGMAS = 5.0
NEAREST_M, FARTHEST_M, DEPTH_RATIO = 0.35, 8.0, 1.3
WINDOW_SQUARES = 1.3
PLANES = 3
HYPOTHESES = 200
SAMPLE = 400
LEAST_PIXELS = 20


@dataclass(frozen=True, slots=True, eq=False)
class View:
    """A depth image and what is known of its camera.

    Args:
        camera: with the intrinsics that the site says.
        rays: of its pixels, by these intrinsics.
        z: planar depth, 0 where there is no return, float32, shape (h, w) [m].
    """

    camera: DepthCamera
    rays: PixelRays
    z: Image

    def sigma(self, z: NDArray[np.floating]) -> NDArray[np.float64]:
        """Standard deviation of depth [m], the shape of z; of a camera without a noise model a millimetre."""
        noise = self.camera.noise
        return np.full(np.shape(z), 0.001) if noise is None else np.maximum(noise.sigma(z), 0.001)


@dataclass(frozen=True, slots=True, eq=False)
class Plate:
    """A plane in the camera's frame, 1 / z = a x + b y + c over x = X/Z and y = Y/Z, and about where the plate is.

    Args:
        inverse: (a, b, c), shape (3,) [1/m].
        centre_in_camera: middle of its pixels, shape (3,) [m].
    """

    inverse: NDArray[np.float64]
    centre_in_camera: NDArray[np.float64]

    @property
    def camera_from_plane(self) -> NDArray[np.float64]:
        """A frame in the plane, shape (4, 4): origin at the middle, z away from the camera, x as the image's."""
        away = self.inverse / np.linalg.norm(self.inverse)
        across = np.array([1.0, 0.0, 0.0]) - away[0] * away
        across /= np.linalg.norm(across)
        frame = np.eye(4)
        frame[:3, :3] = np.stack([across, np.cross(away, across), away], axis=1)
        frame[:3, 3] = self.centre_in_camera
        return frame


def beside_holes(view: View, square_m: float) -> NDArray[np.bool_]:
    """Pixels with something much farther within a square's width, and nothing as much nearer, shape (h, w).

    A slanted wall has both: inverse depth is linear over the image of a plane, so that its least and greatest over a
    window lie evenly about the middle; with a plate before it they do not. At the image's edge windows are cut and say
    nothing.
    """
    cv2 = package("cv2")
    z = view.z
    with np.errstate(divide="ignore"):
        inverse = (1 / z).astype(np.float32)
    nearness = np.where(z > 0, inverse, 0).astype(np.float32)
    found = np.zeros(z.shape, dtype=np.bool_)
    focal = max(view.camera.intrinsics.fx, view.camera.intrinsics.fy)
    middle = NEAREST_M
    while middle < FARTHEST_M:
        bound = middle * DEPTH_RATIO
        here = (z >= middle) & (z < bound)
        if here.any():
            rows, columns = np.flatnonzero(here.any(axis=1)), np.flatnonzero(here.any(axis=0))
            size = max(3, 2 * round(WINDOW_SQUARES * square_m * focal / middle / 2) + 1)
            half = size // 2
            part = (
                slice(max(rows[0] - half, 0), rows[-1] + half + 1),
                slice(max(columns[0] - half, 0), columns[-1] + half + 1),
            )
            window = np.ones((size, size), np.uint8)
            farthest, nearest = cv2.erode(inverse[part], window), cv2.dilate(nearness[part], window)
            step = np.maximum(STEP_M, STEP_SIGMAS * view.sigma(z[part]))
            uneven = 2 * nearness[part] - farthest - nearest
            here[:half] = here[-half:] = here[:, :half] = here[:, -half:] = False
            with np.errstate(invalid="ignore"):  # where nothing at all returned
                found[part] |= here[part] & (uneven * z[part] ** 2 > step)
        middle = bound
    return found


def plates(view: View, square_m: float, reach_m: float, random: np.random.Generator) -> Iterator[Plate]:
    """Planes of plates with holes, the one with most pixels first.

    Args:
        view: the depth image.
        square_m: edge of a square [m].
        reach_m: diagonal of the board [m].
        random: source of randomness.
    """
    rows, columns = np.nonzero(beside_holes(view, square_m))
    for _ in range(PLANES):
        if len(rows) < LEAST_PIXELS:
            return
        points = _points(view, rows, columns)
        seed = _most_in_plane(points, view.sigma(points[:, 2]), reach_m, random)
        if seed is None:
            return
        inside = np.linalg.norm(points - seed[1], axis=1) < reach_m
        inverse, fits = _fitted(points, view.sigma(points[:, 2]), inside, seed[0])
        if fits.sum() < LEAST_PIXELS:
            return
        yield Plate(inverse, _on_plane(inverse, np.median(points[fits], axis=0)))
        rows, columns = rows[~fits], columns[~fits]


def _points(view: View, rows: NDArray[np.int64], columns: NDArray[np.int64]) -> NDArray[np.float64]:
    z = view.z[rows, columns].astype(np.float64)
    return np.stack([view.rays.x[rows, columns] * z, view.rays.y[rows, columns] * z, z], axis=1)


def _on_plane(inverse: NDArray[np.float64], point: NDArray[np.float64]) -> NDArray[np.float64]:
    """Where the ray of a point meets the plane."""
    return np.asarray(point / float(inverse @ point))


def _most_in_plane(
    points: NDArray[np.float64], sigma: NDArray[np.float64], reach_m: float, random: np.random.Generator
) -> tuple[NDArray[np.float64], NDArray[np.float64]] | None:
    """Of planes through three near points the one with most points about them: (a, b, c) and a point of it."""
    few = random.permutation(len(points))[:SAMPLE]
    some, scatter = points[few], sigma[few]
    first = random.integers(0, len(some), HYPOTHESES)
    distance = np.linalg.norm(some[first, None] - some[None], axis=2)
    near = distance < 0.6 * reach_m
    # two more points within reach of the first, by random keys
    keys = np.where(near, random.random(near.shape), 2.0)
    second, third = np.argpartition(keys, 2, axis=1)[:, :2].T
    a, b, c = some[first], some[second], some[third]
    normal = np.cross(b - a, c - a)
    offset = (normal * a).sum(axis=1)
    wide = np.linalg.norm(normal, axis=1) > 0.01 * reach_m**2
    usable = wide & (np.abs(offset) > 1e-9) & (near.sum(axis=1) > 3)
    if not usable.any():
        return None
    inverse = normal[usable] / offset[usable, None]
    residual = np.abs(1.0 - inverse @ some.T) * some[:, 2]
    count = ((residual < 3 * scatter + 0.004) & (distance[usable] < 0.8 * reach_m)).sum(axis=1)
    best = int(np.argmax(count))
    return inverse[best], some[first[usable][best]]


def _fitted(
    points: NDArray[np.float64],
    sigma: NDArray[np.float64],
    inside: NDArray[np.bool_],
    inverse: NDArray[np.float64],
) -> tuple[NDArray[np.float64], NDArray[np.bool_]]:
    """The plane by weighted least squares over the pixels that fit it, and which these are."""
    z = points[:, 2]
    rays = points / z[:, None]
    fits = inside
    for band in (4.0, 3.0, 3.0):
        fits = inside & (np.abs(z - 1 / np.maximum(rays @ inverse, 1e-6)) < band * sigma + 0.003)
        if fits.sum() < LEAST_PIXELS:
            break
        # inverse depth is linear over the image; its sigma is sigma(z) / z^2
        weight = (z**2 / sigma)[fits, None]
        inverse = np.asarray(
            np.linalg.lstsq(rays[fits] * weight, weight[:, 0] / z[fits], rcond=None)[0], dtype=np.float64
        )
    return inverse, fits
