"""Frames to evidence on a GPU: as `elbowroom.carve`, with the same bits."""

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from elbowroom.geometry import DepthCamera, VoxelGrid
from elbowroom.geometry.kernels.bits import Lattice
from elbowroom.geometry.margin import Margin
from elbowroom.gpu.device import cuda, launch
from elbowroom.gpu.kernels.carve import Carving
from elbowroom.gpu.kernels.threads import carve_words
from elbowroom.machine import Explained
from elbowroom.reconstruct.carve import carve_images
from elbowroom.reconstruct.evidence import Evidence
from elbowroom.reconstruct.images import room_images
from elbowroom.reconstruct.kernels.camera import Views
from elbowroom.reconstruct.kernels.planes import Answers
from elbowroom.reconstruct.terms import Terms
from elbowroom.sensing import DepthFrame


def carve_on_gpu(
    grid: VoxelGrid,
    cameras: Sequence[DepthCamera],
    frames: Sequence[DepthFrame],
    *,
    margin: Margin | None = None,
    aged_m: Mapping[str, float] | None = None,
    model_depth: Mapping[str, NDArray[np.float32]] | None = None,
    complete: bool = False,
) -> Evidence:
    """As `elbowroom.carve` of detail `pixel`, every camera asked of every voxel by the pixel test, a thread for 64.

    Args:
        grid: the watched box.
        cameras: of the room.
        frames: of its cameras, each of its camera's size [m].
        margin: how far cameras may err; None: as good as they can be.
        aged_m: by camera, how far anything may have moved since its frame [m]; None: not at all.
        model_depth: by camera, what the machine explains, shape (height, width) [m]; None: nothing.
        complete: whether all cameras are counted.

    Raises:
        PackageError: numba-cuda is not installed.
        InputError, CameraError, FrameError: as `elbowroom.carve`.
    """
    cuda()
    images = room_images(cameras, frames, aged_m)
    explained = Explained(dict(model_depth or {}), None)
    terms = Terms(margin=margin or Margin())
    return carve_images(grid, images, explained, terms, complete=complete, carver=_carve_cubes)


def _carve_cubes(cubes: NDArray[np.int64], lattice: Lattice, views: Views, answers: Answers) -> None:
    words = (np.asarray(cubes)[:, None] * 64 + np.arange(64)).ravel()
    words = np.ascontiguousarray(words[answers.asked[words] != 0], dtype=np.int64)
    launch(carve_words, len(words), Carving(words, lattice, views, answers))
