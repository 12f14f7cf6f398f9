"""The thesis' Fig. 3 made by the program: from four images to safe and unsafe moving distances, seen from above."""

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw

from elbowroom.evaluate.rooms.scene import room_grid
from elbowroom.evaluate.thesis.cases import as_png
from elbowroom.geometry import VoxelGrid
from elbowroom.machine import Machine
from elbowroom.reconstruct import reconstruct
from elbowroom.simulate import Moment, Setup, render, true_occupancy, wall_cameras
from elbowroom.simulate.machine_solids import link_solids
from elbowroom.view.draw.plot import font

AT_M = 1.62
"""Height of the section: detector, column, shoulders, lamp's handle [m]."""
SIDE_PX, GAP_PX, HEAD_PX = 230, 14, 24
FREE, BLOCKED, ROBOT, HIT, INK = (193, 231, 190), (96, 104, 116), (32, 84, 190), (220, 30, 30), (24, 32, 44)
MOVES = ({"long": 0.05}, {"larm": -0.3}, {"larm": 0.45})
"""The new positions, from the setup's pose [m or rad]."""
NUMERALS = ("I", "II", "III", "IV", "V", "VI", "VII", "VIII", "IX", "X", "XI", "XII", "XIII")


def fig3_picture(setup: Setup, machine: Machine) -> bytes:
    """Thirteen tiles, PNG.

    Args:
        setup: the room.
        machine: the C-arm.
    """
    grid = room_grid(0.04)
    layer = int((AT_M - grid.lower_m[2]) / grid.voxel_size_m)
    moment = setup.at(machine)
    views = wall_cameras(4, (2.4, 2.0), width=320, height=240)
    frames = render(views, moment, noise=False)
    tiles = [
        _tile(reconstruct(grid, [view], [frame], looks=False).free[:, :, layer])
        for view, frame in zip(views, frames, strict=True)
    ]
    together = reconstruct(grid, views, frames, rule="any", looks=False).free
    tiles.append(_tile(together[:, :, layer]))
    here = _body(machine, dict(moment.joints), grid)
    nothing = np.zeros(grid.shape[:2], dtype=np.bool_)
    tiles.append(_tile(~nothing, robot=here[:, :, layer]))
    model = reconstruct(
        grid, views, frames, machine=machine, joints=moment.joints, rule="any", looks=False
    ).free
    tiles.append(_tile(model[:, :, layer]))
    bodies = []
    for move in MOVES:
        joints = {name: value + move.get(name, 0.0) for name, value in moment.joints.items()}
        bodies.append(_body(machine, joints, grid)[:, :, layer])
    tiles += [_tile(~nothing, robot=body) for body in bodies]
    tiles += [_tile(model[:, :, layer], robot=body, hit=body & ~model[:, :, layer]) for body in bodies]
    return _sheet(tiles)


def _body(machine: Machine, joints: dict[str, float], grid: VoxelGrid) -> NDArray[np.bool_]:
    return true_occupancy(grid, Moment(0.0, link_solids(machine, joints), joints)).machine


def _tile(
    free: NDArray[np.bool_], robot: NDArray[np.bool_] | None = None, hit: NDArray[np.bool_] | None = None
) -> Image.Image:
    """Free or blocked, the machine over it, its collisions over that."""
    colours = np.where(free[..., None], np.array(FREE), np.array(BLOCKED)).astype(np.uint8)
    for mask, colour in ((robot, ROBOT), (hit, HIT)):
        if mask is not None:
            colours[mask] = colour
    picture = Image.fromarray(np.ascontiguousarray(colours.transpose(1, 0, 2)[::-1]))
    return picture.resize((SIDE_PX, SIDE_PX), Image.Resampling.NEAREST)


def _sheet(tiles: list[Image.Image]) -> bytes:
    """Rows of I-IV, V-VII, VIII-X and XI-XIII."""
    rows, step = ((0, 4), (4, 7), (7, 10), (10, 13)), SIDE_PX + GAP_PX
    sheet = Image.new("RGB", (4 * step, 4 * (step + HEAD_PX)), (255, 255, 255))
    pen = ImageDraw.Draw(sheet)
    for row, (first, last) in enumerate(rows):
        for column, number in enumerate(range(first, last)):
            x, y = column * step + GAP_PX // 2, row * (step + HEAD_PX)
            pen.text((x, y + 2), NUMERALS[number], fill=INK, font=font(17))
            sheet.paste(tiles[number], (x, y + HEAD_PX))
            pen.rectangle((x - 1, y + HEAD_PX - 1, x + SIDE_PX, y + HEAD_PX + SIDE_PX), outline=INK)
    return as_png(sheet)
