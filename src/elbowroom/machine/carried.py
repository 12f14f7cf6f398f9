"""Whether a part that a machine is given can be carried: it lies in no link that does not carry it."""

from collections.abc import Collection, Sequence

import numpy as np
from numpy.typing import NDArray

from elbowroom.errors import MachineError
from elbowroom.geometry import invert_rigid
from elbowroom.machine.link import Link
from elbowroom.machine.overlap import always_touching, is_within
from elbowroom.machine.shape import Shape

WITHIN = 3
"""In so many poses it is asked whether a part lies wholly in a link, or a link in it."""


def require_beside(
    what: str,
    links: Sequence[Link],
    shape: Shape,
    held_with: Collection[int],
    placed: NDArray[np.float64],
) -> None:
    """Refuses a part that lies in links in nearly all poses which do not carry it.

    Args:
        what: the machine, for a message.
        links: of it; the last one is the part.
        shape: of the links.
        held_with: rows of the links that the part may touch.
        placed: where links are in many poses, shape (poses, n_links, 4, 4).

    Raises:
        MachineError: the part lies in such a link.
    """
    last = len(links) - 1
    rows = [(row, last) for row, link in enumerate(links[:-1]) if link.has_geometry and row not in held_with]
    always = always_touching(shape, rows, placed)
    within = [
        links[row].name
        for (row, _), touch in zip(rows, always, strict=True)
        if touch or all(holds(links, row, last, pose) for pose in placed[:WITHIN])
    ]
    if within:
        raise MachineError(
            f"{what}: part {links[last].name} lies in {', '.join(within)} in all poses, which do not carry it: "
            "give its place (link_from_part), a smaller shape, or the link that does carry it"
        )


def holds(links: Sequence[Link], one: int, other: int, placed: NDArray[np.float64]) -> bool:
    """Whether of two links that do not touch one lies wholly in the other.

    Args:
        links: of the machine.
        one, other: their rows.
        placed: where links are, shape (n_links, 4, 4).
    """
    other_from_one = invert_rigid(placed[other]) @ placed[one]
    return is_within(links[one], links[other], other_from_one) or is_within(
        links[other], links[one], invert_rigid(other_from_one)
    )
