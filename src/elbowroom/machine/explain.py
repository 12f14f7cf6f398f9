"""Which pixels of a depth image are the machine itself, and what touches it."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from elbowroom.geometry import DepthCamera, VoxelGrid
from elbowroom.geometry.bits import Words
from elbowroom.machine.machine import Joints, Machine


@dataclass(frozen=True, slots=True, eq=False)
class Explained:
    """What the machine explains of a set of depth images.

    Args:
        model_depth: by camera, shape (height, width), float32: 0 where the pixel is not explained; else up to where
            its ray is free, the nearest depth of the model in the pixel's 3x3 neighbourhood [m, the camera's kind].
        unexplained_words: plane of the grid: voxels near the body that hold a return that the machine does not
            explain; None if no grid was given.
    """

    model_depth: dict[str, NDArray[np.float32]]
    unexplained_words: Words | None


def explain_frames(
    machine: Machine,
    cameras: Sequence[DepthCamera],
    depths: Sequence[NDArray[np.float32]],
    joints_per_camera: Sequence[Joints],
    tolerance_m: float = 0.01,
    tolerance_sigmas: float = 5.5,
    grid: VoxelGrid | None = None,
    threads: int | None = None,
) -> Explained:
    """Explains the pixels of depth images by the machine's model."""
    raise NotImplementedError
