"""Sections through a free space as pictures: free, surface, unseen and blind, with the machine drawn in."""

from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw

from elbowroom.errors import InputError
from elbowroom.files.atomic import folder, whole_file
from elbowroom.geometry import DepthCamera
from elbowroom.machine import Machine
from elbowroom.reconstruct.free_space import FreeSpace
from elbowroom.view.draw.outline import cut_lines, triangles_of
from elbowroom.view.draw.palette import (
    CAMERA_INK,
    COLOURS,
    INK,
    MACHINE_INK,
    SOFT_INK,
    WORDS,
    Label,
    colour_table,
    labels,
    shares,
)
from elbowroom.view.draw.plot import LEFT_PX, Plot, font

AXES = "xyz"
PLANE_OF = {0: (1, 2), 1: (0, 2), 2: (0, 1)}
"""By the axis that a section is perpendicular to: the axes that its picture shows to the right and up."""
DEFAULT_HEIGHTS_M = (0.3, 1.1, 1.8)
"""Shins, hips and heads of people, above the grid's lowest corner."""


def section(
    space: FreeSpace,
    axis: str,
    at_m: float,
    *,
    machine: Machine | None = None,
    joints: Mapping[str, float] | None = None,
    cameras: Sequence[DepthCamera] = (),
) -> Image.Image:
    """A picture of one layer of voxels.

    Args:
        space: what to show.
        axis: "x", "y" or "z", which the section is perpendicular to.
        at_m: where it cuts that axis, world frame [m].
        machine: drawn as a silhouette, and as lines where the section cuts it; None: not drawn.
        joints: joint positions of the machine [m or rad] by name.
        cameras: drawn as marks that point where they look.

    Raises:
        InputError: an unknown axis, or a place outside the grid.
    """
    triangles = None if machine is None else triangles_of(machine, joints or {})
    return _section(space, labels(space), axis, at_m, triangles, cameras)


def save_sections(
    space: FreeSpace,
    out_dir: Path | str,
    machine: Machine | None = None,
    joints: Mapping[str, float] | None = None,
    cameras: Sequence[DepthCamera] = (),
) -> list[Path]:
    """Writes section_z1.png, _z2, _z3, _y and _x, and returns their paths.

    The three horizontal ones lie 0.3, 1.1 and 1.8 m above the grid's floor, or at fractions of a lower grid;
    the vertical ones go through the machine's middle, or the grid's. Pictures that are there are replaced.

    Args:
        space: what to show.
        out_dir: the folder to write into; made if it is not there.
        machine: as in `section`.
        joints: as in `section`.
        cameras: as in `section`.

    Raises:
        InputError: the folder cannot be written to.
    """
    out_dir = folder(out_dir)
    volume = labels(space)
    triangles = None if machine is None else triangles_of(machine, joints or {})
    paths = []
    for name, at_m in _places(space, triangles).items():
        picture = _section(space, volume, name[0], at_m, triangles, cameras)
        path = out_dir / f"section_{name}.png"
        with whole_file(path) as unfinished:
            picture.save(unfinished, format="PNG")
        paths.append(path)
    return paths


def _places(space: FreeSpace, triangles: NDArray[np.float64] | None) -> dict[str, float]:
    """Where to cut [m], by the picture's name, which begins with the axis that is cut."""
    lower, upper = space.grid.lower_m, space.grid.upper_m
    heights = lower[2] + np.array(DEFAULT_HEIGHTS_M)
    if heights[-1] >= upper[2]:
        heights = lower[2] + np.array([0.15, 0.5, 0.85]) * (upper[2] - lower[2])
    middle = (lower + upper) / 2
    if triangles is not None and triangles.size:
        centre = (triangles.min(axis=(0, 1)) + triangles.max(axis=(0, 1))) / 2
        middle = np.where((centre > lower) & (centre < upper), centre, middle)
    places = dict(zip(("z1", "z2", "z3", "y", "x"), (*heights, middle[1], middle[0]), strict=True))
    return {name: round(float(at_m), 3) + 0.0 for name, at_m in places.items()}


def _section(
    space: FreeSpace,
    volume: NDArray[np.uint8],
    axis: str,
    at_m: float,
    triangles: NDArray[np.float64] | None,
    cameras: Sequence[DepthCamera],
) -> Image.Image:
    grid = space.grid
    if axis not in AXES or len(axis) != 1:
        raise InputError(f"section: axis is {axis!r}, allowed are x, y, z")
    normal = AXES.index(axis)
    layer = int(np.floor((at_m - grid.origin_m[normal]) / grid.voxel_size_m)) if np.isfinite(at_m) else -1
    if not 0 <= layer < grid.shape[normal]:
        raise InputError(
            f"section: {axis} = {at_m:g} m lies outside the grid, which reaches from "
            f"{grid.lower_m[normal]:g} to {grid.upper_m[normal]:g} m"
        )
    plane = list(PLANE_OF[normal])
    cut = np.take(volume, layer, axis=normal)
    plot = Plot.of_cells(colour_table()[cut], grid.lower_m[plane], grid.voxel_size_m)
    if triangles is not None:
        plot.draw_silhouette(triangles[:, :, plane], MACHINE_INK, 0.16)
        plot.draw_segments(cut_lines(triangles, normal, at_m)[:, :, plane], MACHINE_INK, 3)
    drawn = sum(
        plot.draw_wedge(camera.centre_in_world[plane], camera.world_from_camera[plane, 2], CAMERA_INK)
        for camera in cameras
    )
    plot.draw_axes(AXES[plane[0]], AXES[plane[1]])
    _title(
        plot, f"{'Horizontal' if normal == 2 else 'Vertical'} section at {axis} = {at_m:.2f} m", space, volume
    )
    _legend(plot, cut, triangles is not None, drawn)
    return plot.picture


def _title(plot: Plot, title: str, space: FreeSpace, volume: NDArray[np.uint8]) -> None:
    pen = ImageDraw.Draw(plot.picture)
    size = " x ".join(f"{n * space.grid.voxel_size_m:.1f}" for n in space.grid.shape)
    whole = ", ".join(f"{WORDS[label]} {share:.1%}" for label, share in shares(volume).items() if share > 0)
    pen.text((LEFT_PX, 14), title, fill=INK, font=font(28))
    pen.text(
        (LEFT_PX, 50),
        f"{size} m in voxels of {space.grid.voxel_size_m * 100:g} cm, of which {whole}",
        fill=SOFT_INK,
        font=font(17),
    )


def _legend(plot: Plot, cut: NDArray[np.uint8], with_machine: bool, cameras: int) -> None:
    """Swatches with the shares of this section, and below them what the lines and marks are."""
    pen = ImageDraw.Draw(plot.picture)
    text = font(18)
    y = plot.picture.height - 84
    x = float(LEFT_PX)
    for label, share in shares(cut).items():
        if label is Label.BODY and not with_machine and share == 0:
            continue
        pen.rectangle((x, y, x + 20, y + 20), fill=COLOURS[label], outline=INK)
        words = f"{WORDS[label]} {share:.1%}"
        pen.text((x + 28, y + 10), words, fill=INK, font=text, anchor="lm")
        x += 28 + pen.textlength(words, font=text) + 30
    x, y = float(LEFT_PX), y + 36
    if with_machine:
        pen.line((x, y + 10, x + 20, y + 10), fill=MACHINE_INK, width=3)
        words = "machine where this section cuts it; shaded: its silhouette"
        pen.text((x + 28, y + 10), words, fill=INK, font=text, anchor="lm")
        x += 28 + pen.textlength(words, font=text) + 30
    if cameras:
        pen.ellipse((x + 5, y + 5, x + 15, y + 15), fill=CAMERA_INK)
        pen.text(
            (x + 28, y + 10),
            "1 camera, and where it looks" if cameras == 1 else f"{cameras} cameras, and where they look",
            fill=INK,
            font=text,
            anchor="lm",
        )
