"""Repair and large-neighbourhood search: some cameras out, the best ones in, over and over."""

import time
from collections.abc import Callable, Sequence
from typing import Any, Protocol, Self, TypeVar

import numpy as np
from numpy.typing import NDArray

MOST_OUT = 4
"""So many cameras at most are taken out at once."""
AMONG = 4
"""One of so many best candidates is taken in."""
HOT, COLD = 0.004, 0.0002
"""A layout worse by this is still gone on from, at the beginning of a round and at its end [mean worth of points]."""
ROUND = 150
ROUNDING = 1e-9


class Searched(Protocol):
    """What the search asks of a layout, whatever its points are: `Layout`, `SceneLayout`."""

    model: Any
    chosen: list[int]

    @property
    def valid(self) -> float:
        """Number of points that are as wanted, or what they are worth."""

    @property
    def share(self) -> float:
        """Their share, 0 to 1."""

    @property
    def value(self) -> float:
        """What is compared between layouts: the share, or more finely."""

    @property
    def price(self) -> float:
        """Of what is chosen and not there already."""

    def without(self, members: Sequence[int]) -> Self:
        """The layout without some members."""

    def add(self, candidate: int) -> None:
        """Takes a candidate in."""

    def gains(self) -> NDArray[np.float64]:
        """What each candidate would add."""

    def losses(self) -> NDArray[np.float64]:
        """What each member is worth."""


Found = TypeVar("Found", bound=Searched)


def repair(layout: Found, share: float, budget: float = np.inf) -> Found:
    """Adds the candidate that improves most for its price, until the share is reached or nothing helps.

    Args:
        layout: to start from; is changed.
        share: of valid points that is wanted, 0 to 1.
        budget: the price is not to exceed.
    """
    price = layout.model.price
    while layout.share < share:
        gain = layout.gains()
        gain[price > budget - layout.price + ROUNDING] = -1.0
        best = int(np.argmax(gain / np.maximum(price, ROUNDING)))
        if gain[best] <= 0:
            break
        layout.add(best)
    return layout


def prune(layout: Found, share: float) -> Found:
    """Takes out what the share does not need, the dearest first; what is kept stays."""
    while True:
        spare = [c for c in layout.chosen if c not in layout.model.kept]
        for member in sorted(spare, key=lambda c: -layout.model.price[c]):
            smaller = layout.without([member])
            if smaller.share >= share:
                layout = smaller
                break
        else:
            return layout


def improve(
    layout: Found,
    budget: float,
    share: float,
    rng: np.random.Generator,
    until: float,
    stop: Callable[[], bool] = lambda: False,
) -> Found:
    """Large-neighbourhood search for more valid points at no more than a price.

    Args:
        layout: to start from, within the budget.
        budget: greatest price.
        share: the search ends when this share of points is valid, 0 to 1.
        rng: source of randomness.
        until: the search ends then [s, time.perf_counter].
        stop: the search ends when it says so.

    Returns:
        The best layout that was met.
    """
    best = here = layout
    step = 0
    while best.share < share and time.perf_counter() < until and not stop():
        heat = HOT * (COLD / HOT) ** ((step % ROUND) / ROUND)
        if step and step % ROUND == 0:
            here = best
        tried = _rebuilt(here, budget, rng)
        if tried.value > here.value - heat * rng.random():
            here = tried
        if (tried.valid, tried.value) > (best.valid, best.value):
            best = tried
        step += 1
    return best


def _rebuilt(layout: Found, budget: float, rng: np.random.Generator) -> Found:
    """The layout with a few members replaced."""
    spare = [c for c in layout.chosen if c not in layout.model.kept]
    out: NDArray[np.int64] | list[int] = (
        rng.choice(spare, size=min(len(spare), int(rng.integers(1, MOST_OUT + 1))), replace=False)
        if spare
        else []
    )
    tried = layout.without([int(c) for c in out])
    price = tried.model.price
    among = int(rng.integers(1, AMONG + 1))
    while True:
        gain = tried.gains()
        gain[price > budget - tried.price + ROUNDING] = -1.0
        rate = gain / np.maximum(price, ROUNDING)
        ranked = np.argpartition(-rate, min(among, len(rate) - 1))[:among]
        ranked = ranked[gain[ranked] > 0]
        if not len(ranked):
            return tried
        tried.add(int(rng.choice(ranked)))
