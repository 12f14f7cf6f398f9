"""One exact number that fills much of an image: a driver's way to write that there was no return."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from elbowroom.finding import Finding
from elbowroom.geometry import VoxelGrid
from elbowroom.sensing.values.thinned import Thinned, way_through

KIND = "sentinel"
SHARE = 0.02
"""Of all pixels: what one exact number must fill before it is looked at closely."""
LEAST_PIXELS = 40
AROUND, LONELY = 0.07, 0.05
"""Values this near to it, as a share of it, are fewer than this share of its count: sensors scatter."""
ABOVE = 0.005
"""Of the returns: so few may lie beyond what is called the greatest value."""
JOINED = 0.1
"""Of its edges: where a surface ends at another, more of the steps beside it are small."""
SMALL_STEP = 0.04
OUTSIDE = 0.5
"""So large a share of its pixels lies behind the grid: a wall or a floor of the grid does not."""
ROUND_M, FAR_BEHIND = 0.5, 1.6
"""Where a wall may have one depth all over, a number must be round, or so much farther than the grid's end."""
MOST = 3
"""So many different sentinels may be in one image."""
SLACK = 0.1
"""A point so far outside the grid still belongs to it, as a share of the grid's diagonal."""
HIGHEST_CODES = 65000
"""Raw codes from here to 65534 are what drivers write for saturated, too weak, too far."""


class Spike(NamedTuple):
    """An exact number of many pixels, alone among the values.

    Fields:
        value_m: the number [m].
        share: of all pixels.
        joined: share of the steps at its edges that are small.
        outside: share of its pixels that lie behind the grid.
        reach: median of its distance over where the rays leave the grid.
    """

    value_m: float
    share: float
    joined: float
    outside: float
    reach: float


def look_at_sentinels(images: Sequence[Thinned], grid: VoxelGrid) -> list[Finding]:
    """Numbers that stand for no return and are read as one.

    It stops where the number is the greatest of its image, no surface leads up to it, and it lies behind the grid, or
    is the same at several cameras: all before it would read free. A number at `max_depth_m` is no return, and is said.

    Args:
        images: one of each camera.
        grid: the watched box.
    """
    spikes = {image.camera.name: _spikes(image, grid) for image in images}
    of = {image.camera.name: image for image in images}
    cameras_by_value: dict[float, list[str]] = {}
    for name, found in spikes.items():
        for spike in found:
            cameras_by_value.setdefault(round(spike.value_m, 5), []).append(name)
    findings = []
    for name, found in spikes.items():
        for spike in found:
            same = len(cameras_by_value[round(spike.value_m, 5)])
            if _is_one(spike, of[name], same):
                findings.append(_finding(name, spike, of[name]))
    findings += [found for image in images for found in _at_the_end(image)]
    return findings + [found for image in images for found in _high_codes(image, findings)]


def _spikes(image: Thinned, grid: VoxelGrid) -> list[Spike]:
    """The greatest values that are alone, each as if those before were no return."""
    values, counts = np.unique(image.here[image.returns], return_counts=True)
    found = []
    for _ in range(MOST):
        if not counts.size:
            break
        most = int(
            np.argmax(counts[values > values[-1] * (1 - AROUND)])
            + np.argmax(values > values[-1] * (1 - AROUND))
        )
        value, count = float(values[most]), int(counts[most])
        above = counts[values > value].sum()
        if count < max(SHARE * image.here.size, LEAST_PIXELS) or above > ABOVE * counts.sum():
            break
        around = counts[np.abs(values - value) <= AROUND * value].sum() - count
        if around > LONELY * count:
            break
        found.append(
            Spike(
                value,
                count / image.here.size,
                joined(image, values[most]),
                *_outside(image, values[most], grid),
            )
        )
        values, counts = values[:most], counts[:most]
    return found


def joined(image: Thinned, value: np.float32) -> float:
    """Of the places where the value ends at another return, the share where the step is small; 1: there are none.

    Args:
        image: of one camera.
        value: an exact number in it [m].
    """
    small = edges = 0
    is_it = image.here == value
    for beside in (image.right, image.below):
        other = (beside > 0) & (beside < np.inf)
        at_edge = other & image.returns & (is_it != (beside == value))
        near, far = np.minimum(image.here, beside)[at_edge], np.maximum(image.here, beside)[at_edge]
        small += int(np.count_nonzero(far - near < SMALL_STEP * far))
        edges += near.size
    return small / edges if edges else 1.0


def _is_one(spike: Spike, image: Thinned, same: int) -> bool:
    """Whether a spike is no surface; `same` cameras have this number."""
    if spike.joined >= JOINED:
        return False
    if _is_high(spike.value_m, image):
        return True
    if image.may_face_a_wall:
        round_m = abs(spike.value_m / ROUND_M - round(spike.value_m / ROUND_M)) < 1e-3
        return spike.outside >= OUTSIDE and (round_m or spike.reach >= FAR_BEHIND)
    return spike.outside >= OUTSIDE or same > 1


def _outside(image: Thinned, value: np.float32, grid: VoxelGrid) -> tuple[float, float]:
    """Of the value's pixels that cross the grid, the share whose ray has left it before, and how much farther it is."""
    is_it = image.here == value
    enters, leaves = way_through(grid, image.camera.centre_in_world, image.rays_in_world[is_it])
    crosses = leaves > enters
    if not crosses.any():
        return 0.0, 0.0
    slack = SLACK * float(np.linalg.norm(grid.upper_m - grid.lower_m))
    ranges, ends = image.ranges_m[is_it][crosses], leaves[crosses]
    return float(np.mean(ranges > ends + slack)), float(np.median(ranges / np.maximum(ends, 1e-6)))


def _is_high(value_m: float, image: Thinned) -> bool:
    unit = image.unit_m
    return unit is not None and value_m / unit >= HIGHEST_CODES


def _finding(name: str, spike: Spike, image: Thinned) -> Finding:
    code = "" if image.unit_m is None else f" (raw {round(spike.value_m / image.unit_m)})"
    text = (
        f"{spike.share:.0%} of the pixels are exactly {spike.value_m:.6g} m{code}, the greatest value, and no "
        "surface leads "
        "up to it: most likely what the driver writes where there is no return, and all before it would read free. "
        f"Set max_depth_m: {spike.value_m:.6g} (a depth at it is no return), or write 0 there"
    )
    return Finding(KIND, (name,), text, stops=True)


def _at_the_end(image: Thinned) -> list[Finding]:
    """Said, but harmless: the greatest range itself is no return."""
    end = image.camera.max_depth_m
    if not np.isfinite(end):
        return []
    share = float(np.mean(_near(image.here, end)))
    if share < SHARE:
        return []
    text = f"{share:.0%} of the pixels are exactly {end:g} m, its max_depth_m: taken as no return, not as a surface"
    return [Finding("at max_depth_m", (image.camera.name,), text, stops=False)]


def _near(depth: NDArray[np.float32], value: float) -> NDArray[np.bool_]:
    return np.abs(depth - np.float32(value)) <= 2e-6 * value


def _high_codes(image: Thinned, said: Sequence[Finding]) -> list[Finding]:
    """Several codes at the end of the raw range, none of them frequent enough to be a spike of its own."""
    if image.unit_m is None or image.codes is None or not image.depths_m.size:
        return []
    if any(image.camera.name in finding.about for finding in said):
        return []
    high = image.depths_m / image.unit_m >= HIGHEST_CODES
    rest = image.depths_m[~high]
    share = float(np.count_nonzero(high)) / image.here.size
    if share < SHARE or (rest.size and rest[-1] > 0.8 * HIGHEST_CODES * image.unit_m):
        return []
    text = (
        f"{share:.0%} of the pixels are raw codes from {HIGHEST_CODES} to 65534, far above all others: most "
        "likely what "
        "the driver writes where there is no return, and all before them would read free. Set max_depth_m to the "
        "sensor's range, or write 0 there"
    )
    return [Finding(KIND, (image.camera.name,), text, stops=True)]
