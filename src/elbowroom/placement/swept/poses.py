"""Where a site's machine may stand: at zero or as recorded, and in poses drawn at random that touch nothing."""

from collections.abc import Mapping

import numpy as np

from elbowroom.errors import InputError
from elbowroom.geometry import VoxelGrid
from elbowroom.machine import Machine
from elbowroom.placement.fixed_room import FixedRoom
from elbowroom.simulate import InterventionRoom
from elbowroom.simulate.postures import Postures
from elbowroom.simulate.taken import Taken, fine_grid
from elbowroom.site import Site

Joints = Mapping[str, float]


def poses_of(
    site: Site, machine: Machine, room: FixedRoom | None, first: Joints, count: int, seed: int = 1
) -> tuple[list[Joints], str | None]:
    """Poses of a site's machine, and what is to be said where no others than the first were found.

    Args:
        site: the file.
        machine: of the site.
        room: what never moves; None: not known, then it touches nothing but itself.
        first: the first of them, as of the recording.
        count: how many, with the first.
        seed: of the others.
    """
    rng, poses = np.random.default_rng(seed), [first]
    try:
        draw = _draw(site, machine, room, rng)
        while len(poses) < count:
            poses.append(draw())
    except InputError as error:
        return poses, f"swept space is told of {len(poses)} pose alone: {error}"
    return poses, None


def _draw(site: Site, machine: Machine, room: FixedRoom | None, rng: np.random.Generator):  # type: ignore[no-untyped-def]
    """What draws one more pose."""
    grid: VoxelGrid = site.grid()
    if site.simulated is not None:
        simulated = InterventionRoom(people=False, machine=machine)
        return lambda: simulated.random_moment(rng, grid=grid).joints
    fine = fine_grid(grid.lower_m, grid.upper_m)
    solids, surfaces = ((), ()) if room is None else (room.solids, room.surfaces)
    postures = Postures(machine, Taken.of(fine, solids, surfaces), grid)
    return lambda: postures.drawn(rng)
