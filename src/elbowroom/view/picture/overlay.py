"""Lines, names, legend and scale over a picture."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw

from elbowroom.view.draw.palette import INK, PAPER, SOFT_INK, Colour
from elbowroom.view.draw.plot import font
from elbowroom.view.picture.layer import Lines, Subject, Word
from elbowroom.view.picture.viewpoint import Viewpoint

SMOOTH = 2
"""Lines are drawn so many times larger, then made smaller."""
PIECE_PX = 3.0
"""A line is looked at in pieces of so much, of each whether something hides it."""
FAINT = 0.22
"""So opaque is what of a line lies behind something."""
BEHIND_M = 0.012
"""A line on a surface is not behind it [m]."""
AXES: tuple[tuple[str, Colour], ...] = (("x", (213, 94, 0)), ("y", (0, 158, 115)), ("z", (0, 114, 178)))
SCALES_M = (0.05, 0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0)


def letter_px(view: Viewpoint) -> int:
    """Height of the letters of a picture: the larger the picture, the larger they are."""
    return int(np.clip(round(min(view.height, view.width) / 46), 12, 40))


def draw_lines(
    picture: Image.Image, lines: Sequence[Lines], view: Viewpoint, depth_m: NDArray[np.float32]
) -> Image.Image:
    """The picture with lines over it.

    Args:
        picture: RGB, of the view's size.
        lines: what is drawn.
        view: from where.
        depth_m: of what is opaque, at pixels' middles; infinite where nothing is, shape (height, width).
    """
    size = (view.width * SMOOTH, view.height * SMOOTH)
    sheet = Image.new("RGBA", size, (*PAPER, 0))
    pen = ImageDraw.Draw(sheet)
    for one in lines:
        width = max(1, round(one.width_px * SMOOTH))
        for segment in one.segments:
            for ends, hidden in _pieces(segment, view, depth_m):
                opacity = round(255 * (FAINT if hidden else 1.0))
                pen.line([*(ends * SMOOTH).ravel().tolist()], fill=(*one.colour, opacity), width=width)
    small = sheet.resize((view.width, view.height), Image.Resampling.BOX)
    return Image.alpha_composite(picture.convert("RGBA"), small).convert("RGB")


def _pieces(
    segment: NDArray[np.float64], view: Viewpoint, depth_m: NDArray[np.float32]
) -> list[tuple[NDArray[np.float64], bool]]:
    """Of a line, ends of stretches on the picture, shape (2, 2) [px], and whether they are hidden."""
    ends = view.project(segment)
    if (ends[:, 2] <= 0).any() and not view.is_parallel:
        return []
    length = float(np.linalg.norm(ends[1, :2] - ends[0, :2]))
    count = int(np.clip(np.ceil(length / PIECE_PX), 1, 4000))
    share = np.linspace(0.0, 1.0, count + 1)[:, None]
    places = view.project(segment[0] + share * (segment[1] - segment[0]))
    middle = (places[1:] + places[:-1]) / 2
    column, row = np.floor(middle[:, 0]).astype(int), np.floor(middle[:, 1]).astype(int)
    inside = (column >= 0) & (column < view.width) & (row >= 0) & (row < view.height)
    before = np.full(count, np.inf)
    before[inside] = depth_m[row[inside], column[inside]]
    hidden = middle[:, 2] > before + BEHIND_M
    border = np.flatnonzero(np.diff(hidden)) + 1
    starts, stops = np.append(0, border), np.append(border, count)
    return [(places[[a, b], :2], bool(hidden[a])) for a, b in zip(starts, stops, strict=True)]


def draw_words(picture: Image.Image, words: Sequence[Word], view: Viewpoint) -> None:
    """Writes names beside their points, the nearest first; one that would lie on another is left out.

    Args:
        picture: RGB; drawn on.
        words: what is written.
        view: from where.
    """
    pen, size = ImageDraw.Draw(picture), letter_px(view)
    letters = font(size)
    taken: list[tuple[float, float, float, float]] = []
    placed = [(view.project(np.array([word.at_m]))[0], word) for word in words]
    for (x, y, depth), word in sorted(placed, key=lambda one: float(one[0][2])):
        if depth <= 0 and not view.is_parallel:
            continue
        box = _place(pen, word.text, (float(x), float(y)), letters, taken, view)
        if box is not None:
            taken.append(box)
            pen.text(
                box[:2],
                word.text,
                fill=word.colour,
                font=letters,
                stroke_width=max(2, size // 6),
                stroke_fill=PAPER,
                anchor="lt",
            )


def _place(
    pen: ImageDraw.ImageDraw,
    text: str,
    at: tuple[float, float],
    letters: object,
    taken: Sequence[tuple[float, float, float, float]],
    view: Viewpoint,
) -> tuple[float, float, float, float] | None:
    """Where a name fits: right of its point, left, above or below; None: nowhere."""
    _, _, wide, high = pen.textbbox((0, 0), text, font=letters, anchor="lt")  # type: ignore[arg-type]
    away = high * 0.7
    for x, y in (
        (at[0] + away, at[1] - high / 2),
        (at[0] - away - wide, at[1] - high / 2),
        (at[0] - wide / 2, at[1] - away - high),
        (at[0] - wide / 2, at[1] + away),
    ):
        box = (x, y, x + wide, y + high)
        inside = x >= 2 and y >= 2 and box[2] <= view.width - 2 and box[3] <= view.height - 2
        if inside and not any(_meet(box, other, high * 0.25) for other in taken):
            return box
    return None


def _meet(
    one: tuple[float, float, float, float], other: tuple[float, float, float, float], spare: float
) -> bool:
    return (
        one[0] < other[2] + spare
        and other[0] < one[2] + spare
        and one[1] < other[3] + spare
        and other[1] < one[3] + spare
    )


def with_frame(picture: Image.Image, subject: Subject, view: Viewpoint) -> Image.Image:
    """The picture with title above it and legend, axes and scale below.

    Args:
        picture: RGB, of the view's size.
        subject: whose title and legend.
        view: from where.
    """
    size = letter_px(view)
    letters = font(size)
    rows = _rows_of(subject.legend, picture.width - 7 * size, letters)
    top = 2 * size if subject.title else 0
    bottom = max(round(1.75 * size) * len(rows) + size, 3 * size)
    sheet = Image.new("RGB", (picture.width, picture.height + top + bottom), PAPER)
    sheet.paste(picture, (0, top))
    pen = ImageDraw.Draw(sheet)
    if subject.title:
        pen.text((size * 0.8, top / 2), subject.title, fill=INK, font=font(round(size * 1.15)), anchor="lm")
    y = top + picture.height + size * 0.7
    for row in rows:
        x = size * 0.8
        for colour, text in row:
            pen.rectangle((x, y, x + size, y + size), fill=colour, outline=SOFT_INK)
            pen.text((x + 1.5 * size, y + size / 2), text, fill=INK, font=letters, anchor="lm")
            x += 3 * size + pen.textlength(text, font=letters)
        y += 1.75 * size
    corner = (sheet.width - 3.0 * size, top + picture.height + bottom / 2)
    _draw_axes(pen, view, corner, size)
    if view.is_parallel:
        _draw_scale(pen, view, (size * 1.0, top + picture.height - 0.8 * size), size)
    return sheet


def _rows_of(
    legend: Sequence[tuple[Colour, str]], width: float, letters: object
) -> list[list[tuple[Colour, str]]]:
    """Entries in rows that fit."""
    pen = ImageDraw.Draw(Image.new("RGB", (1, 1)))
    size = getattr(letters, "size", 12)
    rows, x = list[list[tuple[Colour, str]]](), float("inf")
    for colour, text in legend:
        needs = 3 * size + pen.textlength(text, font=letters)  # type: ignore[arg-type]
        if x + needs > width:
            rows.append([])
            x = 0.0
        rows[-1].append((colour, text))
        x += needs
    return rows


def _draw_axes(pen: ImageDraw.ImageDraw, view: Viewpoint, at: tuple[float, float], size: int) -> None:
    """Where x, y and z of the world point."""
    reach = 1.1 * size
    for axis, (name, colour) in enumerate(AXES):
        right, down = view.world_from_view[axis, :2]
        if np.hypot(right, down) < 0.05:
            continue
        end = (at[0] + reach * right, at[1] + reach * down)
        pen.line((*at, *end), fill=colour, width=max(2, size // 7))
        word = (at[0] + 1.45 * reach * right, at[1] + 1.45 * reach * down)
        pen.text(word, name, fill=colour, font=font(round(size * 0.9)), anchor="mm")


def _draw_scale(pen: ImageDraw.ImageDraw, view: Viewpoint, at: tuple[float, float], size: int) -> None:
    """A bar as long as it says."""
    metres = max((one for one in SCALES_M if one * view.scale < view.width / 4), default=SCALES_M[0])
    x, y, length = at[0], at[1], metres * view.scale
    pen.line((x, y, x + length, y), fill=INK, width=max(2, size // 7))
    for end in (x, x + length):
        pen.line((end, y - size / 3, end, y + size / 3), fill=INK, width=max(2, size // 7))
    pen.text((x + length / 2, y - size / 2), f"{metres:g} m", fill=INK, font=font(size), anchor="mb")
