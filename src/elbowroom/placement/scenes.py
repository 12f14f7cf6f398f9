"""Random moments of a room in use: people, a table, the machine in some pose."""

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from elbowroom.errors import InputError
from elbowroom.geometry import VoxelGrid
from elbowroom.placement.fixed_room import FixedRoom
from elbowroom.simulate import InterventionRoom, Moment, Solid
from elbowroom.simulate.machine_solids import link_solids
from elbowroom.simulate.person import Person, Stance, Walk
from elbowroom.simulate.postures import Postures
from elbowroom.simulate.shapes import box, join
from elbowroom.simulate.taken import Taken, fine_grid
from elbowroom.simulate.truth import touched_by
from elbowroom.site import Site

TRIES = 200
COARSE_M = 0.08
"""Things must not share voxels of this edge [m]."""
TABLE_M = (1.9, 0.6, 0.95)
HEIGHTS_M = (1.60, 1.95)
NOWHERE = Walk((0.0, 0.0), (0.1, 0.1), 1.0)


def random_scenes(
    site: Site,
    grid: VoxelGrid,
    room: FixedRoom | None,
    count: int,
    *,
    people: int = 3,
    table: bool = True,
    seed: int = 1,
) -> Iterator[Moment]:
    """Moments drawn at random, the n-th the same whatever the count.

    The simulated room has its own people, table and C-arm. Any other room gets people who stand and walk anywhere on
    its floor, a table, and the site's machine, if it has one, in a pose that touches nothing.

    Args:
        site: the file.
        grid: the watched box; its least z is the floor.
        room: walls and furniture of a room that is not simulated; None: nothing fixed.
        count: how many moments.
        people: of a room that is not simulated.
        table: whether such a room gets one.
        seed: of all of it.

    Raises:
        InputError: fewer than one moment or than no people, or no place for them.
    """
    if count < 1 or people < 0:
        raise InputError(
            f"placement: {count} scenes of {people} people, at least 1 scene and 0 people are needed"
        )
    machine, postures = site.machine(), None
    if site.simulated is None:
        postures = _postures(site, grid, room)
    for number in range(count):
        rng = np.random.default_rng([seed, number])
        if site.simulated is not None:
            yield InterventionRoom(machine=machine).random_moment(rng, grid=grid)
        else:
            yield _scene(number, grid, room, postures, people, table, rng)


def _scene(
    number: int,
    grid: VoxelGrid,
    room: FixedRoom | None,
    machine: Postures | None,
    people: int,
    table: bool,
    rng: np.random.Generator,
) -> Moment:
    coarse = VoxelGrid.covering(grid.lower_m, grid.upper_m, COARSE_M)
    fixed = () if room is None else room.moment.solids
    taken = np.zeros(coarse.shape, dtype=bool) if room is None else room.occupied(coarse).copy()
    joints: dict[str, float] = {}
    solids: list[Solid] = []
    if machine is not None:
        joints = machine.drawn(rng)
        links = link_solids(machine.machine, joints)
        _take(coarse, taken, links)
        solids += links
    if table:
        solids += _placed(coarse, taken, lambda: (_table(grid, rng),), "table: no place for the table")
    for n in range(people):
        height = float(rng.uniform(*HEIGHTS_M))
        person = Person(f"person {n + 1}", NOWHERE, round(height, 2), float(rng.choice([0.3, 1.2])))
        who = f"people: no place for {person.name}"
        solids += _placed(coarse, taken, lambda one=person: one.solids(_stance(grid, rng)), who)
    return Moment(float(number), (*fixed, *solids), joints)


def _postures(site: Site, grid: VoxelGrid, room: FixedRoom | None) -> Postures | None:
    """What the site's machine can do in its fixed room; None: there is no machine."""
    machine = site.machine()
    if machine is None:
        return None
    fine = fine_grid(grid.lower_m, grid.upper_m)
    fixed = Taken.of(fine, ()) if room is None else Taken.of(fine, room.solids, room.surfaces)
    return Postures(machine, fixed)


def _placed(coarse: VoxelGrid, taken: NDArray[np.bool_], make, trouble: str) -> tuple[Solid, ...]:  # type: ignore[no-untyped-def]
    """Solids drawn until they fit; else the trouble is said."""
    for _ in range(TRIES):
        solids: tuple[Solid, ...] = make()
        if _fits(coarse, taken, solids):
            _take(coarse, taken, solids)
            return solids
    raise InputError(f"{trouble} in {TRIES} tries; fewer people, or no table")


def _fits(coarse: VoxelGrid, taken: NDArray[np.bool_], solids: tuple[Solid, ...]) -> bool:
    for solid in solids:
        corner, touched = touched_by(coarse, solid)
        span = tuple(slice(c, c + n) for c, n in zip(corner, touched.shape, strict=True))
        if (taken[span] & touched).any():
            return False
    return True


def _take(coarse: VoxelGrid, taken: NDArray[np.bool_], solids: tuple[Solid, ...]) -> None:
    for solid in solids:
        corner, touched = touched_by(coarse, solid)
        taken[tuple(slice(c, c + n) for c, n in zip(corner, touched.shape, strict=True))] |= touched


def _stance(grid: VoxelGrid, rng: np.random.Generator) -> Stance:
    x, y = rng.uniform(grid.lower_m[:2] + 0.25, grid.upper_m[:2] - 0.25)
    return Stance(float(x), float(y), float(rng.uniform(-np.pi, np.pi)), float(rng.uniform(0, 2 * np.pi)))


def _table(grid: VoxelGrid, rng: np.random.Generator) -> Solid:
    """A top on one leg, anywhere on the floor and turned anyhow."""
    length, width, high = TABLE_M
    parts = [
        box((-length / 2, -width / 2, high - 0.07), (length / 2, width / 2, high)),
        box((-0.15, -0.14, 0.0), (0.15, 0.14, high - 0.05)),
    ]
    turn = float(rng.uniform(-np.pi, np.pi))
    x, y = rng.uniform(grid.lower_m[:2] + 0.6, grid.upper_m[:2] - 0.6)
    pose = np.array(
        [
            [np.cos(turn), -np.sin(turn), 0, x],
            [np.sin(turn), np.cos(turn), 0, y],
            [0, 0, 1, grid.lower_m[2]],
            [0, 0, 0, 1.0],
        ]
    )
    return Solid("table", join(parts), pose)
