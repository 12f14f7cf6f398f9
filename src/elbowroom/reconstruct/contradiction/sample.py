"""Some pixels of an image that surely measured a surface, and the image about any place in it."""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from elbowroom.reconstruct.contradiction.eye import Array, Eye

SAMPLES = 256
"""So many pixels of an image at most are points that other cameras are asked about,"""
LOOKED_AT = 1024
"""of so many, evenly over it, that are looked at: some lie on no surface."""
SPAN = 0.006
"""To every side of a place so far is looked about it, as a tangent: what calibrations of the usual size leave open."""
ONE_SURFACE = 0.03
"""A pixel lies on a surface if inverse depth, which is linear on a plane, bends by less than this share about it."""
SEEN = 0.5
"""Of the pixels about a place at least this share must have a return for the image to say anything of it."""

Image = NDArray[np.float32]
Whole = NDArray[np.intp]


@dataclass(frozen=True, slots=True, eq=False)
class Sample:
    """One image, to be asked.

    Args:
        image: depths, shape (height, width) [m, the camera's kind]; 0 where there is no return.
        stamp_ns: time of exposure; None: unknown.
        u, v: columns and rows of pixels that measured a surface, shape (n,) [px].
        depth_m: what they measured, as it came, shape (n,) [m].
    """

    image: Image
    stamp_ns: int | None
    u: Array
    v: Array
    depth_m: Array

    @classmethod
    def none(cls, image: Image, stamp_ns: int | None) -> "Sample":
        """An image to look things up in, without points of its own.

        Args:
            image: shape (height, width) [m].
            stamp_ns: time of exposure; None: unknown.
        """
        return cls(image, stamp_ns, *np.zeros((3, 0)))


def sample_of(eye: Eye, depth_m: Image, stamp_ns: int | None = None, samples: int = SAMPLES) -> Sample:
    """Takes a sample of an image.

    Args:
        eye: of the camera.
        depth_m: its image, shape (height, width) [m].
        stamp_ns: time of exposure; None: unknown.
        samples: how many pixels are taken at most.
    """
    u, v = places(eye.width, eye.height, LOOKED_AT * samples // SAMPLES)
    if not len(u):
        return Sample.none(depth_m, stamp_ns)
    rows, columns = v + _CROSS[:, :1], u + _CROSS[:, 1:]
    here, left, right, above, below = _valid(eye, depth_m[rows, columns])
    with np.errstate(divide="ignore", invalid="ignore"):
        across, down = here / left + here / right - 2.0, here / above + here / below - 2.0
        # NaN and infinity, where a neighbour has no return, are no surface
        flat = (here > 0) & (np.abs(across) < ONE_SURFACE) & (np.abs(down) < ONE_SURFACE)
    taken = np.flatnonzero(flat)
    if len(taken) > samples:
        taken = taken[np.linspace(0, len(taken) - 1, samples).astype(np.intp)]
    return Sample(depth_m, stamp_ns, u[taken].astype(float), v[taken].astype(float), here[taken])


def seen_part(mask: NDArray[np.bool_] | None, depth_m: Image) -> Image:
    """An image without what is masked.

    Args:
        mask: of pixels that say nothing, shape (height, width); None: none do.
        depth_m: shape (height, width) [m].
    """
    return depth_m if mask is None else np.where(mask, np.float32(0), depth_m)


def about(eye: Eye, image: Image, u: Array, v: Array) -> tuple[Array, Array, NDArray[np.bool_]]:
    """The least and the greatest depth about places in an image, and which places it says anything of.

    Args:
        eye: of the camera.
        image: as it came, shape (height, width) [m].
        u, v: places, shape (n,) [px]; any that are not in the image are none that it says anything of.

    Returns:
        Least and greatest depth [m], and whether anything is said, each of shape (n,).
    """
    steps = _steps(eye)
    reach = int(steps.max())
    height, width = image.shape
    inside = (u >= reach) & (u <= width - 1 - reach) & (v >= reach) & (v <= height - 1 - reach)
    columns, rows = np.where(inside, np.rint(u), reach), np.where(inside, np.rint(v), reach)
    first = rows.astype(np.intp) * width + columns.astype(np.intp)
    offsets = (steps[:, None] * width + steps[None, :]).reshape(-1, 1)
    if image.size <= int(offsets.max()) * 2 + 1:
        nothing = np.zeros(len(u))
        return nothing, nothing, np.zeros(len(u), dtype=np.bool_)
    depth = _valid(eye, image.reshape(-1)[first + offsets])
    valid = depth > 0
    least = np.where(valid, depth, np.inf).min(axis=0)
    said = inside & (valid.sum(axis=0) >= SEEN * len(offsets))
    return least * eye.scale, depth.max(axis=0) * eye.scale, said


def places(width: int, height: int, samples: int) -> tuple[Whole, Whole]:
    """Columns and rows of about so many pixels, evenly over an image, each with neighbours on all sides.

    Args:
        width, height: of the image [px].
        samples: how many.
    """
    across = max(1, round(np.sqrt(samples * width / height)))
    down = max(1, round(samples / across))
    u = np.unique(((np.arange(across) + 0.5) * width / across).astype(np.intp))
    v = np.unique(((np.arange(down) + 0.5) * height / down).astype(np.intp))
    u, v = u[(u >= 1) & (u < width - 1)], v[(v >= 1) & (v < height - 1)]
    grid = np.meshgrid(u, v)
    return grid[0].reshape(-1), grid[1].reshape(-1)


_CROSS = np.array([(0, 0), (0, -1), (0, 1), (-1, 0), (1, 0)])
"""A pixel, those to the left and right of it, those above and below it: rows and columns."""


def _steps(eye: Eye) -> Whole:
    """Offsets at which the image about a place is looked at, along each side [px]."""
    reach = max(1.0, SPAN * max(eye.intrinsics.fx, eye.intrinsics.fy))
    reach = min(reach, min(eye.width, eye.height) / 8)
    return _offsets(reach)


@lru_cache(maxsize=256)
def _offsets(reach: float) -> Whole:
    """Of so far to both sides, halfway, and none."""
    return np.unique(np.rint(np.array((-1.0, -0.5, 0.0, 0.5, 1.0)) * reach)).astype(np.intp)


def _valid(eye: Eye, depth_m: NDArray[np.floating]) -> Array:
    """Depths as they came [m]; 0 where there is no return."""
    raw = depth_m.astype(np.float64)
    valid = (raw > 0) & (raw >= eye.least_m) & (raw <= eye.greatest_m) & (raw < np.inf)
    return np.where(valid, raw, 0.0)
