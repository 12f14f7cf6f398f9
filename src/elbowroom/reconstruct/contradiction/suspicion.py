"""Which cameras contradict the others, and which mistake explains it."""

from collections.abc import Collection, Mapping
from dataclasses import dataclass

import numpy as np

from elbowroom.reconstruct.contradiction.eye import Eye
from elbowroom.reconstruct.contradiction.mistakes import Mistake
from elbowroom.reconstruct.contradiction.pairs import Pairs
from elbowroom.reconstruct.contradiction.trials import Trial, trials
from elbowroom.reconstruct.contradiction.views import Views

SUSPECT = 0.02
"""A camera of whose comparisons at least this share is a contradiction is looked at more closely."""
FEW = 24
"""Fewer comparisons than this say nothing; so many are added to those of each camera, as agreeing."""
LONELY = 0.1
"""A camera that is compared less than this part of what is usual has hardly a view in common with the others."""
FITS, FITS_WELL = 0.12, 0.004
"""A mistake explains contradictions if, undone, at most this part of their share is left, or this share of all,"""
KEEPS = 0.6
"""and at least this part of what agreed before agrees then, too."""
FINDS, FINDS_WELL = 0.2, 0.03
"""It explains why a camera is lonely if, undone, this part of what is usual agrees, and no larger share contradicts."""
PARTNERS = 8
"""A mistake is tried against so many other cameras at most."""


@dataclass(frozen=True, slots=True)
class Share:
    """Of comparisons between cameras.

    Args:
        through: contradictions: one measured a surface, the other sees past it.
        compared: these and those that agree.
    """

    through: int
    compared: int

    @property
    def value(self) -> float:
        """From 0 to 1."""
        return self.through / max(self.compared, 1)

    @property
    def agrees(self) -> int:
        """How many are no contradiction."""
        return self.compared - self.through


@dataclass(frozen=True, slots=True, eq=False)
class Suspicion:
    """Cameras that contradict the others, or have nothing in common with them.

    Args:
        cameras: their numbers.
        mistake: that explains it.
        before: comparisons as they are said to see.
        after: comparisons if the mistake is undone.
        gain: contradictions less, and agreements more, of all pairs of these cameras and others.
    """

    cameras: tuple[int, ...]
    mistake: Mistake
    before: Share
    after: Share
    gain: float


@dataclass(frozen=True, slots=True, eq=False)
class Standing:
    """Who contradicts whom.

    Args:
        contradicting: numbers of cameras, the worst first, and
        shares: what each contradicts those that are left then.
        lonely: those that share hardly a view with others.
        core: those that are left, and do not contradict each other.
        usual: how many comparisons of two of these agree, in both directions.
    """

    contradicting: tuple[int, ...]
    shares: tuple[Share, ...]
    lonely: tuple[int, ...]
    core: tuple[int, ...]
    usual: float

    @property
    def suspects(self) -> tuple[int, ...]:
        """All but the core."""
        return (*self.contradicting, *self.lonely)


def standing(pairs: Pairs) -> Standing:
    """Takes out the camera that contradicts the others most, until nobody does.

    Args:
        pairs: counted.
    """
    both = pairs.both_ways()
    core, out, shares = list(range(len(both.through))), list[int](), list[Share]()
    while len(core) > 1:
        chosen = np.ix_(core, core)
        through, agrees = both.through[chosen].sum(axis=1), both.agrees[chosen].sum(axis=1)
        share = through / (through + agrees + FEW)
        worst = int(np.argmax(share))
        if share[worst] < SUSPECT:
            break
        shares.append(Share(int(through[worst]), int(through[worst] + agrees[worst])))
        out.append(core.pop(worst))
    agrees = both.agrees[np.ix_(core, core)].sum(axis=1)
    usual = float(np.median(agrees)) if core else 0.0
    few = max(LONELY * usual, FEW)
    alone = [camera for camera, own in zip(core, agrees, strict=True) if own < few]
    alone += [camera for camera, share in zip(out, shares, strict=True) if share.compared < few]
    told = [(camera, share) for camera, share in zip(out, shares, strict=True) if camera not in alone]
    return Standing(
        contradicting=tuple(camera for camera, _ in told),
        shares=tuple(share for _, share in told),
        lonely=tuple(alone),
        core=tuple(camera for camera in core if camera not in alone),
        usual=usual / max(len(core) - 1, 1),
    )


def explained(views: Views) -> tuple[list[Suspicion], Views]:
    """Mistakes that explain contradictions, what explains most first, and the views with all of them undone.

    Args:
        views: of a moment.
    """
    found, named = list[Suspicion](), set[int]()
    while len(named) < len(views.eyes):
        now = standing(views.pairs)
        if not set(now.suspects) - named:
            break
        best = _best(views, now, named)
        if best is None:
            break
        suspicion, others = best
        found.append(suspicion)
        named |= set(suspicion.cameras)
        views = views.with_eyes(others)
    return found, views


def share_of(pairs: Pairs, cameras: Collection[int], partners: Collection[int]) -> Share:
    """Comparisons of some cameras with others and with each other, in both directions.

    Args:
        pairs: counted.
        cameras: whose.
        partners: with whom; what these compare among each other is not counted.
    """
    both, own = pairs.both_ways(), list(cameras)
    rest = [partner for partner in partners if partner not in own]
    outer, inner = np.ix_(own, rest), np.ix_(own, own)
    through = int(both.through[outer].sum() + both.through[inner].sum() // 2)
    agrees = int(both.agrees[outer].sum() + both.agrees[inner].sum() // 2)
    return Share(through, through + agrees)


def _best(views: Views, now: Standing, named: Collection[int]) -> tuple[Suspicion, Mapping[int, Eye]] | None:
    """The mistake that explains most of cameras that were not named yet."""
    best: tuple[float, Suspicion, Mapping[int, Eye]] | None = None
    for trial in trials(views.eyes, views.typical_m, now.contradicting, now.lonely):
        if not set(trial.others).isdisjoint(named):
            continue
        suspicion = _tried(views, now, trial)
        if suspicion is None:
            continue
        gain = suspicion.gain
        if best is None or gain > best[0]:
            best = gain, suspicion, trial.others
    return None if best is None else best[1:]


def _tried(views: Views, now: Standing, trial: Trial) -> Suspicion | None:
    """What comes of undoing a mistake; None: it explains nothing."""
    cameras = sorted(trial.others)
    asked = _some(cameras)
    rest = [camera for camera in now.core if camera not in cameras]
    rest = rest or [camera for camera in range(len(views.eyes)) if camera not in cameras]
    partners = [*asked, *_some(rest)]
    before = share_of(views.pairs, asked, partners)
    after = share_of(
        views.pairs_if({camera: trial.others[camera] for camera in asked}, partners), asked, partners
    )
    if not _explains(before, after, now.usual * _pairs(len(asked), len(partners))):
        return None
    gain = before.through - after.through + after.agrees - before.agrees
    scale = _pairs(len(cameras), len(cameras) + len(rest)) / _pairs(len(asked), len(partners))
    return Suspicion(tuple(cameras), trial.mistake, before, after, gain * scale)


def _pairs(cameras: int, among: int) -> float:
    """How many pairs of cameras there are of which one at least is of a part."""
    return max(cameras * (cameras - 1) / 2 + cameras * (among - cameras), 1.0)


def _explains(before: Share, after: Share, usual: float) -> bool:
    """Whether what is left is so much better.

    Args:
        before, after: comparisons.
        usual: how many of so many pairs of cameras agree.
    """
    if before.through >= SUSPECT * (before.compared + FEW):
        left = max(FITS * before.value, min(FITS_WELL, before.value / 3))
        return after.value <= left and after.agrees >= max(KEEPS * before.agrees, 2 * FEW)
    is_lonely = before.agrees < max(LONELY * usual, FEW)
    return is_lonely and after.value <= FINDS_WELL and after.agrees >= max(FINDS * usual, 2 * FEW)


def _some(cameras: list[int]) -> list[int]:
    """At most `PARTNERS` of them, evenly."""
    if len(cameras) <= PARTNERS:
        return cameras
    return [cameras[int(n)] for n in np.linspace(0, len(cameras) - 1, PARTNERS)]
