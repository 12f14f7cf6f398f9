"""Random paths of machines in the volume of exact truth: a UR5 on a table, and the C-arm in the simulated room."""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline

from elbowroom.errors import InputError
from elbowroom.evaluate.cell.cell import cell_of
from elbowroom.evaluate.cell.scenes import cell_scenes
from elbowroom.evaluate.rooms.exact import ExactTravel
from elbowroom.evaluate.rooms.scene import room_grid
from elbowroom.geometry import VoxelGrid
from elbowroom.machine import Machine
from elbowroom.motion import Braking, Trajectory
from elbowroom.motion.contacts import watched_rows
from elbowroom.reconstruct import FreeSpace
from elbowroom.simulate import InterventionRoom, Moment, true_occupancy
from elbowroom.site import Site

Name = Literal["UR5", "C-arm"]
REACTION_S = 0.1
"""T_r of both machines [s]."""
CLEAR_VOXELS = 0.25
"""So many voxels must be between machine and solids at the start: what is nearer is not told from the machine."""
CLEAR_M = 0.005
"""Links that are nearer to each other there are not compared [m]."""
SPREAD_RAD, SPREAD_M = 0.9, 0.25
"""A point of a path is so far from the one before it in each joint, at most."""
STEP_S = (0.02, 0.1)
"""Between points of paths that have no velocities, and of those that have."""
SHARES = (0.3, 1.0)
"""The joint that is fastest moves at between these shares of full speed at its fastest."""
TRIES = 300


@dataclass(frozen=True, slots=True, eq=False)
class PathScene:
    """A path in a room that is known exactly.

    Args:
        machine: whose path it is.
        joints: where it begins, by name [m or rad].
        path: what it means to do.
        braking: how its joints come to rest.
        space: the true volume without the machine.
        truth: distances of the machine from the room's solids.
        own: links that must not touch, and do not where it begins.
    """

    machine: Machine
    joints: dict[str, float]
    path: Trajectory
    braking: Braking
    space: FreeSpace
    truth: ExactTravel
    own: list[tuple[str, str]]


def path_scenes(name: Name, voxel_size_m: float, seed: int) -> Iterator[PathScene]:
    """Paths without end, each from another pose in another moment.

    Args:
        name: of the machine.
        voxel_size_m: edge of a voxel [m].
        seed: of moments, poses and paths.

    Raises:
        PackageError: coal, or the package with the UR5, is not installed.
        InputError: no path was found, or no moment in which the machine is clear of what stands there.
    """
    site, machine, grid, moments = _ur5(voxel_size_m, seed) if name == "UR5" else _c_arm(voxel_size_m, seed)
    braking = replace(site.braking(machine), reaction_time_s=REACTION_S)
    names = machine.link_names
    own = [(names[a], names[b]) for a, b in watched_rows(machine)]
    passed_over = 0
    for number, moment in enumerate(moments):
        if passed_over == TRIES:
            raise InputError(
                f"paths: no moment in {TRIES} in which {name} is clear of all by {voxel_size_m / 4:g} m"
            )
        truth = ExactTravel(machine, moment.solids)
        enough_m = CLEAR_VOXELS * voxel_size_m
        if truth.nearest(moment.joints, (), enough_m).distance_m < enough_m:
            passed_over += 1
            continue
        apart = [pair for pair in own if truth.apart(moment.joints, *pair, CLEAR_M).distance_m >= CLEAR_M]
        volume = FreeSpace.from_occupied(grid, true_occupancy(grid, moment).occupied)
        joints = dict(moment.joints)
        path = random_path(machine, joints, braking, np.random.default_rng([seed, number]))
        yield PathScene(machine, joints, path, braking, volume.without(machine, joints), truth, apart)


def _ur5(voxel_size_m: float, seed: int) -> tuple[Site, Machine, VoxelGrid, Iterator[Moment]]:
    cell = cell_of(None, voxel_size_m)
    # what it stands on is said to be near only where cameras see it
    machine = replace(cell.machine, contacts=())
    return cell.site, machine, cell.grid, (drawn.moment for drawn in cell_scenes(cell, seed, ("random",)))


def _c_arm(voxel_size_m: float, seed: int) -> tuple[Site, Machine, VoxelGrid, Iterator[Moment]]:
    room, rng = InterventionRoom(), np.random.default_rng(seed)

    def moments() -> Iterator[Moment]:
        while True:
            yield room.random_moment(rng)

    return Site.simulated_room(), room.machine, room_grid(voxel_size_m), moments()


def random_path(
    machine: Machine, joints: dict[str, float], braking: Braking, rng: np.random.Generator
) -> Trajectory:
    """A smooth path through two random points, from rest to rest; every other one, by chance, with velocities.

    Args:
        machine: whose joints move, all of them.
        joints: where they are [m or rad].
        braking: says how fast they may be.
        rng: of all that is drawn.

    Raises:
        InputError: none was found within the joints' limits.
    """
    names = [name for name in machine.joint_names if name in braking.speeds]
    full = np.array([braking.speeds[name] for name in names])
    share, with_velocities = rng.uniform(*SHARES), bool(rng.integers(2))
    for _ in range(TRIES):
        points = [np.array([joints[name] for name in names])]
        for _ in range(2):
            points.append(points[-1] + rng.uniform(-1, 1, len(names)) * _spreads(machine, names))
        unscaled = CubicSpline([0.0, 1.0, 2.0], points, bc_type="clamped")
        fastest = (np.abs(unscaled(np.linspace(0, 2, 400), 1)) / full).max()
        lasts = float(2 * fastest / share)
        times = np.linspace(0.0, lasts, int(np.ceil(lasts / STEP_S[with_velocities])) + 1)
        rows = unscaled(2 * times / lasts)
        if not _inside(machine, names, unscaled(np.linspace(0, 2, 400))):
            continue
        speeds = unscaled(2 * times / lasts, 1) * 2 / lasts if with_velocities else None
        return Trajectory(names, times, rows, speeds)
    raise InputError(f"paths: none of {machine.name} within its limits in {TRIES} tries")


def _spreads(machine: Machine, names: list[str]) -> NDArray[np.float64]:
    return np.array([SPREAD_M if machine.joint(name).unit == "m" else SPREAD_RAD for name in names])


def _inside(machine: Machine, names: list[str], rows: NDArray[np.float64]) -> bool:
    """Whether joints stay a little within their limits: a curve through points may go a little farther."""
    joints = [machine.joint(name) for name in names]
    low, high = np.array([j.lower for j in joints]) + 1e-3, np.array([j.upper for j in joints]) - 1e-3
    return bool(((rows >= low) & (rows <= high)).all())
