"""What a camera's image is beside its last good one: the same, turned, of another scale or kind, another camera's."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from elbowroom.monitor.health.streams.cause import HealthCause
from elbowroom.monitor.health.streams.thumb import Thumb

NEAR_SHARE, NEAR_M = 0.03, 0.03
"""Two depths agree that differ by less than this share and length: more than any sensor scatters."""
AGREES = 0.5
"""An image is what its camera gives where so many of its pixels agree with the last good one: walls stand still."""
ANOTHERS, OF_OTHERS = 0.6, 0.5
"""It is another's where so many agree with that one's, and with its own at most so large a part of that."""
UNIFORM = 0.6
"""One rule holds for an image where it holds for so many of its pixels."""
SCALED = 0.1
"""A factor nearer to 1 than this is none."""
ROUGH = 0.6
"""Of the neighbours that were alike before so few are alike where numbers are no depths."""
LEAST_PAIRS = 100
UNITS_M = (1e-3, 1e-4, 2e-4, 2.5e-4, 1.25e-4)
"""Of raw values, those that drivers give [m]."""
EQUAL_TILES = 0.25
"""A sensor stands still where so many of its tiles are what they were, bit by bit."""
LEAST_TILES = 4
HALF = 0.5


class Pairs(NamedTuple):
    """Depths of the same pixels in two images, both with a return, shape (n,) [m].

    Args:
        new, old: of the newer image and of the older one.
        stretch: distance from the centre for each metre of planar depth, of those pixels.
    """

    new: NDArray[np.float32]
    old: NDArray[np.float32]
    stretch: NDArray[np.float32]

    @property
    def agreeing(self) -> float:
        """The share of pairs that agree."""
        return float(np.count_nonzero(_near(self.new, self.old)) / len(self.new))


@dataclass(frozen=True, slots=True)
class Odd:
    """What is wrong with an image.

    Args:
        cause: its name.
        text: in numbers, after the camera's name.
    """

    cause: HealthCause
    text: str


def agrees(new: Thumb, old: Thumb) -> bool | None:
    """Whether an image is what its camera gave last; None: too little can be compared.

    Args:
        new, old: of the newer image and of the older one.
    """
    both = _both(new, old)
    if both is None:
        return None
    with np.errstate(invalid="ignore"):  # of pixels without a return, which do not count
        near = np.count_nonzero(_near(new.depth_m, old.depth_m) & both)
    return bool(near >= AGREES * np.count_nonzero(both))


def _near(new: NDArray[np.float32], old: NDArray[np.float32]) -> NDArray[np.bool_]:
    found: NDArray[np.bool_] = np.abs(new - old) <= NEAR_SHARE * old + NEAR_M
    return found


def _both(new: Thumb, old: Thumb) -> NDArray[np.bool_] | None:
    """Where both have a return; None: in too few places, or they are of unlike sizes."""
    if new.depth_m.shape != old.depth_m.shape:
        return None
    both = new.returned & old.returned
    return both if np.count_nonzero(both) >= min(LEAST_PAIRS, both.size // 4) else None


def pairs_of(new: Thumb, old: Thumb, stretch: NDArray[np.float32]) -> Pairs | None:
    """What can be compared of two images; None: too little, or they are of unlike sizes.

    Args:
        new, old: of the newer image and of the older one.
        stretch: as of `Pairs`, of the whole image, shape as of `Thumb.depth_m`.
    """
    both = _both(new, old)
    if both is None:
        return None
    return Pairs(new.depth_m[both], old.depth_m[both], stretch[both])


def equal_share(new: Thumb, old: Thumb) -> float | None:
    """Of tiles with returns, the share of those that are the same in both images, bit by bit; None: too few have any.

    Args:
        new, old: of the newer image and of the older one.
    """
    if new.depth_m.shape != old.depth_m.shape:
        return None
    told = new.returned_per_tile >= HALF * new.tile_sizes
    if np.count_nonzero(told) < LEAST_TILES:
        return None
    others = new.per_tile((new.depth_m != old.depth_m) & new.returned)
    return float((others[told] == 0).mean())


def oddity(new: Thumb, old: Thumb, pairs: Pairs, others: Mapping[str, Thumb]) -> Odd | None:
    """What an image is that is not what its camera gave; None: it cannot be told.

    Args:
        new, old: the image, and the last good one of its camera.
        pairs: of both.
        others: the last good images of the other cameras.
    """
    return (
        _anothers(new, pairs, others)
        or _turned(new, old, pairs)
        or _other_scale(pairs)
        or _other_kind(pairs)
        or _no_depths(new, old)
    )


def _anothers(new: Thumb, pairs: Pairs, others: Mapping[str, Thumb]) -> Odd | None:
    """The image of another camera: of the one that it agrees with most."""
    agreeing = {name: _agreeing(new, other) for name, other in others.items()}
    name = max(agreeing, key=lambda each: agreeing[each], default=None)
    if name is None or not _is_rather(agreeing[name], pairs):
        return None
    text = f"shows what camera {name} gave: {agreeing[name]:.0%} of its pixels"
    return Odd(HealthCause.CAMERA_SWAPPED, text)


def _turned(new: Thumb, old: Thumb, pairs: Pairs) -> Odd | None:
    """The same image, turned about in its frame, or mirrored."""
    agreeing = {
        how: _agreeing(new, Thumb(np.ascontiguousarray(old.depth_m[::rows, ::columns]), old.step))
        for rows, columns, how in (
            (-1, -1, "turned by 180 degrees"),
            (1, -1, "mirrored"),
            (-1, 1, "upside down"),
        )
    }
    how = max(agreeing, key=lambda each: agreeing[each])
    if not _is_rather(agreeing[how], pairs):
        return None
    return Odd(HealthCause.CAMERA_WRONG_ENCODING, f"gives its image {how}")


def _agreeing(new: Thumb, other: Thumb) -> float:
    """The share of pixels that agree; 0 where too few can be compared."""
    found = pairs_of(new, other, np.ones_like(new.depth_m))
    return 0.0 if found is None else found.agreeing


def _is_rather(agreeing: float, pairs: Pairs) -> bool:
    """Whether an image that agrees so well with another is rather that one than its camera's own."""
    return agreeing >= ANOTHERS and pairs.agreeing <= OF_OTHERS * agreeing


def _other_scale(pairs: Pairs) -> Odd | None:
    """One factor, or one length, between this image and the last good one."""
    ratio = pairs.new / pairs.old
    factor = float(np.median(ratio))
    if abs(np.log(factor)) > SCALED and _holds(ratio / factor):
        return Odd(HealthCause.CAMERA_WRONG_SCALE, f"reads {factor:.4g} times what it read before")
    off_m = float(np.median(pairs.new - pairs.old))
    if _near(pairs.new - off_m, pairs.old).mean() >= UNIFORM:
        return Odd(HealthCause.CAMERA_WRONG_SCALE, f"reads {1e3 * off_m:+.0f} mm beside what it read before")
    return None


def _other_kind(pairs: Pairs) -> Odd | None:
    """Disparity for depth, bytes in another order, or distance from the centre for planar depth, or the other way."""
    inverse = pairs.new * pairs.old
    if _holds(inverse / np.median(inverse)):
        return Odd(
            HealthCause.CAMERA_WRONG_ENCODING, "reads less where it read more: disparity, and no depth"
        )
    if _has_swapped_bytes(pairs):
        return Odd(HealthCause.CAMERA_WRONG_ENCODING, "gives 16-bit numbers with their two bytes swapped")
    for stretch in (pairs.stretch, 1 / pairs.stretch):
        if _holds(pairs.new / (pairs.old * stretch)):
            text = "gives distance from its centre for depth along its axis, or the other way round"
            return Odd(HealthCause.CAMERA_WRONG_ENCODING, text)
    return None


def _has_swapped_bytes(pairs: Pairs) -> bool:
    """Whether depths are what they were once the two bytes of their raw values are put the other way round."""
    for unit_m in UNITS_M:
        raw = np.rint(pairs.new / np.float32(unit_m))
        if raw.max() <= 0xFFFF:
            swapped_m = raw.astype(np.uint16).byteswap() * np.float32(unit_m)
            if _near(swapped_m, pairs.old).mean() >= UNIFORM:
                return True
    return False


def _no_depths(new: Thumb, old: Thumb) -> Odd | None:
    """Numbers without any surface."""
    if new.smooth >= ROUGH * old.smooth:
        return None
    text = (
        f"gives numbers that are no depths: {new.smooth:.0%} of neighbours are alike, {old.smooth:.0%} were"
    )
    return Odd(HealthCause.CAMERA_WRONG_ENCODING, text)


def _holds(ratio: NDArray[np.floating]) -> bool:
    """Whether so many ratios are 1 that a rule holds."""
    return bool((np.abs(ratio - 1) <= NEAR_SHARE).mean() >= UNIFORM)
