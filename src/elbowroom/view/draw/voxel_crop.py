"""What each camera saw about one voxel: a part of its depth image, with the voxel drawn in."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw

from elbowroom.files.atomic import folder, whole_file
from elbowroom.geometry import DepthCamera, VoxelGrid
from elbowroom.reconstruct.point_report import CameraSight, PointReport
from elbowroom.reconstruct.sight import not_the_machine
from elbowroom.reconstruct.source import ImageSource
from elbowroom.view.draw.depth import depth_picture
from elbowroom.view.draw.palette import INK, PAPER
from elbowroom.view.draw.plot import font

SIDE_PX = 480
"""Of the enlarged part of an image."""
TEXT_PX = 112
LEAST_PX = 24
"""So much of an image is shown at least, across and down [its pixels]."""
VOXELS_ABOUT = 6
"""So many voxels are shown to each side of the one that is asked about."""
COLOURS_M = 0.3
"""Colours go from so far before the voxel to so far behind it [m]."""
VOXEL = (220, 38, 38)
MACHINE_TINT = np.array([255, 255, 255])
EDGES = [(a, b) for a in range(8) for b in range(a) if (a ^ b) in (1, 2, 4)]
"""Of a cube whose corners are numbered by the bits of x, y and z."""


def save_voxel_crops(out: Path, source: ImageSource, grid: VoxelGrid, report: PointReport) -> list[Path]:
    """Writes `<camera>.png` for each camera that has all of the voxel in its image.

    Args:
        out: the folder, made if it is not there.
        source: the images that the report was made of.
        grid: of the voxel.
        report: what each camera saw there.

    Returns:
        The files, nearest camera first.

    Raises:
        InputError: the folder cannot be made or written to.
    """
    folder(out)
    paths = []
    for seen in report.cameras:
        picture = voxel_crop(source, grid, report, seen)
        if picture is None:
            continue
        with whole_file(out / f"{seen.camera}.png") as unfinished:
            picture.save(unfinished, format="PNG", optimize=True)
        paths.append(out / f"{seen.camera}.png")
    return paths


def voxel_crop(
    source: ImageSource, grid: VoxelGrid, report: PointReport, seen: CameraSight
) -> Image.Image | None:
    """The part of a camera's image about a voxel; None: it is not all in the image, or there is no image.

    Near is yellow, far violet, no return white; what the machine explains is paler.

    Args:
        source: the images that the report was made of.
        grid: of the voxel.
        report: of the voxel.
        seen: what this camera saw there.
    """
    images = source.images.of(seen.camera)
    image = images.least_m.get(seen.camera)
    if seen.reach_m is None or image is None:
        return None
    (camera,) = images.cameras
    corners = _corners_px(camera, grid, report.index)
    rows, columns = _window(camera, corners)
    near, far = seen.reach_m
    picture = depth_picture(image[rows, columns], near_m=near - COLOURS_M, far_m=far + COLOURS_M)
    picture = _with_machine(picture, camera, image, source, (rows, columns))
    zoom = SIDE_PX / max(picture.size)
    size = (round(picture.width * zoom), round(picture.height * zoom))
    sheet = Image.new("RGB", (max(size[0], SIDE_PX), size[1] + TEXT_PX), PAPER)
    sheet.paste(picture.resize(size, Image.Resampling.NEAREST), (0, TEXT_PX))
    draw = ImageDraw.Draw(sheet)
    # the middle of pixel 0 lies half a pixel from the edge
    places = (corners - (columns.start, rows.start) + 0.5) * zoom + (0, TEXT_PX)
    for a, b in EDGES:
        draw.line([*map(float, places[a]), *map(float, places[b])], fill=VOXEL, width=2)
    for line, text in enumerate(_words(report, seen)):
        draw.text((8, 6 + 20 * line), text, INK, font=font(15))
    return sheet


def _words(report: PointReport, seen: CameraSight) -> Sequence[str]:
    parts = str(seen).removeprefix(f"{seen.camera}, ").split("; ")
    away, _, voxel = parts[0].partition(": ")
    return [f"{seen.camera}, {away}: {seen.sight.value}", f"{voxel}, {report.state}", *parts[1:]]


def _corners_px(camera: DepthCamera, grid: VoxelGrid, index: tuple[int, int, int]) -> NDArray[np.float64]:
    """Columns and rows of a voxel's corners in the pinhole image, shape (8, 2) [px]."""
    bits = np.array([[n & 1, n >> 1 & 1, n >> 2 & 1] for n in range(8)])
    corners = grid.lower_m + (np.array(index) + bits) * grid.voxel_size_m
    in_camera = corners @ camera.camera_from_world[:3, :3].T + camera.camera_from_world[:3, 3]
    k, z = camera.intrinsics, np.maximum(in_camera[:, 2], 1e-6)
    return np.stack([k.fx * in_camera[:, 0] / z + k.cx, k.fy * in_camera[:, 1] / z + k.cy], axis=1)


def _window(camera: DepthCamera, corners: NDArray[np.float64]) -> tuple[slice, slice]:
    """Rows and columns of a square about a voxel, within the image."""
    middle, size = corners.mean(axis=0), float(np.ptp(corners, axis=0).max())
    half = max(LEAST_PX / 2, (VOXELS_ABOUT + 0.5) * size)
    spans = []
    for at, length in ((middle[1], camera.height), (middle[0], camera.width)):
        first = int(np.clip(np.floor(at - half), 0, length - 1))
        spans.append(slice(first, int(np.clip(np.ceil(at + half), first + 1, length))))
    return spans[0], spans[1]


def _with_machine(
    picture: Image.Image,
    camera: DepthCamera,
    image: NDArray[np.float32],
    source: ImageSource,
    window: tuple[slice, slice],
) -> Image.Image:
    """The picture with what the machine explains paler."""
    foreign, valid = not_the_machine(camera, image, source.model_depth, window)
    colours = np.array(picture, dtype=np.float64)
    own = valid & ~foreign
    colours[own] = 0.45 * colours[own] + 0.55 * MACHINE_TINT
    return Image.fromarray(colours.round().astype(np.uint8))
