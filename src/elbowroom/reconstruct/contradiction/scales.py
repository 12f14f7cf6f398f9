"""Focal lengths and depths that are a tenth or more too large or too small: of all cameras alike, or of one.

With a wrong focal length a plane stays a plane, but lies otherwise, and for each camera in a way of its own: floors and
walls are there twice. So surfaces that two cameras both measured are laid over each other, with all focal lengths as
they are said and a little other.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from elbowroom.finding import Finding
from elbowroom.reconstruct.contradiction.eye import Array, Eye
from elbowroom.reconstruct.contradiction.pairs import Points, points_of, together
from elbowroom.reconstruct.contradiction.sample import Whole, about
from elbowroom.reconstruct.contradiction.suspicion import standing
from elbowroom.reconstruct.contradiction.views import Views

KIND = "scale"
CLOSE_M, CLOSE_SHARE = 0.005, 0.0015
"""Beside the sensor's noise and the systematic part of its margin, so far surfaces may lie apart: [m], and of depth."""
MOST = 4.0
"""What lies farther apart than so many times that is another thing, and counts no more than that."""
STEP = 1.11
"""By so much up and down is tried first,"""
FINE, WIDE = np.log(1.03), 27
"""then in steps of this, so many at most."""
LEAST = 1.045
"""A factor nearer to 1 is not told: calibrations of the usual size leave that open."""
COMPARED = 200
"""So many places must be compared."""
LESS, LEFT = 0.15, 0.8
"""Told where surfaces lie so much nearer to each other, in units of what is allowed, and at most this part is left;"""
ALONE, ALONE_LESS, ALONE_LEFT = 1.06, 0.25, 0.65
"""The same of one camera alone, of which a pose that is a little off may look so."""
STOPS, STOPS_LEFT, STOPS_NEAR = 1.08, 0.75, 2.0
"""it stops from this factor on, where at most this part is left, and surfaces are nearer to each other then."""
PLACES, FEWEST = 1536, 48
"""So many places are asked about at most, or so many of each camera."""
ALIKE = 0.9
"""What gains so much of the best is told as well."""
SUSPECTS = 3
"""So many cameras are tried alone: those whose surfaces lie farthest from the others'."""
MOST_ALONE = 4
"""So many cameras at most are told of one by one."""

Scaled = Callable[[Eye, float], Eye]


class Misfit(NamedTuple):
    """How far surfaces lie apart that two cameras both measured.

    Fields:
        total: sum over places, in units of what is allowed.
        places: how many were compared.
    """

    total: float
    places: float

    @property
    def mean(self) -> float:
        """Of a place."""
        return self.total / max(self.places, 1)


@dataclass(frozen=True, slots=True)
class Scale:
    """A factor with which surfaces fit better.

    Args:
        cameras: numbers of those that have it.
        words: of what it is.
        factor: by which that is too large.
        before, after: how far surfaces lie apart as is said, and with the factor taken out.
    """

    cameras: tuple[int, ...]
    words: "Words"
    factor: float
    before: Misfit
    after: Misfit

    @property
    def gain(self) -> float:
        """By how much surfaces lie nearer to each other, in places."""
        return (self.before.mean - self.after.mean) * self.before.places

    @property
    def times(self) -> float:
        """How far it is from 1, either way."""
        return max(self.factor, 1 / self.factor)

    @property
    def is_told(self) -> bool:
        """Whether it is more than what calibrations leave open."""
        before, after = self.before.mean, self.after.mean
        least, less, left = (ALONE, ALONE_LESS, ALONE_LEFT) if len(self.cameras) == 1 else (LEAST, LESS, LEFT)
        return self.times >= least and before - after >= less and after <= left * before

    @property
    def stops(self) -> bool:
        """Whether verdicts would be on another room."""
        return self.times >= STOPS and self.after.mean <= min(STOPS_LEFT * self.before.mean, STOPS_NEAR)


class Words(NamedTuple):
    """What has a factor.

    Fields:
        what: with its verb, "focal lengths look".
        large, small: "long" and "short".
        cure: what to do.
        scaled: how a camera sees if it is by so much larger.
    """

    what: str
    large: str
    small: str
    cure: str
    scaled: Scaled


def _focal(across: bool, down: bool) -> Scaled:
    """How a camera sees whose focal lengths are larger, across the image, down it, or both."""

    def scaled(eye: Eye, factor: float) -> Eye:
        k = eye.intrinsics
        fx, fy = k.fx * (factor if across else 1.0), k.fy * (factor if down else 1.0)
        return replace(eye, intrinsics=replace(k, fx=fx, fy=fy))

    return scaled


OF_THE_IMAGE = "give fx and fy of the images as they are (another mode, images that were cropped or scaled)"
KINDS = (
    Words(
        "focal lengths look",
        "long",
        "short",
        OF_THE_IMAGE,
        _focal(across=True, down=True),
    ),
    Words(
        "depths look",
        "large",
        "small",
        "give depth_scale_m as the sensor delivers it, and places of poses in metres",
        lambda eye, factor: replace(eye, scale=eye.scale * factor),
    ),
)

OF_ALL = (
    *KINDS,
    Words("fx looks", "long", "short", OF_THE_IMAGE, _focal(across=True, down=False)),
    Words("fy looks", "long", "short", OF_THE_IMAGE, _focal(across=False, down=True)),
)
"""Images that were squeezed are so of all cameras."""


def scale_findings(views: Views, *, wholly: bool = False) -> tuple[Finding, ...]:
    """Focal lengths and depths that look too large or too small.

    Args:
        views: of one moment.
        wholly: only if nobody contradicts anybody any more with them taken out.
    """
    given = views
    found, findings = list[Scale](), list[Finding]()
    views = _thinned(views)
    while len(views.eyes) > 1 and len(found) < MOST_ALONE:
        named = {camera for each in found for camera in each.cameras}
        told = [each for each in _scales(views, named) if each.is_told]
        if not told:
            break
        best = max(told, key=_gain)
        alike = [each for each in told if each.cameras == best.cameras and each.gain >= ALIKE * best.gain]
        found.append(best)
        findings.append(_told(views, sorted(alike, key=_gain, reverse=True)))
        others = {n: best.words.scaled(views.eyes[n], 1 / best.factor) for n in best.cameras}
        views, given = views.with_eyes(others), given.with_eyes(others)
    return () if wholly and standing(given.pairs).suspects else tuple(findings)


def _thinned(views: Views) -> Views:
    """The same with fewer places of each camera."""
    most = max(FEWEST, PLACES // len(views.eyes))
    samples = []
    for sample in views.samples:
        taken = np.linspace(0, len(sample.u) - 1, min(most, len(sample.u))).astype(np.intp)
        samples.append(replace(sample, u=sample.u[taken], v=sample.v[taken], depth_m=sample.depth_m[taken]))
    return Views(views.eyes, tuple(samples))


def _gain(scale: Scale) -> float:
    return scale.gain


def _scales(views: Views, named: set[int]) -> Iterator[Scale]:
    """The factor that fits best, of all cameras alike and of each that was not named yet."""
    everybody, pairs = tuple(range(len(views.eyes))), by_pair(views)
    of_each = [Misfit(*(float(sums[n].sum() + sums[:, n].sum()) for sums in pairs)) for n in everybody]
    groups = [(everybody, Misfit(*(float(sums.sum()) for sums in pairs)))] if not named else []
    if len(everybody) > 2:
        worst = sorted(set(everybody) - named, key=lambda n: -of_each[n].mean)
        groups += [((n,), of_each[n]) for n in worst[:SUSPECTS]]
    for group, before in groups:
        if before.places < COMPARED or before.mean < LESS:
            continue
        for words in OF_ALL if group == everybody else KINDS:
            factor, after = _best(views, group, words, before)
            yield Scale(group, words, factor, before, after)


def _best(views: Views, group: tuple[int, ...], words: Words, before: Misfit) -> tuple[float, Misfit]:
    """The factor that is to be taken out, and what is left then."""

    def left(log: float) -> Misfit:
        return misfit(views, {n: words.scaled(views.eyes[n], np.exp(-log)) for n in group})

    up, down = left(np.log(STEP)), left(-np.log(STEP))
    sign = 1 if up.mean < down.mean else -1
    if min(up.mean, down.mean) >= before.mean:
        return 1.0, before
    tried = [before]
    for number in range(1, WIDE + 1):
        tried.append(left(sign * number * FINE))
        if number > 4 and min(each.mean for each in tried[-3:]) > min(each.mean for each in tried):
            break
    at = int(np.argmin([each.mean for each in tried]))
    return float(np.exp(sign * at * FINE)), tried[at]


def misfit(views: Views, eyes: Mapping[int, Eye]) -> Misfit:
    """How far surfaces lie apart that some cameras and others both measured, if these see otherwise.

    Args:
        views: of a moment.
        eyes: how they see, by number.
    """
    return Misfit(*(float(sums.sum()) for sums in by_pair(views, eyes)))


def by_pair(views: Views, eyes: Mapping[int, Eye] | None = None) -> tuple[Array, Array]:
    """As `misfit`: the sum, and how many places, by who measured and who looks there, shape (n, n) each.

    Args:
        views: of a moment.
        eyes: as of `misfit`; None: all cameras, as they are said to see.
    """
    count = len(views.eyes)
    given = dict(enumerate(views.eyes)) if eyes is None else eyes
    points = {n: _points(views, n, given) for n in range(count)}
    totals, places = np.zeros((2, count, count))
    for looker in range(count):
        owners = [n for n in range(count) if n != looker and (looker in given or n in given)]
        if owners:
            eye = given.get(looker, views.eyes[looker])
            owner, apart = _apart(eye, views, looker, [points[n] for n in owners])
            totals[:, looker] = np.bincount(owner, np.minimum(apart, MOST), minlength=count)
            places[:, looker] = np.bincount(owner, minlength=count)
    return totals, places


def _points(views: Views, number: int, eyes: Mapping[int, Eye]) -> Points:
    """What a camera measured, with how far off it may be."""
    eye, sample = eyes.get(number, views.eyes[number]), views.samples[number]
    known = views.points[number] if number not in eyes else points_of(eye, sample, number)
    return replace(known, wide_m=_allowed_m(eye, sample.depth_m * eye.scale))


def _apart(eye: Eye, views: Views, looker: int, parts: list[Points]) -> tuple[Whole, Array]:
    """Who measured the points that a camera says anything of, and how far its surface lies from each, in units of what
    is allowed."""
    points, sample = together(parts), views.samples[looker]
    in_camera = (points.in_world - eye.centre) @ eye.axes
    u, v = eye.pixels_of(in_camera)
    near = np.flatnonzero((u >= 0) & (v >= 0) & (u <= eye.width) & (v <= eye.height))
    least, greatest, said = about(eye, sample.image, u[near], v[near])
    depth = eye.depth_of(in_camera[near])
    off = np.maximum(np.maximum(least - depth, depth - greatest), 0.0)
    return points.owner[near][said], (off / (points.wide_m[near] + _allowed_m(eye, depth)))[said]


def _allowed_m(eye: Eye, depth_m: Array) -> Array:
    """How far a surface may lie off: one standard deviation, and what is systematic [m]."""
    own = eye.margin
    wide = own.bias_m + own.range_linear * depth_m + own.range_quadratic * depth_m**2
    wide = wide + CLOSE_M + CLOSE_SHARE * depth_m
    return wide if eye.noise is None else wide + eye.noise.sigma(depth_m)


def _told(views: Views, scales: Sequence[Scale]) -> Finding:
    """What fits best, and what fits next to as well."""
    best = scales[0]
    names = tuple(views.eyes[n].name for n in best.cameras)
    who = f"all {len(names)} cameras" if len(names) > 2 else " and ".join(names)
    text = (
        f"{who}: {', or '.join(_looks(scale) for scale in scales)}: surfaces that two cameras both measured lie apart, "
        f"and {1 - best.after.mean / best.before.mean:.0%} less with that taken out; "
        f"{', or '.join(scale.words.cure for scale in scales)}; or calibrate anew"
    )
    return Finding(KIND, names, text, best.stops)


def _looks(scale: Scale) -> str:
    words = scale.words
    return f"{words.what} {scale.times:.2f} times too {words.large if scale.factor > 1 else words.small}"
