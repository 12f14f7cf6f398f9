"""Mistakes that are tried, one at a time: of all cameras, of one, of two whose poses are exchanged."""

from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import combinations

import numpy as np

from elbowroom.reconstruct.contradiction.eye import Eye
from elbowroom.reconstruct.contradiction.mistakes import Mistake, mistakes

MOST_SUSPECTS = 8
"""For so many cameras single mistakes and exchanges are tried."""
LEAST_M, MOST_M = 0.2, 15.0
"""Between these lies what some camera of a room usually measures [m]."""
GROUND = ("handedness", "world")
"""Kinds that leave a floor a floor: no reason for a camera that shares no view with others."""


@dataclass(frozen=True, slots=True, eq=False)
class Trial:
    """A mistake undone.

    Args:
        mistake: that is tried.
        others: how cameras see without it, by number.
    """

    mistake: Mistake
    others: Mapping[int, Eye]


def trials(
    eyes: Sequence[Eye], typical_m: Sequence[float], contradicting: Sequence[int], lonely: Sequence[int]
) -> Iterator[Trial]:
    """What may be.

    Args:
        eyes: how all cameras are said to see.
        typical_m: what each measures in the middle of all that it measures [m].
        contradicting: numbers of those that contradict others, the worst first.
        lonely: numbers of those that share no view with others.
    """
    known = mistakes()
    if 2 * (len(contradicting) + len(lonely)) >= len(eyes) - 1:
        for mistake in known:
            # of a unit that is the same for all, how far the cameras are apart says more than this does
            if mistake.kind != "depth unit" or max(typical_m) < LEAST_M or min(typical_m) > MOST_M:
                yield from _undone(mistake, eyes, range(len(eyes)))
        for by in range(1, len(eyes)) if len(eyes) > 2 else ():
            places = {n: _at(eye, eyes[(n + by) % len(eyes)]) for n, eye in enumerate(eyes)}
            yield Trial(_shifted(by), places)
    for camera in (*contradicting[:MOST_SUSPECTS], *lonely[:MOST_SUSPECTS]):
        for mistake in known:
            if mistake.kind == "depth unit" and not _nearer(mistake, eyes[camera], camera, typical_m):
                continue
            if camera not in lonely or mistake.kind not in GROUND:
                yield from _undone(mistake, eyes, (camera,))
    pool = range(len(eyes)) if len(eyes) <= MOST_SUSPECTS else contradicting[:MOST_SUSPECTS]
    for one, other in combinations(sorted(pool), 2) if contradicting else ():
        a, b = eyes[one], eyes[other]
        yield Trial(_EXCHANGE, {one: _at(a, b), other: _at(b, a)})


def _undone(mistake: Mistake, eyes: Sequence[Eye], cameras: Collection[int]) -> Iterator[Trial]:
    """A mistake of some cameras, where each of them can have been described with it."""
    others = {camera: mistake.undone(eyes[camera]) for camera in cameras}
    if None not in others.values():
        yield Trial(mistake, {camera: eye for camera, eye in others.items() if eye is not None})


def _nearer(mistake: Mistake, eye: Eye, camera: int, typical_m: Sequence[float]) -> bool:
    """Whether in another unit a camera measures what others do, more than it does as is said."""
    undone = mistake.undone(eye)
    usual = np.log(np.median([own for other, own in enumerate(typical_m) if other != camera]))
    own, scale = np.log(typical_m[camera]), np.log(undone.scale / eye.scale) if undone else 0.0
    return bool(abs(own + scale - usual) < abs(own - usual))


def _at(eye: Eye, place: Eye) -> Eye:
    """A camera at the place of another."""
    return replace(eye, axes=place.axes, centre=place.centre)


_EXCHANGE = Mistake("exchanged", "have each other's pose", "them exchanged", lambda eye: eye)


def _shifted(by: int) -> Mistake:
    return Mistake(
        "shifted",
        f"have each the pose of another, {by} further back in the list",
        f"the poses moved on by {by}",
        lambda eye: eye,
    )
