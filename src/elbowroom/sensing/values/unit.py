"""The unit of depth: where images end, against the watched box, since rooms are about as large as their grids."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from elbowroom.finding import Finding
from elbowroom.geometry import VoxelGrid
from elbowroom.sensing.values.thinned import UNITS_M, Thinned, way_through

KIND = "unit"
SLACK = 0.1
"""A point so far outside the grid still belongs to it, as a share of the grid's diagonal."""
LEAST_RAYS = 40
"""Of the looked at, that cross the grid and have a depth; with fewer nothing is said of a camera."""
LEAST_WAY = 0.05
"""Of the grid's diagonal: what a ray must go through it to count."""


class Ends(NamedTuple):
    """Where rays end that cross the grid.

    Fields:
        depths_m: distance from the camera, shape (n,) [m].
        enters_m, leaves_m: where the same rays enter the grid, and leave it [m].
    """

    depths_m: NDArray[np.float64]
    enters_m: NDArray[np.float64]
    leaves_m: NDArray[np.float64]


def together(parts: Sequence[Ends]) -> Ends:
    """The ends of all rays of several cameras."""
    return Ends(*(np.concatenate(each) for each in zip(*parts, strict=True)))


class Standing(NamedTuple):
    """How depths stand to the grid.

    Fields:
        median_m: of the distances [m].
        reach: median of distance over where the ray leaves the grid; in rooms from 0.4 to 1.3.
        behind, within: share of the rays that end behind the grid, and in it or before it.
    """

    median_m: float
    reach: float
    behind: float
    within: float


def is_far(stands: Standing) -> bool:
    """Surely another unit: far, and next to nothing ends in the grid; by much farther, little."""
    return (stands.reach >= 1.8 and stands.behind >= 0.9 and stands.within <= 0.1) or (
        stands.reach >= 3.0 and stands.behind >= 0.8 and stands.within <= 0.2
    )


def look_at_units(images: Sequence[Thinned], grid: VoxelGrid) -> list[Finding]:
    """Whether all that is measured lies behind the grid, or far before its end: then it is most likely the unit.

    Of all cameras together it stops. What only one of them says, or what is less sure, is a warning.

    Args:
        images: one of each camera.
        grid: the watched box.
    """
    ends = {image.camera.name: ends_of(image, grid) for image in images}
    usable = [image for image in images if ends[image.camera.name].depths_m.size >= LEAST_RAYS]
    if not usable:
        return []
    slack = SLACK * float(np.linalg.norm(grid.upper_m - grid.lower_m))
    names = tuple(image.camera.name for image in usable)
    every = together([ends[name] for name in names])
    stands = standing_of(every, slack)
    if is_far(stands) or (stands.reach >= 1.6 and stands.behind >= 0.65):
        return [Finding(KIND, names, _too_far(stands, usable[0], every, slack), is_far(stands))]
    if stands.reach <= 0.25:
        return [Finding(KIND, names, _too_near(stands, usable[0], every, slack), stands.reach <= 0.15)]
    return [found for image in usable for found in _one(image, ends[image.camera.name], slack)]


def _one(image: Thinned, ends: Ends, slack: float) -> list[Finding]:
    """One camera among others that are as they should be."""
    stands, about = standing_of(ends, slack), (image.camera.name,)
    if stands.reach >= 2.5 and stands.behind >= 0.95 and stands.within <= 0.03:
        return [Finding(KIND, about, _too_far(stands, image, ends, slack), stops=False)]
    return []  # one that is too near may look at a cabinet, and frees nothing


def ends_of(image: Thinned, grid: VoxelGrid) -> Ends:
    """All that was given, also beyond the camera's range, but for one number that fills much of what is.

    Args:
        image: of one camera.
        grid: the watched box.
    """
    enters, leaves = way_through(grid, image.camera.centre_in_world, image.rays_in_world)
    way = LEAST_WAY * float(np.linalg.norm(grid.upper_m - grid.lower_m))
    usable = image.given & (leaves - enters > way)
    beyond = image.here[usable & (image.here > image.camera.deepest_m)]
    if beyond.size:
        values, counts = np.unique(beyond, return_counts=True)
        if 2 * counts.max() >= beyond.size:
            usable &= image.here != values[np.argmax(counts)]
    depth = np.where(usable, image.here, 0).astype(np.float64)
    if image.camera.depth_kind == "planar":
        depth *= image.over_planar
    return Ends(depth[usable], enters[usable], leaves[usable])


def standing_of(ends: Ends, slack: float, factor: float = 1.0) -> Standing:
    """How depths stand to the grid.

    Args:
        ends: of some rays.
        slack: a point so far outside the grid still belongs to it [m].
        factor: as if depths were so many times what they are.
    """
    depths = ends.depths_m * factor
    return Standing(
        float(np.median(depths)),
        float(np.median(depths / np.maximum(ends.leaves_m, 1e-6))),
        float(np.mean(depths > ends.leaves_m + slack)),
        float(np.mean(depths <= ends.leaves_m + slack)),
    )


def _too_far(stands: Standing, image: Thinned, ends: Ends, slack: float) -> str:
    return (
        f"{stands.behind:.0%} of what looks through the grid ends behind it, {stands.median_m:.3g} m away (median), "
        f"{stands.reach:.2g} times as far as the grid's end: all before it reads free. Most likely the unit of "
        "depth: "
        f"{advice_on(stands, image, ends, slack)}. If there is truly nothing in the box, let it reach to a floor or "
        "wall "
        "that cameras see"
    )


def _too_near(stands: Standing, image: Thinned, ends: Ends, slack: float) -> str:
    return (
        f"what looks through the grid ends {stands.median_m:.3g} m away (median), at {stands.reach:.0%} of the "
        "way to the "
        "grid's end: next to nothing can read free. Most likely the unit of depth, or something before the lens: "
        f"{advice_on(stands, image, ends, slack)}"
    )


def advice_on(stands: Standing, image: Thinned, ends: Ends, slack: float) -> str:
    """Which unit fits better, if any does, in words.

    Args:
        stands: the ends to the grid.
        image: one of those that they are of.
        ends: of all rays.
        slack: as of `standing_of` [m].
    """
    unit, shift = image.unit_m, _shift(image.codes)
    if shift and 0.4 <= stands.reach / shift <= 1.3:
        return f"all values are multiples of {shift}, so bits are shifted: divide the raw values by {shift}"
    said = "check the scale" if unit is None else f"check depth_scale_m, which is {unit:g} m a unit"
    # rooms are about as large as their grids: the usual unit by which rays end nearest to where they leave it
    factors = (
        {
            f"depths {factor:g} times as large": factor
            for factor in (0.001, 0.01, 0.1, 0.25, 0.5, 2, 4, 10, 1000)
        }
        if unit is None
        else {f"depth_scale_m {each:g}": each / unit for each in UNITS_M if each != unit}
    )
    words = min(factors, key=lambda each: abs(np.log(stands.reach * factors[each] / 0.95)))
    fits = standing_of(ends, slack, factors[words])
    if not 0.4 <= fits.reach <= 1.4:
        return said
    return f"{said}; with {words} they would end at {fits.reach:.0%} of the way to it"


def _shift(codes: NDArray[np.int64] | None) -> int:
    """The greatest of 8, 16, 32 that divides all codes; 0: none does."""
    if codes is None:
        return 0
    return max((step for step in (8, 16, 32) if not (codes % step).any()), default=0)
