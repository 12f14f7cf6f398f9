"""The curve over the number of cameras (thesis Fig. 4), and sections through the map of detection capability."""

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw

from elbowroom.placement.detection import Capability
from elbowroom.placement.even import Sweep
from elbowroom.placement.fixed_room import FixedRoom
from elbowroom.placement.pictures import FIXED, INVALID, LINE_INK, WATCHED_INK, legend, title
from elbowroom.view.draw.outline import cut_lines
from elbowroom.view.draw.palette import CAMERA_INK, INK, SOFT_INK, Colour
from elbowroom.view.draw.plot import Plot, font

ROUND_MM = (14, 20, 25, 30, 35, 40, 45, 50, 60, 70, 80, 90, 100, 120, 150, 200, 250, 300, 400, 500, 700, 1000)
"""Steps of the map of detection capability are taken from these; 14, 40 and 70 mm are those of ISO 13855 [mm]."""
SIZE_COLOURS: tuple[Colour, ...] = (
    (68, 1, 84),
    (72, 36, 117),
    (65, 68, 135),
    (53, 95, 141),
    (42, 120, 142),
    (33, 145, 140),
    (34, 168, 132),
    (68, 191, 112),
    (122, 209, 81),
    (253, 231, 37),
)
"""Viridis: small things dark, large ones light."""


def capability_section(result: Capability, room: FixedRoom | None, normal: int, layer: int) -> Image.Image:
    """One layer of voxels, coloured by the thickness of the smallest object that is seen there.

    Args:
        result: the map.
        room: drawn where the section cuts it; None: not drawn.
        normal: axis that is cut: 0 x, 1 y, 2 z.
        layer: index along it.
    """
    plane = [axis for axis in range(3) if axis != normal]
    sizes, asked = (np.take(volume, layer, axis=normal) for volume in (result.smallest_mm, result.asked))
    steps = steps_mm(sizes[asked])
    colours_used = [SIZE_COLOURS[n * len(SIZE_COLOURS) // len(steps)] for n in range(len(steps))]
    step = np.searchsorted(steps, sizes, side="left")
    colours = np.array([*colours_used, INVALID], dtype=np.uint8)[step]
    colours = np.where(asked[..., None], colours, np.array(FIXED, dtype=np.uint8)).astype(np.uint8)
    ends = [f"up to {steps[0]} mm", *(f"{size}" for size in steps[1:])]
    swatches = dict(zip(ends, colours_used, strict=True)) | {"larger or unseen": INVALID, "fixed": FIXED}
    centre = float(result.grid.centre_of(np.eye(3)[normal] * layer)[normal])
    plot = Plot.of_cells(colours, result.grid.lower_m[plane], result.grid.voxel_size_m)
    if room is not None:
        plot.draw_segments(cut_lines(room.triangles, normal, centre)[:, :, plane], INK, 2)
    plot.draw_axes("xyz"[plane[0]], "xyz"[plane[1]])
    views = f"{result.views} camera{'s' * (result.views > 1)}"
    title(
        plot,
        f"Smallest object that {views} see{'s' * (result.views == 1)}, at {'xyz'[normal]} = {centre:.2f} m",
        f"three pixel pitches, six sigmas of noise, and a voxel's diagonal of "
        f"{result.grid.voxel_size_m * 1732:.0f} mm at least",
    )
    legend(plot, swatches, {})
    return plot.picture


def curve(sweeps: Mapping[str, Sweep], views: int) -> Image.Image:
    """The share of valid points over the number of cameras (thesis Fig. 4), a line for each sweep."""
    inks = (LINE_INK, INVALID, WATCHED_INK, CAMERA_INK)
    cells = np.full((100, 60, 3), 255, dtype=np.uint8)
    plot = Plot.of_cells(cells, np.zeros(2), 1.0)
    pen = ImageDraw.Draw(plot.picture)
    width, height = plot.size_px
    left, top = plot.left_px, plot.top_px
    counts = [n for one in sweeps.values() for n in one.counts]
    low, high = min(counts), max(max(counts), min(counts) + 1)

    def at(count: float, share: float) -> tuple[float, float]:
        return left + (count - low) / (high - low) * width, top + (100 - share) / 100 * height

    small = font(17)
    for share in range(0, 101, 20):
        x, y = at(low, share)
        pen.line((x, y, x + width, y), fill=(225, 228, 231))
        pen.text((x - 10, y), f"{share}", fill=INK, font=small, anchor="rm")
    for count in range(5 * -(-low // 5), high + 1, 5):
        x, y = at(count, 0)
        pen.line((x, y, x, y + 6), fill=INK)
        pen.text((x, y + 9), f"{count}", fill=INK, font=small, anchor="mt")
    for number, one in enumerate(sweeps.values()):
        ink = inks[number % len(inks)]
        places = [at(n, share) for n, share in zip(one.counts, one.valid_pct, strict=True)]
        pen.line(places, fill=ink, width=3)
        for x, y in places:
            pen.ellipse((x - 4, y - 4, x + 4, y + 4), fill=ink)
    pen.rectangle((left - 1, top - 1, left + width, top + height), outline=INK)
    pen.text(
        (left + width / 2, top + height + 32), "number of cameras", fill=SOFT_INK, font=small, anchor="mt"
    )
    pen.text((left - 8, top - 8), "[%]", fill=SOFT_INK, font=small, anchor="rb")
    title(plot, "Valid points of the empty room, cameras evenly along the walls", "Thesis, Fig. 4")
    legend(plot, {}, {name: inks[number % len(inks)] for number, name in enumerate(sweeps)})
    return plot.picture


def steps_mm(sizes_mm: NDArray[np.floating]) -> tuple[int, ...]:
    """Up to seven round sizes that part what is seen: from the least to that of 99 % of the places."""
    seen = sizes_mm[np.isfinite(sizes_mm)]
    if not len(seen):
        return ROUND_MM[:1]
    ends = np.searchsorted(ROUND_MM, [seen.min(), np.quantile(seen, 0.99)])
    first, last = (min(int(end), len(ROUND_MM) - 1) for end in ends)
    picked = np.unique(np.linspace(first, last, min(7, last - first + 1)).round().astype(int))
    return tuple(ROUND_MM[n] for n in picked)
