"""The four cases per voxel (thesis, Table 1), counted and drawn in the thesis' colours (its Fig. 9)."""

import io
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw

from elbowroom.geometry import VoxelGrid
from elbowroom.view.draw.colour import View, cubes
from elbowroom.view.draw.plot import font

NAMES = ("correct_free", "incorrect_free", "correct_object", "incorrect_object")
"""Cases 1 to 4: free found free, free taken for an object, an object found, an object taken for free."""
COLOURS = ((255, 255, 255), (48, 96, 214), (52, 168, 83), (214, 32, 32))
"""White, blue, green, red."""
MACHINE = (198, 202, 208)
INK = (24, 32, 44)


def cases_of(
    free: NDArray[np.bool_], occupied: NDArray[np.bool_], machine: NDArray[np.bool_]
) -> NDArray[np.uint8]:
    """The case of each voxel, 1 to 4; 0 where only the machine is.

    Args:
        free: declared free.
        occupied: an object is there.
        machine: the machine is there; a voxel may be both.
    """
    cases = np.where(occupied, np.where(free, 4, 3), np.where(free, 1, 2)).astype(np.uint8)
    cases[machine & ~occupied] = 0
    return cases


def counts_of(cases: NDArray[np.uint8]) -> dict[str, int]:
    """Voxels of each case by name."""
    counts = np.bincount(cases.reshape(-1), minlength=5)
    return {name: int(counts[case + 1]) for case, name in enumerate(NAMES)}


def section_picture(volumes: Sequence[tuple[str, NDArray[np.uint8]]], grid: VoxelGrid, at_m: float) -> bytes:
    """Horizontal sections side by side, y up, x to the right.

    Args:
        volumes: words and cases of each.
        grid: of all of them.
        at_m: height of the section [m].

    Returns:
        PNG.
    """
    layer = int((at_m - grid.lower_m[2]) / grid.voxel_size_m)
    table = np.array([MACHINE, *COLOURS], dtype=np.uint8)
    side = 400
    sheet = Image.new("RGB", (len(volumes) * (side + 12), side + 30), (255, 255, 255))
    pen = ImageDraw.Draw(sheet)
    for n, (words, cases) in enumerate(volumes):
        cells = Image.fromarray(np.ascontiguousarray(table[cases[:, :, layer]].transpose(1, 0, 2)[::-1]))
        left = n * (side + 12) + 4
        sheet.paste(cells.resize((side, side), Image.Resampling.NEAREST), (left, 26))
        pen.rectangle((left - 1, 25, left + side, 26 + side), outline=INK)
        pen.text((left, 3), f"{words}, section at {at_m:g} m", fill=INK, font=font(16))
    return as_png(sheet)


def voxel_picture(cases: NDArray[np.uint8], grid: VoxelGrid) -> bytes:
    """The room as cubes seen from above: case 1 is air, the others in their colours, the machine grey. PNG."""
    # air is label 0 there, so the machine takes the place of case 1
    labels = np.choose(cases, [1, 0, 2, 3, 4]).astype(np.uint8)
    palette = (np.array([COLOURS[0], MACHINE, *COLOURS[1:]], dtype=float) / 255.0) ** 2.2
    view = View((3.6, -3.8, 4.2), (0.0, -0.05, 0.7), 46, 560, 440)
    return as_png(cubes(labels, grid, palette, view))


def as_png(picture: Image.Image) -> bytes:
    """A small file: up to 256 colours."""
    buffer = io.BytesIO()
    picture.convert("P", palette=Image.Palette.ADAPTIVE, colors=128).save(buffer, format="PNG", optimize=True)
    return buffer.getvalue()
