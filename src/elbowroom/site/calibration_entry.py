"""What a capture for calibration shows, as a site file describes it: the board, its images, what fixes the world."""

from typing import Annotated, Literal

import numpy as np
from numpy.typing import NDArray
from pydantic import Field, model_validator

from elbowroom.site.entry import Count, Entry, Flag, Matrix, NotNegative, Number, Point, Positive, Text, Whole
from elbowroom.site.ranges import MILLIMETRES, up_to

Corners = Annotated[Whole, Field(ge=3, le=60)]
LARGEST_SQUARE_M = 1.0
"""No board that a person carries has larger squares, nor a wider border [m]."""
FARTHEST_M = 1000.0
"""Nothing of a room is farther from the world's origin [m]."""
COARSEST_M = 0.2
"""No place that fixes the world is measured worse [m]."""
Pixel = tuple[Number, Number]


class BoardEntry(Entry):
    """The board: inner corners along its two sides, edge of a square, kind, border, whether it bears the mark.

    The mark is a hole (cut out) or a bright spot (printed) in the middle of the first square, half as wide as it: by it
    alone the front is told from the back. Left out, a board that is cut out has it and a printed one has not.
    """

    columns: Corners
    rows: Corners
    square_m: Annotated[Positive, up_to(1, "m", MILLIMETRES)]
    kind: Literal["printed", "cut_out"] = "printed"
    border_m: Annotated[NotNegative, up_to(2, "m", MILLIMETRES)] = 0.0
    marked: Flag | None = None
    thickness_m: Annotated[NotNegative, up_to(0.2, "m", MILLIMETRES)] = 0.0

    @model_validator(mode="after")
    def _in_metres(self) -> "BoardEntry":
        for key in ("square_m", "border_m", "thickness_m"):
            _require_metres(key, getattr(self, key), LARGEST_SQUARE_M)
        return self

    @model_validator(mode="after")
    def _has_two_ends(self) -> "BoardEntry":
        if (self.columns + self.rows) % 2 == 0:
            raise ValueError("one of columns and rows odd and the other even, so that its two ends differ")
        return self

    @property
    def is_marked(self) -> bool:
        """Whether the first square has the mark."""
        return self.kind == "cut_out" if self.marked is None else self.marked


def _require_metres(key: str, value: float, most: float) -> None:
    if abs(value) > most:
        raise ValueError(
            f"{key} of at most {most:g}: it is in metres, {value:g} looks like millimetres ({value / 1e3:g} m)"
        )


class ColourLens(Entry):
    """A sensor's colour camera: size, lens, and where its depth camera lies in its frame, as the maker says."""

    width: Count
    height: Count
    fx: Positive
    fy: Positive
    cx: Number
    cy: Number
    distortion: tuple[Number, ...] = ()
    colour_from_depth: Matrix

    @model_validator(mode="after")
    def _a_lens(self) -> "ColourLens":
        if len(self.distortion) not in (0, 5, 8):
            raise ValueError(
                "distortion of no coefficient, 5 (k1 k2 p1 p2 k3) or 8 (k1 k2 p1 p2 k3 k4 k5 k6)"
            )
        return self


class CaptureImagesEntry(Entry):
    """In which images the board is looked for; depth images are the recording's, others lie in a folder of their own.

    `folder` holds `<camera>/<name>.png`, each named as the depth image of the same camera and moment, or `files` lists
    them per camera, in the order of its depth images. `lenses` are those of colour cameras, where depth is not already
    registered to colour: corners are carried over to the depth image.
    """

    kind: Literal["depth", "infrared", "colour"] = "depth"
    folder: Text | None = None
    files: dict[Text, tuple[Text, ...]] = Field(default_factory=dict)
    lenses: dict[Text, ColourLens] = Field(default_factory=dict)

    @model_validator(mode="after")
    def _folder_of_pictures(self) -> "CaptureImagesEntry":
        if (self.kind == "depth") != (self.folder is None):
            raise ValueError("folder with kind infrared or colour, and none with depth")
        if self.lenses and self.kind != "colour":
            raise ValueError("lenses only with kind colour")
        return self


class WorldFromBoard(Entry):
    """The board lies flat, its face up, in one pose, which defines the world: its number, first corner, direction of x.

    `first_corner_m` is in the world frame, its z the height of the board's face; `x_axis_deg` is the angle from the
    world's x axis to the board's, counter-clockwise seen from above.
    """

    by: Literal["board"]
    pose: Annotated[Whole, Field(ge=0)] = 0
    first_corner_m: Point = (0.0, 0.0, 0.0)
    x_axis_deg: Number = 0.0

    @model_validator(mode="after")
    def _in_metres(self) -> "WorldFromBoard":
        for value in self.first_corner_m:
            _require_metres("first_corner_m", value, FARTHEST_M)
        return self

    @property
    def world_from_board(self) -> NDArray[np.float64]:
        """Pose of the board then, shape (4, 4): its z axis points down, away from the eye above it."""
        turn = np.radians(self.x_axis_deg)
        pose = np.eye(4)
        pose[:3, 0] = np.cos(turn), np.sin(turn), 0.0
        pose[:3, 1] = np.sin(turn), -np.cos(turn), 0.0
        pose[:3, 2] = 0.0, 0.0, -1.0
        pose[:3, 3] = self.first_corner_m
        return pose


class CornerEntry(Entry):
    """An inner corner of the board in one pose: number of the pose, column and row, both from 0 at the first corner."""

    pose: Annotated[Whole, Field(ge=0)]
    column: Annotated[Whole, Field(ge=0)]
    row: Annotated[Whole, Field(ge=0)]


class NamedPoint(Entry):
    """A point whose place in the world was measured: seen at pixels of cameras, or a corner of the board in a pose."""

    name: Text
    world_m: Point
    seen_px: dict[Text, Pixel] = Field(default_factory=dict)
    corner: CornerEntry | None = None

    @model_validator(mode="after")
    def _in_metres(self) -> "NamedPoint":
        for value in self.world_m:
            _require_metres("world_m", value, FARTHEST_M)
        return self

    @model_validator(mode="after")
    def _is_seen(self) -> "NamedPoint":
        if bool(self.seen_px) == (self.corner is not None):
            raise ValueError("either seen_px, with pixels by camera, or corner, of the board in a pose")
        return self


class WorldFromPoints(Entry):
    """At least three points, not in one line, each coordinate measured to `sigma_m`."""

    by: Literal["points"]
    points: Annotated[tuple[NamedPoint, ...], Field(min_length=3)]
    sigma_m: Positive = 0.002

    @model_validator(mode="after")
    def _in_metres(self) -> "WorldFromPoints":
        _require_metres("sigma_m", self.sigma_m, COARSEST_M)
        return self

    @model_validator(mode="after")
    def _are_told_apart(self) -> "WorldFromPoints":
        names = [point.name for point in self.points]
        twice = next((name for name in names if names.count(name) > 1), None)
        if twice is not None:
            raise ValueError(f"each name once; {twice!r} is there twice")
        corners = [point.corner for point in self.points if point.corner is not None]
        again = next((corner for corner in corners if corners.count(corner) > 1), None)
        if again is not None:
            raise ValueError(
                f"each corner once; column {again.column}, row {again.row} of pose {again.pose} is there twice"
            )
        return self


class WorldFromMachine(Entry):
    """The machine's base is where `machine` says."""

    by: Literal["machine"]


class WorldFromCamera(Entry):
    """One camera is where the site says; everything else is found relative to it."""

    by: Literal["camera"]
    camera: Text


WorldEntry = Annotated[
    WorldFromBoard | WorldFromPoints | WorldFromMachine | WorldFromCamera, Field(discriminator="by")
]


class CalibrationEntry(Entry):
    """All that `elbowroom calibrate` asks of a site besides its cameras and recording."""

    board: BoardEntry | None = None
    images: CaptureImagesEntry = CaptureImagesEntry()
    world: WorldEntry | None = None
    least_views: Count = 3

    @model_validator(mode="after")
    def _goes_together(self) -> "CalibrationEntry":
        if isinstance(self.world, WorldFromBoard) and self.board is None:
            raise ValueError("a board, where the world is fixed by one")
        if isinstance(self.world, WorldFromPoints):
            self._has_the_corners_of(self.world.points)
        if self.board is not None and (self.board.kind == "cut_out") != (self.images.kind == "depth"):
            raise ValueError(
                "images of kind depth for a board that is cut out, of kind infrared or colour for a printed one"
            )
        return self

    def _has_the_corners_of(self, points: tuple[NamedPoint, ...]) -> None:
        for point in points:
            if point.corner is None:
                continue
            if self.board is None:
                raise ValueError(f"a board, of which point {point.name} is a corner")
            if point.corner.column >= self.board.columns or point.corner.row >= self.board.rows:
                raise ValueError(
                    f"corners that the board has; point {point.name} is column {point.corner.column}, row "
                    f"{point.corner.row}, of columns 0 to {self.board.columns - 1}, rows 0 to {self.board.rows - 1}"
                )
