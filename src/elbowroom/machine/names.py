"""Names of links as people write them: a link's own name, or wildcards."""

from collections.abc import Iterable
from fnmatch import fnmatchcase

WILD = "*?"
"""What no name of a part may hold: it would stand for other links."""


def is_named(link: str, name: str) -> bool:
    """Whether a name is that of a link, or one with wildcards that it matches.

    Args:
        link: name of the link.
        name: as somebody wrote it.
    """
    return link == name or fnmatchcase(link, name)


def named_by(name: str, links: Iterable[str]) -> list[str]:
    """The links that a name stands for.

    Args:
        name: as somebody wrote it.
        links: names of a machine's links.
    """
    return [link for link in links if is_named(link, name)]
