"""The checkerboard that cameras look at: printed, or with every second square cut out so that depth images show it."""

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from elbowroom.errors import CalibrationError

BoardKind = Literal["printed", "cut_out"]
MOST_CORNERS = 60
"""Along one side."""
LARGEST_SQUARE_M = 1.0
"""No board that a person carries has larger squares [m]."""


@dataclass(frozen=True, slots=True)
class Board:
    """A flat checkerboard of `columns` x `rows` inner corners.

    Board frame: origin at the first inner corner, x along a row of corners, y along a column, z away from the eye that
    sees x to the right and y down. One of the two counts is odd and the other even, so that a board turned by half a
    turn looks different: else nobody could tell its two ends apart. The first square, which shares the first corner
    with the board's outer corner, is dark or material; so is every second one from there.

    Args:
        columns, rows: inner corners along x and y.
        square_m: edge of a square [m].
        kind: "printed" (dark and bright, seen in infrared or colour images) or "cut_out" (every second square is a
            hole, seen in depth images; thesis 3.2, Fig. 1).
        border_m: material around the outer squares [m].
        marked: the first square, beyond the first corner, has a mark in its middle that is half as wide as the square:
            a hole, or a bright spot. A checkerboard looks the same in a mirror; with the mark it does not, so that its
            back is told from its front.
        thickness_m: of a plate that is cut out [m]: seen at a slant, the walls of its holes count as material, too.

    Raises:
        CalibrationError: a board that cannot be used.
    """

    columns: int
    rows: int
    square_m: float
    kind: BoardKind = "printed"
    border_m: float = 0.0
    marked: bool = False
    thickness_m: float = 0.0

    def __post_init__(self) -> None:
        for side in ("columns", "rows"):
            if not 3 <= getattr(self, side) <= MOST_CORNERS:
                raise CalibrationError(
                    f"board: {side} is {getattr(self, side)}, must be 3 to {MOST_CORNERS} inner corners"
                )
        if (self.columns + self.rows) % 2 == 0:
            raise CalibrationError(
                f"board: {self.columns} x {self.rows} inner corners look the same turned by half a turn; "
                "one count must be odd and the other even"
            )
        if not (np.isfinite(self.square_m) and self.square_m > 0):
            raise CalibrationError(f"board: square_m is {self.square_m}, must be above 0")
        if self.square_m > LARGEST_SQUARE_M:
            raise CalibrationError(
                f"board: square_m is {self.square_m:g}, at most {LARGEST_SQUARE_M:g} is allowed: it is in metres, this "
                f"looks like millimetres ({self.square_m / 1e3:g} m)"
            )
        if self.border_m > LARGEST_SQUARE_M:
            raise CalibrationError(
                f"board: border_m is {self.border_m:g}: it is in metres, this looks like millimetres "
                f"({self.border_m / 1e3:g} m)"
            )
        if not (np.isfinite(self.border_m) and self.border_m >= 0):
            raise CalibrationError(f"board: border_m is {self.border_m}, must be at least 0")
        if not (np.isfinite(self.thickness_m) and 0 <= self.thickness_m < self.square_m / 4):
            raise CalibrationError(
                f"board: thickness_m is {self.thickness_m}, must be from 0 to below a quarter of a square"
            )
        if self.kind not in ("printed", "cut_out"):
            raise CalibrationError(f"board: kind is {self.kind!r}, allowed are printed, cut_out")

    @property
    def corners_in_board(self) -> NDArray[np.float64]:
        """Inner corners, shape (rows * columns, 3), board frame [m]; corner id = row * columns + column."""
        row, column = np.divmod(np.arange(self.columns * self.rows), self.columns)
        corners = np.zeros((self.columns * self.rows, 3))
        corners[:, 0], corners[:, 1] = column * self.square_m, row * self.square_m
        return corners

    @property
    def mark_in_board(self) -> NDArray[np.float64]:
        """Middle of the first square, where the mark is, shape (3,), board frame [m]."""
        return np.array([-self.square_m / 2, -self.square_m / 2, 0.0])

    @property
    def mirrored_mark_in_board(self) -> NDArray[np.float64]:
        """Middle of the square in which a mirror shows the mark, as `mark_in_board`."""
        far = np.array([-0.5, self.rows - 0.5]) if self.columns % 2 else np.array([self.columns - 0.5, -0.5])
        return np.append(far * self.square_m, 0.0)

    @property
    def outline_in_board(self) -> NDArray[np.float64]:
        """The plate's four corners, border and all, in turn, shape (4, 3), board frame [m]."""
        before = self.square_m + self.border_m
        right = self.columns * self.square_m + self.border_m
        down = self.rows * self.square_m + self.border_m
        return np.array([(-before, -before, 0), (right, -before, 0), (right, down, 0), (-before, down, 0)])
