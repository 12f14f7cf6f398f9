"""Cameras, machine and grid from above and from the side, as a picture to look at before anything is measured."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageChops, ImageDraw, ImageFilter, ImageFont
from scipy.spatial import ConvexHull, QhullError

from elbowroom.geometry import DepthCamera, VoxelGrid

VIEW_PX, EDGE_PX, TITLE_PX = 720, 60, 64
PAPER, INK, SOFT = (250, 250, 248, 255), (30, 34, 40, 255), (110, 116, 124, 255)
GRID_FILL, FAN_FILL, FAN_EDGE, DOT = (
    (222, 239, 248, 255),
    (0, 114, 178, 40),
    (0, 114, 178, 120),
    (213, 94, 0, 255),
)
MACHINE, MACHINE_OPACITY = (64, 70, 78), 0.35
NAME_WIDTH_PX, NAME_HEIGHT_PX = 64, 15
"""A name that would lie on another within this distance is left out."""
REACH = ((4, 0.75), (8, 0.25), (255, 0.08))
"""Up to so many cameras, fields of view are drawn to so much of the box's diagonal: few so far that it is seen
where they overlap, many so short that it is seen which is whose."""
STEPS_M = (0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 50.0)


class _View(NamedTuple):
    """Two axes of the world as a plane of the picture."""

    axes: tuple[int, int]
    title: str
    left_px: int
    lower_m: NDArray[np.float64]
    px_per_m: float

    def at(self, points_in_world: NDArray[np.float64]) -> list[tuple[float, float]]:
        """Where points are drawn; the second axis goes up."""
        place = (np.atleast_2d(points_in_world)[:, self.axes] - self.lower_m) * self.px_per_m
        return [(self.left_px + x, TITLE_PX + VIEW_PX - y) for x, y in place]


def draw_site(
    name: str,
    grid: VoxelGrid,
    cameras: Sequence[DepthCamera],
    machine_in_world: NDArray[np.float64] | None = None,
) -> Image.Image:
    """Grid, machine and fields of view, projected along z (x and y shown) and along y (x and z shown).

    Args:
        name: title of the picture.
        grid: the watched box.
        cameras: their fields of view are drawn to a share of the box's diagonal, but not beyond their range.
        machine_in_world: the machine's triangles where it stands, shape (n, 3, 3) [m]; None: no machine.

    Returns:
        An RGB picture.
    """
    diagonal_m = float(np.linalg.norm(grid.upper_m - grid.lower_m))
    reach_m = diagonal_m * next((share for most, share in REACH if len(cameras) <= most), REACH[-1][1])
    triangles = np.zeros((0, 3, 3)) if machine_in_world is None else machine_in_world
    frusta = [frustum_in_world(camera, min(camera.max_depth_m, reach_m)) for camera in cameras]
    everything = np.concatenate([grid.lower_m[None], grid.upper_m[None], triangles.reshape(-1, 3), *frusta])
    lower, upper = everything.min(axis=0), everything.max(axis=0)
    px_per_m = (VIEW_PX - 20) / float((upper - lower).max())
    picture = Image.new("RGBA", (2 * VIEW_PX + 3 * EDGE_PX, VIEW_PX + TITLE_PX + EDGE_PX), PAPER)
    for column, (axes, title) in enumerate((((0, 1), "along z: x and y"), ((0, 2), "along y: x and z"))):
        view = _View(axes, title, EDGE_PX + column * (VIEW_PX + EDGE_PX), lower[list(axes)], px_per_m)
        _draw_view(picture, view, grid, triangles, cameras, frusta, upper)
    draw = ImageDraw.Draw(picture)
    shape = " x ".join(map(str, grid.shape))
    text = f"{name}: {len(cameras)} cameras, {shape} voxels of {grid.voxel_size_m * 100:g} cm"
    draw.text((EDGE_PX, 10), text, INK, font=_font(20))
    return picture.convert("RGB")


def frustum_in_world(camera: DepthCamera, depth_m: float) -> NDArray[np.float64]:
    """Camera centre and the corners of its image at a depth, shape (5, 3), world frame [m].

    Args:
        camera: its distortion is left out.
        depth_m: along the optical axis [m].
    """
    k = camera.intrinsics
    x = (np.array([-0.5, camera.width - 0.5]) - k.cx) / k.fx
    y = (np.array([-0.5, camera.height - 0.5]) - k.cy) / k.fy
    rays = np.array([[0, 0, 0], [x[0], y[0], 1], [x[1], y[0], 1], [x[1], y[1], 1], [x[0], y[1], 1]])
    return rays * depth_m @ camera.world_from_camera[:3, :3].T + camera.centre_in_world


def _draw_view(
    picture: Image.Image,
    view: _View,
    grid: VoxelGrid,
    triangles_in_world: NDArray[np.float64],
    cameras: Sequence[DepthCamera],
    frusta: Sequence[NDArray[np.float64]],
    upper_m: NDArray[np.float64],
) -> None:
    draw = ImageDraw.Draw(picture)
    draw.text((view.left_px, TITLE_PX - 24), view.title, SOFT, font=_font(15))
    (left, bottom), (right, top) = view.at(np.stack([grid.lower_m, grid.upper_m]))
    draw.rectangle((left, top, right, bottom), fill=GRID_FILL, outline=INK, width=2)
    for frustum in frusta:
        # each fan on a sheet of its own, so that where many look the colour deepens
        sheet = Image.new("RGBA", picture.size, (0, 0, 0, 0))
        ImageDraw.Draw(sheet).polygon(_outline(view.at(frustum)), fill=FAN_FILL, outline=FAN_EDGE)
        picture.alpha_composite(sheet)
    _draw_machine(picture, view, triangles_in_world)
    draw = ImageDraw.Draw(picture)
    named: list[tuple[float, float]] = []
    for camera in cameras:
        ((x, y),) = view.at(camera.centre_in_world)
        draw.ellipse((x - 4, y - 4, x + 4, y + 4), fill=DOT)
        if all(abs(x - a) > NAME_WIDTH_PX or abs(y - b) > NAME_HEIGHT_PX for a, b in named):
            draw.text((x + 6, y - 6), camera.name, INK, font=_font(12), stroke_width=2, stroke_fill=PAPER)
            named.append((x, y))
    _draw_scale(draw, view, upper_m)


def _draw_machine(picture: Image.Image, view: _View, triangles_in_world: NDArray[np.float64]) -> None:
    """The shadow of all triangles, with an outline."""
    shadow = Image.new("L", picture.size, 0)
    pen = ImageDraw.Draw(shadow)
    corners = view.at(triangles_in_world.reshape(-1, 3))
    for first in range(0, len(corners), 3):
        pen.polygon(corners[first : first + 3], fill=255)
    outline = ImageChops.subtract(shadow, shadow.filter(ImageFilter.MinFilter(3)))
    picture.paste(MACHINE, mask=shadow.point(lambda covered: int(covered * MACHINE_OPACITY)))
    picture.paste(MACHINE, mask=outline)


def _draw_scale(draw: ImageDraw.ImageDraw, view: _View, upper_m: NDArray[np.float64]) -> None:
    """Ticks in metres along both axes, some six of them."""
    extent = float((upper_m[list(view.axes)] - view.lower_m).max())
    step = next((step for step in STEPS_M if extent / step <= 8), STEPS_M[-1])
    base = TITLE_PX + VIEW_PX + 12
    for axis in (0, 1):
        first = np.ceil(view.lower_m[axis] / step) * step
        for value in np.arange(first, upper_m[view.axes[axis]] + 1e-9, step):
            offset = (value - view.lower_m[axis]) * view.px_per_m
            at = (
                (view.left_px + offset, base)
                if axis == 0
                else (view.left_px - 30, TITLE_PX + VIEW_PX - offset)
            )
            draw.text(at, f"{value + 0.0:g}", SOFT, font=_font(12), anchor="mm")
        name = "xyz"[view.axes[axis]]
        at = (view.left_px + VIEW_PX - 10, base + 18) if axis == 0 else (view.left_px - 30, TITLE_PX - 14)
        draw.text(at, f"{name} [m]", INK, font=_font(13), anchor="mm")


def _outline(points: list[tuple[float, float]]) -> list[tuple[float, float]]:
    """The corners of the smallest convex area that holds all points, in order."""
    try:
        return [points[i] for i in ConvexHull(np.array(points)).vertices]
    except QhullError:
        return points


def _font(size: int) -> ImageFont.ImageFont | ImageFont.FreeTypeFont:
    return ImageFont.load_default(size=size)
