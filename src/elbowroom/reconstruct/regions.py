"""Which pixels of each image a carve has to look at: only they are prepared for it."""

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from elbowroom.geometry import bits
from elbowroom.geometry.bits import Words
from elbowroom.reconstruct.kernels.flying import SPREAD
from elbowroom.reconstruct.kernels.regions import rectangles_of
from elbowroom.reconstruct.layout import Layout
from elbowroom.reconstruct.parts import LATERAL_PX

Rectangle = tuple[int, int, int, int]
"""First row, one past the last, first column, one past the last."""
NEIGHBOURS = 2
"""The pixel test asks pixels so far about those that may see a voxel, whether one of these is alone."""
ROUNDING_PX = 1
SPREAD_PX = SPREAD + NEIGHBOURS + ROUNDING_PX


def regions(
    layout: Layout, asked: Words, cubes: NDArray[np.int64], aged_m: Mapping[str, float]
) -> Sequence[Rectangle]:
    """By camera, the pixels that the pixel test may ask of some voxels or of their parts, and all about them.

    Args:
        layout: cameras in a grid.
        asked: plane of the voxels; of a block with any, all are taken to be asked.
        cubes: numbers of the cubes that hold any.
        aged_m: by camera, how far anything may have moved since its image [m]; one that is missing: not at all.
    """
    records = layout.records.copy()
    # a voxel's parts are asked with pixels that are at least so wide
    records["lateral_px"] = np.maximum(records["lateral_px"], LATERAL_PX)
    records["aged_m"] = [aged_m.get(camera.name, 0.0) for camera in layout.cameras]
    rectangles = np.zeros((len(records), 4), dtype=np.int64)
    rectangles_of(cubes, asked, bits.lattice(layout.grid), records, float(SPREAD_PX), rectangles)
    return [(top, bottom, left, right) for top, bottom, left, right in rectangles.tolist()]
