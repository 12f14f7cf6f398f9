"""A drawing area with axes in metres, on which sections, outlines and marks are laid."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageChops, ImageDraw, ImageFilter, ImageFont

from elbowroom.view.draw.palette import INK, PAPER, SOFT_INK, Colour

LONGER_SIDE_PX = 1000
LEFT_PX, RIGHT_PX, TOP_PX, BOTTOM_PX = 84, 28, 112, 150
LEAST_WIDTH_PX = 1112


def font(size: int) -> ImageFont.ImageFont | ImageFont.FreeTypeFont:
    """The font that comes with Pillow [px]."""
    return ImageFont.load_default(size=size)


@dataclass(frozen=True, slots=True, eq=False)
class Plot:
    """A picture with an area whose points are given in metres, first axis to the right, second up.

    Args:
        picture: what is drawn on.
        lower_m, upper_m: corners of the area along its two axes [m].
        left_px, top_px: where the area begins on the picture.
        px_per_m: scale.
    """

    picture: Image.Image
    lower_m: NDArray[np.float64]
    upper_m: NDArray[np.float64]
    left_px: int
    top_px: int
    px_per_m: float

    @classmethod
    def of_cells(cls, colours: NDArray[np.uint8], lower_m: NDArray[np.float64], cell_m: float) -> "Plot":
        """A plot that is filled with square cells.

        Args:
            colours: shape (columns, rows, 3); columns along the first axis, rows along the second.
            lower_m: least corner of the cells, shape (2,) [m].
            cell_m: edge of a cell [m].
        """
        columns, rows = colours.shape[:2]
        longer = max(columns, rows)
        px_per_cell = float(LONGER_SIDE_PX // longer) if longer <= LONGER_SIDE_PX else LONGER_SIDE_PX / longer
        width, height = (max(1, round(n * px_per_cell)) for n in (columns, rows))
        cells = Image.fromarray(np.ascontiguousarray(colours.transpose(1, 0, 2)[::-1]))
        total = max(width + LEFT_PX + RIGHT_PX, LEAST_WIDTH_PX)
        picture = Image.new("RGB", (total, height + TOP_PX + BOTTOM_PX), PAPER)
        left = max(LEFT_PX, (total - width) // 2)
        picture.paste(cells.resize((width, height), Image.Resampling.NEAREST), (left, TOP_PX))
        upper_m = lower_m + np.array([columns, rows]) * cell_m
        return cls(picture, lower_m, upper_m, left, TOP_PX, px_per_cell / cell_m)

    @property
    def size_px(self) -> tuple[int, int]:
        """Width and height of the area."""
        width, height = np.round((self.upper_m - self.lower_m) * self.px_per_m).astype(int)
        return max(int(width), 1), max(int(height), 1)

    def area_px(self, points_m: NDArray[np.float64]) -> NDArray[np.float64]:
        """Points of the plot, shape (..., 2) [m], as pixels from the area's upper left corner."""
        right_down = np.stack(
            [points_m[..., 0] - self.lower_m[0], self.upper_m[1] - points_m[..., 1]], axis=-1
        )
        return right_down * self.px_per_m

    def draw_silhouette(self, triangles_m: NDArray[np.float64], colour: Colour, opacity: float) -> None:
        """Lays the shadow of triangles over the area, with an outline.

        Args:
            triangles_m: shape (n, 3, 2) [m].
            colour: of shadow and outline.
            opacity: of the shadow, 0 to 1.
        """
        width, height = self.size_px
        shadow = Image.new("L", (2 * width, 2 * height), 0)
        pen = ImageDraw.Draw(shadow)
        for triangle in self.area_px(triangles_m) * 2:
            pen.polygon([(float(x), float(y)) for x, y in triangle], fill=255)
        outline = ImageChops.subtract(shadow, shadow.filter(ImageFilter.MinFilter(5)))
        for mask, strength in ((shadow, opacity), (outline, 0.75)):
            cover = mask.resize((width, height), Image.Resampling.BOX).point(lambda v, s=strength: int(v * s))
            self.picture.paste(colour, (self.left_px, self.top_px), cover)

    def draw_segments(self, segments_m: NDArray[np.float64], colour: Colour, width_px: int) -> None:
        """Draws lines, clipped to the area.

        Args:
            segments_m: their ends, shape (n, 2, 2), in the plot's axes [m].
            colour, width_px: of the lines.
        """
        width, height = self.size_px
        mask = Image.new("L", (2 * width, 2 * height), 0)
        pen = ImageDraw.Draw(mask)
        for (x0, y0), (x1, y1) in self.area_px(segments_m) * 2:
            pen.line((float(x0), float(y0), float(x1), float(y1)), fill=255, width=2 * width_px)
        cover = mask.resize((width, height), Image.Resampling.BOX)
        self.picture.paste(colour, (self.left_px, self.top_px), cover)

    def draw_wedge(
        self, point_m: NDArray[np.float64], direction: NDArray[np.float64], colour: Colour
    ) -> bool:
        """Marks a place by a dot, and where it looks by a wedge that opens that way.

        Args:
            point_m: shape (2,) [m]; outside the area nothing is drawn.
            direction: shape (2,), in the plot's axes; shorter than 1 where it leans out of the plane.
            colour: of the mark.

        Returns:
            Whether it was drawn.
        """
        slack_m = 6 / self.px_per_m
        if (point_m < self.lower_m - slack_m).any() or (point_m > self.upper_m + slack_m).any():
            return False
        x, y = self.area_px(point_m) + np.array([self.left_px, self.top_px])
        forward = np.array([direction[0], -direction[1]])
        length = float(np.linalg.norm(forward))
        if length > 0.05:
            side = np.array([-forward[1], forward[0]]) / length
            reach = 34 * forward
            corners = [(x, y), *((x + tip[0], y + tip[1]) for tip in (reach - 13 * side, reach + 13 * side))]
            cover = Image.new("L", self.picture.size, 0)
            ImageDraw.Draw(cover).polygon(corners, fill=90)
            self.picture.paste(colour, (0, 0), cover)
        ImageDraw.Draw(self.picture).ellipse((x - 5, y - 5, x + 5, y + 5), fill=colour, outline=PAPER)
        return True

    def draw_name(self, point_m: NDArray[np.float64], words: str) -> None:
        """Writes a name beside a place, towards the middle of the plot, so that it stays within it.

        Args:
            point_m: shape (2,) [m].
            words: the name.
        """
        x, y = self.area_px(point_m) + np.array([self.left_px, self.top_px])
        on_left = point_m[0] < (self.lower_m[0] + self.upper_m[0]) / 2
        ImageDraw.Draw(self.picture).text(
            (x + (9 if on_left else -9), y),
            words,
            fill=INK,
            font=font(14),
            anchor="lm" if on_left else "rm",
            stroke_width=2,
            stroke_fill=PAPER,
        )

    def draw_axes(self, right: str, up: str) -> None:
        """Draws a frame, ticks at round numbers of metres and the names of both axes."""
        pen = ImageDraw.Draw(self.picture)
        width, height = self.size_px
        left, top, bottom = self.left_px, self.top_px, self.top_px + height
        pen.rectangle((left - 1, top - 1, left + width, bottom), outline=INK)
        small = font(17)
        step, digits = _tick_step(max(self.upper_m - self.lower_m))
        for value in _ticks(self.lower_m[0], self.upper_m[0], step):
            x = left + (value - self.lower_m[0]) * self.px_per_m
            pen.line((x, bottom, x, bottom + 6), fill=INK)
            pen.text((x, bottom + 9), f"{value:.{digits}f}", fill=INK, font=small, anchor="mt")
        for value in _ticks(self.lower_m[1], self.upper_m[1], step):
            y = top + (self.upper_m[1] - value) * self.px_per_m
            pen.line((left - 7, y, left - 1, y), fill=INK)
            pen.text((left - 11, y), f"{value:.{digits}f}", fill=INK, font=small, anchor="rm")
        pen.text((left + width / 2, bottom + 32), f"{right} [m]", fill=SOFT_INK, font=small, anchor="mt")
        pen.text((left - 8, top - 8), f"{up} [m]", fill=SOFT_INK, font=small, anchor="rb")


def _tick_step(extent_m: float) -> tuple[float, int]:
    """A round distance between ticks that gives about four to ten of them, and the digits that it needs."""
    power = 10.0 ** np.floor(np.log10(extent_m / 4))
    step = next(power * factor for factor in (5, 2, 1) if extent_m / (power * factor) >= 4)
    return float(step), max(0, -int(np.floor(np.log10(step) + 1e-9)))


def _ticks(lower_m: float, upper_m: float, step: float) -> NDArray[np.float64]:
    first, last = np.ceil(lower_m / step - 1e-6), np.floor(upper_m / step + 1e-6)
    return np.arange(first, last + 1) * step + 0.0
