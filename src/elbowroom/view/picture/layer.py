"""What a picture is made of: opaque and translucent triangles, lines, words."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from elbowroom.view.draw.palette import Colour

Array = NDArray[np.float64]


def linear(colour: Colour) -> tuple[float, float, float]:
    """A colour of the screen, 0 to 255, as light, 0 to 1."""
    return tuple(float((channel / 255) ** 2.2) for channel in colour)  # type: ignore[return-value]


@dataclass(frozen=True, slots=True, eq=False)
class Layer:
    """Triangles that are drawn alike.

    Args:
        triangles: shape (n, 3, 3), world frame [m].
        colours: linear, 0 to 1, one a triangle, shape (n, 3).
        thing: by triangle, the number of the thing that it is part of, shape (n,): where things meet a line is drawn.
        opacity: below 1, what lies behind shines through, and only the front is drawn.
    """

    triangles: Array
    colours: Array
    thing: NDArray[np.int32]
    opacity: float = 1.0

    @classmethod
    def plain(cls, triangles: Array, colour: tuple[float, float, float], opacity: float = 1.0) -> "Layer":
        """Triangles of one thing in one colour.

        Args:
            triangles: shape (n, 3, 3), world frame [m].
            colour: linear, 0 to 1.
            opacity: 0 to 1.
        """
        count = len(triangles)
        return cls(triangles, np.tile(np.array(colour), (count, 1)), np.zeros(count, np.int32), opacity)


@dataclass(frozen=True, slots=True, eq=False)
class Lines:
    """Lines of one colour; what of them lies behind something is drawn faintly.

    Args:
        segments: shape (n, 2, 3), world frame [m].
        colour: of the screen, 0 to 255.
        width_px: of a line.
    """

    segments: Array
    colour: Colour
    width_px: float = 1.6


@dataclass(frozen=True, slots=True)
class Word:
    """A name beside a point.

    Args:
        text: few letters.
        at_m: the point, world frame [m].
        colour: of the screen, 0 to 255.
    """

    text: str
    at_m: tuple[float, float, float]
    colour: Colour


@dataclass(frozen=True, slots=True, eq=False)
class Subject:
    """All that is shown.

    Args:
        layers: opaque and translucent ones in any order.
        lines: drawn over them.
        words: names; those that would lie on another are left out.
        legend: colours with what they mean, left to right.
        title: one line above the picture; empty: none.
    """

    layers: tuple[Layer, ...]
    lines: tuple[Lines, ...] = ()
    words: tuple[Word, ...] = ()
    legend: tuple[tuple[Colour, str], ...] = ()
    title: str = ""

    @property
    def box_m(self) -> Array:
        """Least and greatest corner of all of it, shape (2, 3), world frame [m]; a unit box if there is nothing."""
        points = [layer.triangles.reshape(-1, 3) for layer in self.layers]
        points += [lines.segments.reshape(-1, 3) for lines in self.lines]
        corners = np.concatenate([*points, np.zeros((0, 3))])
        if not len(corners):
            return np.array([[0.0, 0, 0], [1, 1, 1]])
        return np.stack([corners.min(axis=0), corners.max(axis=0)])
