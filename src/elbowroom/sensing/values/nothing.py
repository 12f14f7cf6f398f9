"""Whether anything ends in the grid at all: what reads free from end to end was most likely measured wrongly."""

from collections.abc import Sequence

import numpy as np

from elbowroom.finding import Finding
from elbowroom.geometry import VoxelGrid
from elbowroom.sensing.values.thinned import Thinned, way_through
from elbowroom.sensing.values.unit import LEAST_RAYS, LEAST_WAY, advice_on, ends_of, standing_of, together

KIND = "no surface"
ENDS_IN_IT = 0.001
"""More than this share of the rays that end in the grid, or within a voxel of it, are a surface that is seen."""
RETURN = 0.95
"""Less than this share with a return leaves much unseen: then it does not read free."""
ROOMS_REACH = 1.3
"""So many times as far as the grid's end (median) rooms end, that are about as large as their grids."""


def nothing_ends_in(grid: VoxelGrid, images: Sequence[Thinned]) -> Finding | None:
    """That all of the grid reads free and nothing ends in it, although rooms end sooner; None: something does.

    It stops. Whoever knows by other means that depths are right, such as cameras that agree on what lies behind the
    grid, has no use for it.

    Args:
        grid: the watched box.
        images: one of each camera.
    """
    crossing = sum(_crossing(image, grid) for image in images)
    ends = [(image, ends_of(image, grid)) for image in images]
    seen = [(image, of) for image, of in ends if of.depths_m.size]
    if not seen:
        return None
    every = together([of for _, of in seen])
    stands = standing_of(every, grid.voxel_size_m)
    if every.depths_m.size < max(RETURN * crossing, LEAST_RAYS):
        return None
    if stands.within > ENDS_IN_IT or stands.reach <= ROOMS_REACH:
        return None
    text = (
        f"all of the grid would read free, and nothing in it is a surface: what looks through it ends "
        f"{stands.reach:.2g} times as far as the grid's end (median), and no two cameras agree on what is there. Most "
        f"likely the unit of depth ({advice_on(stands, seen[0][0], every, grid.voxel_size_m)}), a number that stands "
        "for no return, or poses. If there is truly nothing in the box, let it reach to a floor or wall that is seen"
    )
    return Finding(KIND, tuple(image.camera.name for image, _ in seen), text, True)


def _crossing(image: Thinned, grid: VoxelGrid) -> int:
    """How many of the rays that are looked at cross the grid."""
    enters, leaves = way_through(grid, image.camera.centre_in_world, image.rays_in_world)
    way = LEAST_WAY * float(np.linalg.norm(grid.upper_m - grid.lower_m))
    return int(np.count_nonzero(leaves - enters > way))
