"""A checkerboard as a solid: a thin plate, whole or with every second square cut out."""

from collections.abc import Callable
from functools import lru_cache
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from elbowroom.simulate.shapes import Shape, box, join
from elbowroom.simulate.solid import Mesh

LEAST_THICKNESS_M = 0.001
"""A board that is said to be thinner, or not at all, is so thick [m]."""
BRIDGE_SHARE = 0.1
"""Edge of the bridges that hold squares together where only their corners meet, over the edge of a square. A bridge is
a small square about the corner, alike in all directions, so that it moves no corner."""
MARK_SHARE = 0.5
"""Edge of the mark in the first square over the edge of a square."""


Place = tuple[float, float] | NDArray[np.float64]


class BoardLike(Protocol):
    """What is asked of a board; `elbowroom.calibrate.Board` is one."""

    @property
    def columns(self) -> int:
        """Inner corners along x."""

    @property
    def rows(self) -> int:
        """Inner corners along y."""

    @property
    def square_m(self) -> float:
        """Edge of a square [m]."""

    @property
    def border_m(self) -> float:
        """Material around the squares [m]."""

    @property
    def kind(self) -> str:
        """ "printed" or "cut_out"."""

    @property
    def marked(self) -> bool:
        """Whether the first square has its mark."""

    @property
    def thickness_m(self) -> float:
        """Of the plate [m]."""


def plate_mesh(board: BoardLike) -> Mesh:
    """The board as one plate, its face in the plane z = 0 of the board's frame, its back beyond it.

    A board that is cut out is made of squares, bridges at the inner corners and a border around them, which overlap or
    touch: one piece of sheet metal, as a laser would cut it.

    Args:
        board: printed or cut out.
    """
    return _plate(
        board.columns,
        board.rows,
        board.square_m,
        board.border_m,
        board.kind == "cut_out",
        board.marked,
        max(board.thickness_m, LEAST_THICKNESS_M),
    )


@lru_cache(maxsize=16)
def _plate(
    columns: int, rows: int, square: float, border: float, cut_out: bool, marked: bool, thick: float
) -> Mesh:
    right, down = columns * square, rows * square

    def sheet(low: Place, high: Place) -> Shape:
        return box((*low, 0.0), (*high, thick))

    if not cut_out:
        return join([sheet((-square - border, -square - border), (right + border, down + border))])
    parts = []
    for column in range(-1, columns):
        for row in range(-1, rows):
            if (column + row) % 2 == 0:
                low = np.array((column, row)) * square
                parts += (
                    _framed(low, square, sheet)
                    if marked and column == row == -1
                    else [sheet(low, low + square)]
                )
    half = BRIDGE_SHARE * square / 2
    parts += [
        sheet((x * square - half, y * square - half), (x * square + half, y * square + half))
        for x in range(columns)
        for y in range(rows)
    ]
    if border > 0:
        a, b, t = -square, -square - border, border
        parts += [
            sheet((b, b), (right + t, a)),
            sheet((b, down), (right + t, down + t)),
            sheet((b, a), (a, down)),
            sheet((right, a), (right + t, down)),
        ]
    return join(parts)


def _framed(low: NDArray[np.float64], square: float, sheet: Callable[[Place, Place], Shape]) -> list[Shape]:
    """A square with a square hole in its middle."""
    inner, outer = (1 - MARK_SHARE) / 2 * square, (1 + MARK_SHARE) / 2 * square
    x, y = low
    return [
        sheet((x, y), (x + square, y + inner)),
        sheet((x, y + outer), (x + square, y + square)),
        sheet((x, y + inner), (x + inner, y + outer)),
        sheet((x + outer, y + inner), (x + square, y + outer)),
    ]


def is_dark(board: BoardLike, x_m: NDArray[np.floating], y_m: NDArray[np.floating]) -> NDArray[np.bool_]:
    """Whether points of a printed board's face bear ink, the shape of x.

    Args:
        board: the board.
        x_m, y_m: board frame [m].
    """
    column, row = np.floor(x_m / board.square_m), np.floor(y_m / board.square_m)
    inside = (column >= -1) & (column < board.columns) & (row >= -1) & (row < board.rows)
    dark = inside & ((column + row) % 2 == 0)
    if board.marked:
        half = MARK_SHARE * board.square_m / 2
        middle = -board.square_m / 2
        dark &= ~((np.abs(x_m - middle) < half) & (np.abs(y_m - middle) < half))
    return np.asarray(dark)
