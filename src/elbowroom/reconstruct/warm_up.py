"""Compiles what the loop uses before the machine is enabled."""

from collections.abc import Sequence

import numpy as np

from elbowroom.choices import DETAILS, Detail
from elbowroom.geometry import DepthCamera, Intrinsics, VoxelGrid
from elbowroom.geometry.margin import Margin
from elbowroom.machine import Machine
from elbowroom.reconstruct.images import room_images
from elbowroom.reconstruct.kernels.cone import VOXEL
from elbowroom.reconstruct.kernels.outline import OUTLINES, settle_block
from elbowroom.reconstruct.kernels.parts import ask_parts
from elbowroom.reconstruct.kernels.place import Boxes
from elbowroom.reconstruct.layout import layout_of
from elbowroom.reconstruct.parts import widened
from elbowroom.reconstruct.reconstruct import reconstruct
from elbowroom.reconstruct.views import fill
from elbowroom.sensing import DepthFrame, NoiseModel


def warm_up(machine: Machine | None = None, details: Sequence[Detail] = DETAILS) -> None:
    """Runs every kernel of reconstruction once on a tiny scene, so that none has to be compiled later.

    Takes seconds the first time on a computer; what was compiled is kept beside the package.

    Args:
        machine: also the kernels that explain and take out a body; None: those of the bare room.
        details: of `carve`, those that will be used.
    """
    grid, cameras, frames = _tiny_scene()
    middle = (
        None
        if machine is None
        else {j.name: min(max(0.0, j.lower), j.upper) for j in map(machine.joint, machine.joint_names)}
    )
    for detail in details:
        reconstruct(
            grid, cameras, frames, machine=machine, joints=middle, detail=detail, threads=1, looks=False
        )


def warm_up_pixel_test() -> None:
    """Runs the pyramid, the pixel test and the look at parts of voxels alone, which can be compiled beside the rest."""
    grid, cameras, frames = _tiny_scene()
    images = room_images(cameras, frames)
    layout = layout_of(grid, images.cameras, Margin())
    explained = {camera.name: np.full((24, 32), 1.1, dtype=np.float32) for camera in cameras}
    views, buffers = fill(layout, images, explained)
    try:
        boxes = Boxes(0.0, 0.0, 1.0, grid.voxel_size_m, 0)
        voxel, outlines = np.zeros(1, VOXEL)[0], np.zeros(1, OUTLINES)[0]
        settle_block(
            views.cameras[0], views.texels, (np.uint64(1), np.uint64(0)), False, boxes, (outlines, voxel)
        )
        ask_parts(widened(views), boxes, np.uint64(1), np.zeros(len(views.cameras), dtype=np.uint64))
    finally:
        layout.give_back(buffers)


def _tiny_scene() -> tuple[VoxelGrid, list[DepthCamera], list[DepthFrame]]:
    """Two cameras, one of them noisy, that look at a wall behind 8 x 8 x 8 voxels."""
    grid = VoxelGrid((-0.2, -0.2, 0.8), (8, 8, 8), 0.05)
    cameras = [
        DepthCamera(name, 32, 24, np.eye(4), Intrinsics(30, 30, 15.5, 11.5), noise=noise)
        for name, noise in (("exact", None), ("noisy", NoiseModel(0.001)))
    ]
    return (
        grid,
        cameras,
        [DepthFrame(camera.name, 0, np.full((24, 32), 1.1, dtype=np.float32)) for camera in cameras],
    )
