"""Whether a part that a machine is given can be carried: it lies in no link that does not carry it."""

from collections.abc import Collection, Sequence

import numpy as np
from numpy.typing import NDArray

from elbowroom.errors import MachineError
from elbowroom.finding import Finding
from elbowroom.geometry import invert_rigid
from elbowroom.machine.link import Link
from elbowroom.machine.overlap import always_touching, is_within
from elbowroom.machine.shape import Shape
from elbowroom.machine.sizes import (
    LARGEST_LINK_M,
    ODD,
    SMALLEST_M,
    SUSPECT_M,
    away_of,
    length_of,
    require_metres,
)

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


def require_size(
    what: str, links: Sequence[Link], carried: Link, points: NDArray[np.float64]
) -> tuple[Finding, ...]:
    """Refuses a part that cannot be meant in metres; what may be is said.

    Args:
        what: the machine, for a message.
        links: of it, without the part.
        carried: the part.
        points: its corners in the frame of the link that carries it, shape (n, 3) [m].

    Raises:
        MachineError: it is longer than links may be, or lies farther from the link.
    """
    name = f"{what}: part {carried.name}"
    longest = max((length_of(link.vertices) for link in links if link.has_geometry), default=0.0)
    largest, length, away = max(LARGEST_LINK_M, longest), length_of(carried.vertices), away_of(points)
    require_metres(name, carried.vertices, largest, "mesh_scale (scale of Part.mesh)")
    if away > largest:
        raise MachineError(
            f"{name}: lies {away:.4g} m from its link's frame; is link_from_part in millimetres? it must be in metres"
        )
    said = []
    if length > SUSPECT_M and length > ODD * longest > 0:
        said.append(
            f"part {carried.name} is {length:.3g} m long, the longest link {longest:.2g} m: is it in metres?"
        )
    if away > SUSPECT_M and away > ODD * longest > 0:
        said.append(
            f"part {carried.name} lies {away:.3g} m from its link, the longest link is {longest:.2g} m: is "
            "link_from_part in metres?"
        )
    if length < SMALLEST_M:
        said.append(f"part {carried.name} is {1e3 * length:.2g} mm long; is it scaled twice?")
    return tuple(Finding("unit", (carried.name,), text, stops=False) for text in said)


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
