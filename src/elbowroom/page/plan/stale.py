"""Work that is given up when nobody wants its result any more."""

from collections.abc import Callable

Stop = Callable[[], bool]
"""Says whether nobody wants to know any more."""


class Stale(Exception):
    """Nobody wants to know any more."""


def never() -> bool:
    """Somebody always wants to know."""
    return False


def unless(is_stale: Stop) -> None:
    """Goes on, unless nobody wants to know any more.

    Raises:
        Stale: nobody does.
    """
    if is_stale():
        raise Stale
