"""Pictures of a calibration: corners on the image, where in the image they lay, which cameras share poses."""

import io
from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw, ImageFont

Array = NDArray[np.float64]
SEEN, PROJECTED, DARK, PALE = (213, 94, 0), (0, 158, 115), (24, 32, 44), (216, 221, 228)
"""Orange, green, ink, and the grey of frames; colour-blind eyes tell the first two apart (Okabe, Ito 2008)."""
EXAGGERATED = 20
"""Lines from where a corner is projected to where it was seen are drawn so many times their length."""


def grey_depth(depth_m: NDArray[np.floating], nearest_m: float, farthest_m: float) -> NDArray[np.uint8]:
    """A depth image as grey, near is bright; no return is black, shape (h, w).

    Args:
        depth_m: shape (h, w) [m]; 0 or not finite: no return.
        nearest_m, farthest_m: what is white, and what is darkest grey [m].
    """
    depth = np.nan_to_num(np.asarray(depth_m, dtype=np.float64))
    grey = 235 - 190 * np.clip((depth - nearest_m) / max(farthest_m - nearest_m, 1e-6), 0, 1)
    return np.where(depth > 0, grey, 0).astype(np.uint8)


def reprojection(grey: NDArray[np.uint8], seen_px: Array, projected_px: Array, width_px: int = 480) -> bytes:
    """Corners on the image: orange where they were seen, green where they are projected, PNG.

    Args:
        grey: the image, shape (h, w).
        seen_px, projected_px: shape (n, 2), u then v [px].
        width_px: of the picture, cut to what surrounds the board.
    """
    height, width = grey.shape
    low, high = seen_px.min(axis=0), seen_px.max(axis=0)
    around = 0.35 * float((high - low).max()) + 4
    left, top = (max(0, int(v)) for v in low - around)
    right, bottom = min(width, int(high[0] + around) + 1), min(height, int(high[1] + around) + 1)
    scale = width_px / (right - left)
    picture = Image.fromarray(grey[top:bottom, left:right]).convert("RGB")
    picture = picture.resize((width_px, max(1, round((bottom - top) * scale))), Image.Resampling.NEAREST)
    draw = ImageDraw.Draw(picture)
    # pixel centres lie at whole numbers
    to = lambda pixels: (pixels - (left, top) + 0.5) * scale  # noqa: E731
    for seen, projected in zip(to(seen_px), to(projected_px), strict=True):
        end = projected + EXAGGERATED * (seen - projected)
        draw.line([*projected, *end], fill=SEEN, width=2)
        x, y = projected
        draw.ellipse([x - 4, y - 4, x + 4, y + 4], outline=PROJECTED, width=2)
    return _png(picture)


def coverage(width: int, height: int, corners_px: Sequence[Array], width_px: int = 200) -> bytes:
    """Where in the image corners lay over all poses, PNG.

    Args:
        width, height: of the image [px].
        corners_px: of each pose, shape (n, 2) [px].
        width_px: of the picture.
    """
    scale = width_px / width
    picture = Image.new("RGB", (width_px, max(1, round(height * scale))), (250, 250, 250))
    draw = ImageDraw.Draw(picture)
    for third in (1, 2):
        draw.line([width_px * third / 3, 0, width_px * third / 3, picture.height], fill=PALE)
        draw.line([0, picture.height * third / 3, width_px, picture.height * third / 3], fill=PALE)
    for corners in corners_px:
        for x, y in (corners + 0.5) * scale:
            draw.ellipse([x - 1.5, y - 1.5, x + 1.5, y + 1.5], fill=(0, 114, 178))
    draw.rectangle([0, 0, width_px - 1, picture.height - 1], outline=DARK)
    return _png(picture)


def camera_graph(
    at_m: Mapping[str, Array],
    boards_m: Sequence[Array],
    shared: Mapping[tuple[str, str], int],
    weak: Sequence[str] = (),
    width_px: int = 760,
) -> bytes:
    """The room from above: cameras, poses of the board, and a line between cameras that share poses, PNG.

    Args:
        at_m: where cameras are, world frame, by name [m].
        boards_m: where the board was [m].
        shared: how many poses each two cameras saw together; the wider the line the more.
        weak: names of cameras drawn in orange.
        width_px: of the picture.
    """
    places = np.array([[*place[:2]] for place in (*at_m.values(), *boards_m)])
    low, high = places.min(axis=0), places.max(axis=0)
    edge = 70
    scale = (width_px - 2 * edge) / max(float((high - low).max()), 0.1)
    height_px = int((high[1] - low[1]) * scale) + 2 * edge

    def to(place: Array) -> tuple[float, float]:
        return (edge + (place[0] - low[0]) * scale, height_px - edge - (place[1] - low[1]) * scale)

    picture = Image.new("RGB", (width_px, height_px), (255, 255, 255))
    draw = ImageDraw.Draw(picture)
    most = max(shared.values(), default=1)
    for (a, b), count in sorted(shared.items(), key=lambda item: item[1]):
        pale = int(225 - 125 * count / most)
        draw.line(
            [*to(at_m[a]), *to(at_m[b])], fill=(pale, pale, pale + 15), width=1 + round(3 * count / most)
        )
    for board in boards_m:
        x, y = to(board)
        draw.rectangle([x - 3, y - 3, x + 3, y + 3], fill=(0, 114, 178))
    font = ImageFont.load_default(size=13)
    for name, place in at_m.items():
        x, y = to(place)
        draw.ellipse([x - 6, y - 6, x + 6, y + 6], fill=SEEN if name in weak else PROJECTED, outline=DARK)
        draw.text((x + 8, y - 18), name, fill=DARK, font=font)
    return _png(picture)


def histogram(values: Array, unit: str, width_px: int = 220, height_px: int = 90) -> bytes:
    """How values are spread between their 0.5th and 99.5th percentile, PNG.

    Args:
        values: any shape.
        unit: written under them.
        width_px, height_px: of the picture.
    """
    low, high = (float(v) for v in np.percentile(values, (0.5, 99.5)))
    counts, _ = np.histogram(values, bins=30, range=(low, max(high, low + 1e-12)))
    picture = Image.new("RGB", (width_px, height_px), (255, 255, 255))
    draw = ImageDraw.Draw(picture)
    floor = height_px - 18
    for number, count in enumerate(counts):
        x = number * width_px / 30
        draw.rectangle(
            [x, floor - (floor - 4) * count / max(counts.max(), 1), x + width_px / 30 - 1.5, floor],
            fill=(0, 114, 178),
        )
    font = ImageFont.load_default(size=12)
    draw.text((2, floor + 3), f"{low:.3g}", fill=DARK, font=font)
    words = f"{high:.3g} {unit}"
    draw.text((width_px - 4 - draw.textlength(words, font=font), floor + 3), words, fill=DARK, font=font)
    return _png(picture)


def _png(picture: Image.Image) -> bytes:
    buffer = io.BytesIO()
    picture.save(buffer, format="PNG", optimize=True)
    return buffer.getvalue()
