"""What cameras say of the 64 parts of a voxel, each asked as a voxel is."""

import numpy as np
from numba import njit

from elbowroom.reconstruct.kernels.aged import still_through
from elbowroom.reconstruct.kernels.cone import VOXEL
from elbowroom.reconstruct.kernels.pixel import settle_word


@njit(cache=True, nogil=True)
def ask_parts(views, parts, asked, through):
    """What all cameras say of the parts of a voxel.

    Args:
        views: the cameras (`kernels.camera.Views`).
        parts: of the voxel (`kernels.place.Boxes`).
        asked: those that are asked, a word.
        through: (cameras,) uint64, takes the parts that each sees through.

    Returns:
        The parts that any of them disputes, a word.
    """
    disputed, voxel = np.uint64(0), np.empty(1, VOXEL)
    for c in range(views.cameras.size):
        camera = views.cameras[c]
        seen, disputes, _, _ = settle_word(camera, views.texels, asked, parts, voxel[0])
        if camera.aged_m > 0.0:
            seen = still_through(camera, views.texels, seen, parts, voxel[0])
        through[c] = seen
        disputed |= disputes
    return disputed
