"""What each camera says of what each other measured, counted by ordered pair."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Self

import numpy as np
from numpy.typing import NDArray

from elbowroom.reconstruct.contradiction.eye import Array, Eye
from elbowroom.reconstruct.contradiction.sample import Sample, about

SLACK_M, SLACK_SHARE = 0.04, 0.012
"""What two cameras may differ by beyond both margins: constant [m], and by their distances from the point."""
WIDEST = 0.15
"""Where two cameras may differ by more than this share of the distance and the slack, nothing is compared."""
SPEED_M_S, FARTHEST_M = 2.0, 0.3
"""Between two exposures things may have moved by so much: speed [m/s], and no more than so far [m]."""

Counts = NDArray[np.int64]
Counted = tuple[Counts, Counts, Counts]
"""Through, agrees and hidden."""
NOTHING: Counted = (np.zeros(1, dtype=np.int64),) * 3
"""Of any number of cameras."""


@dataclass(frozen=True, slots=True, eq=False)
class Pairs:
    """Counts of points by the camera that measured them (rows) and the one that looks there (columns).

    Args:
        through: the looking camera sees past the point, by more than anything can explain.
        agrees: it measured a surface there, too.
        hidden: it measured something before the point, and knows nothing of it.
    """

    through: Counts
    agrees: Counts
    hidden: Counts

    @classmethod
    def none(cls, cameras: int) -> "Pairs":
        """Nothing counted, of so many cameras."""
        return cls(*np.zeros((3, cameras, cameras), dtype=np.int64))

    def __add__(self, other: Self) -> Self:
        return type(self)(
            self.through + other.through, self.agrees + other.agrees, self.hidden + other.hidden
        )

    def put(self, looker: int, counts: Counted) -> None:
        """What a camera says of the others' points is this, whatever it said before.

        Args:
            looker: its number.
            counts: through, agrees and hidden by owner, as of `seen_by`.
        """
        for kept, new in zip((self.through, self.agrees, self.hidden), counts, strict=True):
            kept[:, looker] = new

    def both_ways(self) -> Self:
        """Whoever measured and whoever looked: symmetric."""
        return self + type(self)(self.through.T, self.agrees.T, self.hidden.T)


@dataclass(frozen=True, slots=True, eq=False)
class Points:
    """What some cameras measured.

    Args:
        in_world: shape (n, 3) [m].
        wide_m: what each is not trusted to, shape (n,) [m].
        owner: number of the camera that measured it, shape (n,).
        stamp_ns: of its image, shape (n,); NaN: unknown.
    """

    in_world: Array
    wide_m: Array
    owner: NDArray[np.intp]
    stamp_ns: Array


def points_of(eye: Eye, sample: Sample, owner: int) -> Points:
    """The points that a camera measured, if it sees as is said.

    Args:
        eye: how it sees.
        sample: of its image.
        owner: its number.
    """
    ray = eye.directions(sample.u, sample.v)
    depth = sample.depth_m * eye.scale
    along = depth / np.linalg.norm(ray, axis=1) if eye.radial else depth
    in_world = (ray * along[:, None]) @ eye.axes.T + eye.centre
    wide = SLACK_SHARE * depth + eye.uncertainty_m(depth)
    stamp = np.nan if sample.stamp_ns is None else float(sample.stamp_ns)
    return Points(in_world, wide, np.full(len(depth), owner), np.full(len(depth), stamp))


def together(parts: Sequence[Points]) -> Points:
    """All points of several cameras."""
    return Points(
        np.concatenate([part.in_world for part in parts]).reshape(-1, 3),
        np.concatenate([part.wide_m for part in parts]),
        np.concatenate([part.owner for part in parts]),
        np.concatenate([part.stamp_ns for part in parts]),
    )


def seen_by(eye: Eye, sample: Sample, points: Points, cameras: int) -> Counted:
    """How many of each camera's points a camera sees past, agrees with, and has something before.

    Args:
        eye: how the camera sees that looks.
        sample: of its image.
        points: what others measured.
        cameras: how many there are.

    Returns:
        through, agrees and hidden by owner, each of shape (cameras,).
    """
    in_camera = (points.in_world - eye.centre) @ eye.axes
    u, v = eye.pixels_of(in_camera)
    near = (u >= 0) & (v >= 0) & (u <= eye.width) & (v <= eye.height)
    chosen = np.flatnonzero(near)
    least, greatest, said = about(eye, sample.image, u[chosen], v[chosen])
    depth = eye.depth_of(in_camera[chosen])
    wide = points.wide_m[chosen] + SLACK_M + SLACK_SHARE * depth + eye.uncertainty_m(depth)
    wide += _moved_m(sample.stamp_ns, points.stamp_ns[chosen])
    said &= wide < WIDEST * depth + SLACK_M
    through, hidden = said & (least > depth + wide), said & (greatest < depth - wide)
    owner = points.owner[chosen]
    return (
        np.bincount(owner[through], minlength=cameras),
        np.bincount(owner[said & ~through & ~hidden], minlength=cameras),
        np.bincount(owner[hidden], minlength=cameras),
    )


def _moved_m(stamp_ns: int | None, stamps_ns: Array) -> Array | float:
    """How far things may have moved between the exposures [m]."""
    if stamp_ns is None:
        return 0.0
    apart_s = np.nan_to_num(np.abs(stamps_ns - float(stamp_ns))) / 1e9
    return np.minimum(SPEED_M_S * apart_s, FARTHEST_M)
