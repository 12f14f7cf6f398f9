"""What a placement sees, as pictures: the plan with lines of sight (thesis Fig. 5), sections by count and validity."""

from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw

from elbowroom.files.atomic import folder, whole_file
from elbowroom.geometry import DepthCamera
from elbowroom.placement.fixed_room import FixedRoom
from elbowroom.placement.verification import Verification
from elbowroom.view.draw.outline import cut_lines
from elbowroom.view.draw.palette import CAMERA_INK, INK, PAPER, SOFT_INK, Colour
from elbowroom.view.draw.plot import LEFT_PX, Plot, font

VALID, INVALID, FIXED = (222, 239, 248), (213, 94, 0), (126, 131, 138)
LINE_INK = (0, 114, 178)
WATCHED_INK = (0, 158, 115)
COUNT_COLOURS = np.array(
    [
        (68, 1, 84),
        (70, 50, 127),
        (54, 92, 141),
        (39, 127, 142),
        (31, 161, 135),
        (74, 193, 109),
        (160, 218, 57),
        (253, 231, 37),
    ],
    dtype=np.uint8,
)
"""Viridis in eight steps: few views dark, many light."""
MARGIN_M = 0.3
SIGHT_M = 7.0
HEIGHT_M = 1.0


def save_pictures(found: Verification, room: FixedRoom | None, out_dir: Path | str, name: str) -> list[Path]:
    """Writes plan.png and sections views_z.png, views_x.png, valid_z.png, valid_x.png; returns their paths.

    The horizontal section is the layer with the fewest valid points, the vertical one goes through the middle.

    Args:
        found: what was verified.
        room: drawn where sections cut it; None: not drawn.
        out_dir: folder to write into; made if it is not there.
        name: of the room.

    Raises:
        InputError: the folder cannot be written to.
    """
    out_dir = folder(out_dir)
    failing = (found.asked & ~found.valid).sum(axis=(0, 1))
    worst = int(np.argmax(failing)) if failing.any() else found.grid.shape[2] // 2
    middle = found.grid.shape[0] // 2
    pictures = {
        "plan": plan(found, room, name),
        "views_z": section(found, room, 2, worst, by_count=True),
        "valid_z": section(found, room, 2, worst, by_count=False),
        "views_x": section(found, room, 0, middle, by_count=True),
        "valid_x": section(found, room, 0, middle, by_count=False),
    }
    return [save(picture, out_dir / f"{file}.png") for file, picture in pictures.items()]


def save(picture: Image.Image, path: Path) -> Path:
    """Writes a picture, whole or not at all, and returns its path.

    Raises:
        InputError: the folder cannot be written to.
    """
    with whole_file(path) as unfinished:
        picture.save(unfinished, format="PNG")
    return path


def plan(found: Verification, room: FixedRoom | None, name: str) -> Image.Image:
    """The room from above: cameras with the edges of their fields of view, walls, the watched box (thesis Fig. 5).

    The floor of the watched box is coloured by the share of valid points above it.

    Args:
        found: what was verified.
        room: walls and furniture; None: not known.
        name: of the room, in the title.
    """
    grid = found.grid
    eyes = np.array([camera.centre_in_world for camera in found.cameras])
    outer = [grid.lower_m[:2], grid.upper_m[:2], eyes[:, :2].min(axis=0), eyes[:, :2].max(axis=0)]
    if room is not None and room.walls_m is not None:
        outer += [room.walls_m[0, :2], room.walls_m[1, :2]]
    cell = grid.voxel_size_m
    first = np.floor((np.min(outer, axis=0) - MARGIN_M - grid.lower_m[:2]) / cell).astype(int)
    last = np.ceil((np.max(outer, axis=0) + MARGIN_M - grid.lower_m[:2]) / cell).astype(int)
    cells = np.full((*(last - first), 3), 255, dtype=np.uint8)
    asked = found.asked.sum(axis=2)
    share = found.valid.sum(axis=2) / np.maximum(asked, 1)
    colours = _mix(np.array(INVALID), np.array(VALID), share)
    colours[asked == 0] = FIXED
    at = tuple(slice(-f, -f + n) for f, n in zip(first, grid.shape[:2], strict=True))
    cells[at] = colours
    plot = Plot.of_cells(cells, grid.lower_m[:2] + first * cell, cell)
    plot.draw_segments(_sight_lines(found.cameras, room), LINE_INK, 1)
    plot.draw_segments(_frame(grid.lower_m[:2], grid.upper_m[:2]), WATCHED_INK, 3)
    if room is not None:
        plot.draw_segments(_cuts(room), INK, 2)
    for camera in found.cameras:
        plot.draw_wedge(camera.centre_in_world[:2], camera.world_from_camera[:2, 2], CAMERA_INK)
    for camera in found.cameras:
        plot.draw_name(camera.centre_in_world[:2], camera.name)
    plot.draw_axes("x", "y")
    title(
        plot,
        f"{name}: {len(found.cameras)} cameras",
        f"{found.valid_pct:.2f} % of the watched points are valid: {found.requirement.words}",
    )
    legend(
        plot,
        {"every point of the column is valid": VALID, "none of it is": INVALID},
        {
            "watched box": WATCHED_INK,
            "edges of fields of view": LINE_INK,
            f"walls and furniture, cut at {HEIGHT_M:g} m or at half their height": INK,
        },
    )
    return plot.picture


def section(
    found: Verification, room: FixedRoom | None, normal: int, layer: int, *, by_count: bool
) -> Image.Image:
    """One layer of voxels, coloured by the number of views or by validity.

    Args:
        found: what was verified.
        room: drawn where the section cuts it; None: not drawn.
        normal: axis that is cut: 0 x, 1 y, 2 z.
        layer: index along it.
        by_count: colour by the number of cameras that see a voxel; else by whether it is valid.
    """
    plane = [axis for axis in range(3) if axis != normal]
    counts, asked, valid = (
        np.take(volume, layer, axis=normal) for volume in (found.counts, found.asked, found.valid)
    )
    swatches: dict[str, Colour] = {}
    if by_count:
        bounds = _bounds(len(found.cameras))
        step = np.searchsorted(bounds, counts, side="right") - 1
        colours = COUNT_COLOURS[step]
        ends = [*(b - 1 for b in bounds[1:]), len(found.cameras)]
        swatches = {
            (f"{low}" if low == high else f"{low}-{high}"): tuple(int(v) for v in COUNT_COLOURS[n])  # type: ignore[misc]
            for n, (low, high) in enumerate(zip(bounds, ends, strict=True))
            if low <= high
        }
    else:
        colours = np.where(
            valid[..., None], np.array(VALID, dtype=np.uint8), np.array(INVALID, dtype=np.uint8)
        )
        asked_here = max(int(asked.sum()), 1)
        share = 100 * valid.sum() / asked_here
        swatches = {f"valid {share:.1f} %": VALID, f"not valid {100 - share:.1f} %": INVALID}
    colours = np.where(asked[..., None], colours, np.array(FIXED, dtype=np.uint8)).astype(np.uint8)
    swatches["walls, furniture"] = FIXED
    centre = float(found.grid.centre_of(np.eye(3)[normal] * layer)[normal])
    plot = Plot.of_cells(colours, found.grid.lower_m[plane], found.grid.voxel_size_m)
    if room is not None:
        plot.draw_segments(cut_lines(room.triangles, normal, centre)[:, :, plane], INK, 2)
    for camera in found.cameras:
        plot.draw_wedge(camera.centre_in_world[plane], camera.world_from_camera[plane, 2], CAMERA_INK)
    plot.draw_axes("xyz"[plane[0]], "xyz"[plane[1]])
    what = "Number of cameras that see it" if by_count else "Valid points"
    title(
        plot,
        f"{what} at {'xyz'[normal]} = {centre:.2f} m",
        f"{len(found.cameras)} cameras; {found.valid_pct:.2f} % of the volume: {found.requirement.words}",
    )
    legend(plot, swatches, {})
    return plot.picture


def _bounds(cameras: int) -> list[int]:
    """The least count of each colour: 0, 1, 2, 3, then in even steps up to all cameras."""
    rest = np.unique(np.linspace(4, max(cameras, 5), len(COUNT_COLOURS) - 3).astype(int))[:-1]
    return [0, 1, 2, 3, *(int(b) for b in rest if b <= cameras)]


def _cuts(room: FixedRoom) -> NDArray[np.float64]:
    """Outlines of what stands in a room from above, shape (n, 2, 2) [m]: what is lower is cut at half its height."""
    cuts = [np.zeros((0, 2, 2))]
    for solid in room.moment.solids:
        corners = solid.vertices_in_world
        low, high = corners[:, 2].min(), corners[:, 2].max()
        height = HEIGHT_M if low < HEIGHT_M < high else (low + high) / 2
        if height <= HEIGHT_M and high > 0.02:
            cuts.append(cut_lines(corners[solid.mesh.faces], 2, height + 1e-3)[:, :, :2])
    return np.concatenate(cuts)


def _sight_lines(cameras: Sequence[DepthCamera], room: FixedRoom | None) -> NDArray[np.float64]:
    """Left and right edge of each field of view from above, to the walls or the sensor's range, shape (n, 2, 2) [m]."""
    lines = []
    for camera in cameras:
        k = camera.intrinsics
        eye = camera.centre_in_world[:2]
        for u in (-0.5, camera.width - 0.5):
            ray = camera.world_from_camera[:3, :3] @ np.array([(u - k.cx) / k.fx, 0.0, 1.0])
            length = float(np.linalg.norm(ray[:2]))
            if length < 1e-6:
                continue
            direction = ray[:2] / length
            reach = min(SIGHT_M, camera.max_depth_m)
            if room is not None and room.walls_m is not None:
                with np.errstate(divide="ignore", invalid="ignore"):
                    walls = np.where(direction > 0, room.walls_m[1, :2], room.walls_m[0, :2])
                    ways = (walls - eye) / direction
                reach = min(reach, float(np.nanmin(np.where(ways > 1e-6, ways, np.inf))))
            lines.append((eye, eye + reach * direction))
    return np.array(lines).reshape(-1, 2, 2)


def _frame(lower: NDArray[np.float64], upper: NDArray[np.float64]) -> NDArray[np.float64]:
    corners = np.array([lower, (upper[0], lower[1]), upper, (lower[0], upper[1])])
    return np.stack([corners, np.roll(corners, -1, axis=0)], axis=1)


def _mix(low: NDArray[np.int64], high: NDArray[np.int64], share: NDArray[np.float64]) -> NDArray[np.uint8]:
    return np.asarray(low + (high - low) * share[..., None]).round().astype(np.uint8)


def title(plot: Plot, words: str, below: str) -> None:
    """Two lines above the area.

    Args:
        plot: where they are drawn.
        words, below: the first line, and the second in smaller letters.
    """
    pen = ImageDraw.Draw(plot.picture)
    pen.text((LEFT_PX, 14), words, fill=INK, font=font(28))
    pen.text((LEFT_PX, 52), below, fill=SOFT_INK, font=font(17))


def legend(plot: Plot, swatches: Mapping[str, Colour], lines: Mapping[str, Colour]) -> None:
    """Filled squares, and below them lines, each with its words.

    Args:
        plot: where they are drawn.
        swatches, lines: colours by what they stand for.
    """
    pen = ImageDraw.Draw(plot.picture)
    text = font(18)
    y = plot.picture.height - 84
    for marks, as_line in ((swatches, False), (lines, True)):
        x = float(LEFT_PX)
        for words, colour in marks.items():
            if as_line:
                pen.line((x, y + 10, x + 20, y + 10), fill=colour, width=4)
            else:
                pen.rectangle(
                    (x, y, x + 20, y + 20), fill=colour, outline=INK if colour != PAPER else SOFT_INK
                )
            pen.text((x + 28, y + 10), words, fill=INK, font=text, anchor="lm")
            x += 28 + pen.textlength(words, font=text) + 26
        y += 36
