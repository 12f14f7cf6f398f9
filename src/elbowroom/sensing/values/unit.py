"""The unit of depth: where returns lie, against the watched box and what a sensor reaches."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from elbowroom.finding import Finding
from elbowroom.geometry import VoxelGrid
from elbowroom.sensing.values.thinned import UNITS_M, Thinned, way_through

KIND = "unit"
SLACK = 0.1
"""A return so far outside the grid still belongs to it, as a share of the grid's diagonal."""
LEAST_RAYS = 40
"""Of the looked at, that cross the grid and have a return; with fewer nothing is said of a camera."""
THROUGH, NEAR, FARTHER = 0.95, 0.01, 1.5
"""All but all returns lie behind the grid, next to none in it, and the median lies so much farther than its end."""
SHORT = 0.25
"""All but all returns lie before this share of the way to the grid's middle."""
CLEAR_M = 0.05
FITS = 0.3
"""A unit by which so large a share of the returns lies in the grid is suggested."""
ABOUT = 0.8
"""Of the best share: units that come so near to it fit as well."""


class Standing(NamedTuple):
    """Where the returns of one camera lie that look through the grid.

    Fields:
        name: of the camera.
        rays: how many were looked at.
        median_m: median distance [m].
        farthest_m: the grid's farthest corner from the camera [m].
        behind, within: share that lies behind the grid, and in it, with some slack.
        short: share that lies well before the grid's middle.
    """

    name: str
    rays: int
    median_m: float
    farthest_m: float
    behind: float
    within: float
    short: float


def look_at_units(images: Sequence[Thinned], grid: VoxelGrid) -> list[Finding]:
    """Whether all returns lie behind the grid, or far before it: then it is most likely their unit.

    Args:
        images: one of each camera.
        grid: the watched box.
    """
    standing = {image.camera.name: _standing(image, grid, 1.0) for image in images}
    usable = [stands for stands in standing.values() if stands.rays >= LEAST_RAYS]
    if not usable:
        return []
    of = {image.camera.name: image for image in images}
    far = [stands for stands in usable if _is_far(stands)]
    if len(far) == len(usable):
        return [_too_far(far, of[far[0].name], grid, stops=True)]
    found = [_too_far([stands], of[stands.name], grid, stops=False) for stands in far]
    short = [stands for stands in usable if stands.short >= THROUGH]
    if len(short) == len(usable) and len(usable) > 1:
        return [_too_near(short, of[short[0].name], grid, stops=True)]
    return found + [_too_near([stands], of[stands.name], grid, stops=False) for stands in short]


def _standing(image: Thinned, grid: VoxelGrid, factor: float) -> Standing:
    """Where returns lie if depths are so many times what they are."""
    centre = image.camera.centre_in_world
    enters, leaves = way_through(grid, centre, image.rays_in_world)
    diagonal = float(np.linalg.norm(grid.upper_m - grid.lower_m))
    slack = SLACK * diagonal
    crosses = (leaves - enters > CLEAR_M * diagonal) & (image.ranges_m > 0)
    ranges, enters, leaves = image.ranges_m[crosses] * factor, enters[crosses], leaves[crosses]
    middle = float(np.linalg.norm((grid.upper_m + grid.lower_m) / 2 - centre))
    if not ranges.size:
        return Standing(image.camera.name, 0, 0.0, _farthest(image, grid), 0.0, 0.0, 0.0)
    return Standing(
        image.camera.name,
        ranges.size,
        float(np.median(ranges)),
        _farthest(image, grid),
        float(np.mean(ranges > leaves + slack)),
        float(np.mean((ranges >= enters - slack) & (ranges <= leaves + slack))),
        float(np.mean(ranges < min(SHORT * middle, 0.5))) if middle > slack else 0.0,
    )


def _farthest(image: Thinned, grid: VoxelGrid) -> float:
    off = np.maximum(
        np.abs(grid.lower_m - image.camera.centre_in_world),
        np.abs(grid.upper_m - image.camera.centre_in_world),
    )
    return float(np.linalg.norm(off))


def _is_far(stands: Standing) -> bool:
    return (
        stands.behind >= THROUGH and stands.within <= NEAR and stands.median_m > FARTHER * stands.farthest_m
    )


def _too_far(far: Sequence[Standing], image: Thinned, grid: VoxelGrid, *, stops: bool) -> Finding:
    one = far[0]
    text = (
        f"{one.behind:.0%} of what looks through the grid returns from behind it, median {one.median_m:.3g} m, while its "
        f"farthest corner is {one.farthest_m:.3g} m away; no voxel would be a surface. Most likely the unit of depth: "
        f"{_advice(image, grid)}; if there is truly nothing in the box, let it reach to a floor or wall that is seen"
    )
    return Finding(KIND, tuple(stands.name for stands in far), text, stops)


def _too_near(near: Sequence[Standing], image: Thinned, grid: VoxelGrid, *, stops: bool) -> Finding:
    one = near[0]
    text = (
        f"{one.short:.0%} of what looks through the grid returns from {one.median_m:.3g} m (median), far before the grid's "
        f"middle. Most likely the unit of depth, or something before the lens: {_advice(image, grid)}"
    )
    return Finding(KIND, tuple(stands.name for stands in near), text, stops)


def _advice(image: Thinned, grid: VoxelGrid) -> str:
    """Which unit fits better, if any does."""
    codes, unit = image.codes, image.unit_m
    shifted = _shift(codes)
    if shifted and _standing(image, grid, 1.0 / shifted).within >= FITS:
        return f"all values are multiples of {shifted}, so bits are shifted: divide the raw values by {shifted}"
    if unit is None:
        factors = {f"depths {factor:g} times as large": factor for factor in (0.001, 0.25, 0.1, 10.0, 4.0)}
    else:
        factors = {f"depth_scale_m {each:g}": each / unit for each in UNITS_M if each != unit}
    said = "check the scale" if unit is None else f"check depth_scale_m, which is {unit:g} m a unit"
    within = {words: _standing(image, grid, factor).within for words, factor in factors.items()}
    # smaller units put all returns before the cameras, which is in the grid, too: the largest that fits about as well
    fits = [words for words in within if within[words] >= max(FITS, ABOUT * max(within.values()))]
    if not fits:
        return said
    words = max(fits, key=lambda each: factors[each])
    return f"{said}; with {words} {within[words]:.0%} would lie in the grid"


def _shift(codes: np.ndarray | None) -> int:
    """The greatest of 8, 16, 32 that divides all codes; 0: none does."""
    if codes is None:
        return 0
    return max((step for step in (8, 16, 32) if not (codes % step).any()), default=0)
