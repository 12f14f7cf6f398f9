"""Compiles what the loop uses before the machine is enabled."""

import numpy as np

from elbowroom.geometry import DepthCamera, Intrinsics, VoxelGrid
from elbowroom.machine import Machine
from elbowroom.reconstruct.carve import DETAILS
from elbowroom.reconstruct.reconstruct import reconstruct
from elbowroom.sensing import DepthFrame, NoiseModel


def warm_up(machine: Machine | None = None) -> None:
    """Runs every kernel of reconstruction once on a tiny scene, so that none has to be compiled later.

    Takes seconds the first time on a computer; what was compiled is kept beside the package.

    Args:
        machine: also the kernels that explain and take out a body; None: those of the bare room.
    """
    grid = VoxelGrid((-0.2, -0.2, 0.8), (8, 8, 8), 0.05)
    cameras = [
        DepthCamera(name, 32, 24, np.eye(4), Intrinsics(30, 30, 15.5, 11.5), noise=noise)
        for name, noise in (("exact", None), ("noisy", NoiseModel(0.001)))
    ]
    frames = [DepthFrame(camera.name, 0, np.full((24, 32), 1.1, dtype=np.float32)) for camera in cameras]
    middle = (
        None
        if machine is None
        else {j.name: min(max(0.0, j.lower), j.upper) for j in map(machine.joint, machine.joint_names)}
    )
    for detail in DETAILS:
        reconstruct(grid, cameras, frames, machine=machine, joints=middle, detail=detail, threads=1)
