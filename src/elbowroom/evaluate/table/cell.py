"""The cell: an arm on a table with a bin, six depth cameras about it, images with the noise of a D435."""

from typing import NamedTuple

import numpy as np

from elbowroom.geometry import DepthCamera, Intrinsics, VoxelGrid
from elbowroom.geometry.margin import Margin
from elbowroom.geometry.transforms import looking_at
from elbowroom.machine import Contact, Machine
from elbowroom.reconstruct import Terms
from elbowroom.sensing import NOISE_PRESETS
from elbowroom.simulate import Solid
from elbowroom.simulate.shapes import box, join

TOP_M = 0.75
TABLE = (-0.6, -0.4, 0.70), (0.6, 0.4, TOP_M)
BIN = (0.33, 0.12, TOP_M), (0.53, 0.34, 0.87)
EYES = {
    "nw": (-0.95, 0.95, 1.95),
    "ne": (0.95, 0.95, 1.95),
    "sw": (-0.95, -0.95, 1.95),
    "se": (0.95, -0.95, 1.95),
    "low_w": (-0.62, -0.42, 1.10),
    "low_e": (0.62, 0.42, 1.10),
}
"""Where cameras hang [m]: four over the table, two along its top; all look at the arm's middle."""
SIZES = {"200x150": (200, 150, 121.0), "424x240": (424, 240, 210.0), "848x480": (848, 480, 420.0)}
"""Width, height, focal length in pixels."""
WALL_M, HIGH_M = 2.2, 2.8
TERMS = Terms(margin=Margin(sigmas=3.0, bias_m=0.01, lateral_px=0.5))


class Cell(NamedTuple):
    """What stands still: the watched box, the cameras, the solids."""

    grid: VoxelGrid
    cameras: tuple[DepthCamera, ...]
    solids: tuple[Solid, ...]


def cell(voxel_size_m: float, size: str) -> Cell:
    """The cell without its arm.

    Args:
        voxel_size_m: edge of a voxel [m].
        size: of images, one of `SIZES`.
    """
    width, height, focal = SIZES[size]
    lens = Intrinsics(focal, focal, (width - 1) / 2, (height - 1) / 2)
    cameras = tuple(
        DepthCamera(
            name,
            width,
            height,
            looking_at(eye, (0.0, 0.0, 1.05)),
            lens,
            noise=NOISE_PRESETS["realsense_d435"],
            min_depth_m=0.2,
            max_depth_m=6.0,
        )
        for name, eye in EYES.items()
    )
    w = WALL_M
    walls = [
        box((-w, -w, -0.1), (w, w, 0.0)),
        box((-w, -w, HIGH_M), (w, w, HIGH_M + 0.1)),
        *(box((x, -w, 0), (x + 0.1, w, HIGH_M)) for x in (-w - 0.1, w)),
        *(box((-w, y, 0), (w, y + 0.1, HIGH_M)) for y in (-w - 0.1, w)),
    ]
    solids = (
        Solid("room", join(walls), np.eye(4), is_static=True),
        Solid("table", join([box(*TABLE)]), np.eye(4), is_static=True),
        Solid("bin", join([box(*BIN)]), np.eye(4), is_static=True),
    )
    return Cell(VoxelGrid.covering((-1.2, -1.2, 0.68), (1.2, 1.2, 2.28), voxel_size_m), cameras, solids)


def on_the_table(machine: Machine) -> Machine:
    """The arm with its base on the table's top."""
    pose = np.eye(4)
    pose[2, 3] = TOP_M
    return machine.at(pose)


def near_the_table(machine: Machine, links: tuple[str, ...]) -> Machine:
    """The arm with links that may be near the table.

    Args:
        machine: the arm.
        links: their names.
    """
    return machine.near(Contact.box("table", links, *TABLE, near_m=0.15))
