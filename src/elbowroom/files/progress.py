"""What long work is told to say while it runs."""

from collections.abc import Callable

Progress = Callable[[str], None]
"""Called with what is being done, in a few words."""


def silent(_: str) -> None:
    """Says nothing."""
