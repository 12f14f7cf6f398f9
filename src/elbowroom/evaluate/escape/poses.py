"""Machines driven close to what stands about them: scenes, and poses with a small gap."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from elbowroom.evaluate.examples import example
from elbowroom.evaluate.rooms.exact import ExactTravel
from elbowroom.evaluate.rooms.scene import room_grid, room_motions
from elbowroom.evaluate.thesis.thesis import c_arm
from elbowroom.geometry import VoxelGrid
from elbowroom.machine import Machine
from elbowroom.motion import Motion
from elbowroom.simulate import Moment, Solid, setup, true_occupancy
from elbowroom.simulate.machine_solids import random_joints
from elbowroom.simulate.shapes import box, ellipsoid, join
from elbowroom.site import Site

GAPS_M = (0.0003, 0.02)
"""From the machine to what is nearest, at least and at most."""
NEAR = 0.02
"""A gap is what was asked for to within this share of it."""
FAR_M = 1.0
"""How far a joint is driven towards what it would meet [m or rad]."""
SETUPS = 6
TABLE_M = (-0.6, -0.4, 0.67), (0.6, 0.4, 0.72)
"""Two corners of its top, which ends below the arm's foot."""
THINGS = 12
"""About the arm on a table, balls and the like of 4 to 12 cm."""


@dataclass(frozen=True, slots=True, eq=False)
class Scene:
    """A machine, what stands about it, and the voxels that this touches.

    Args:
        name: of the machine and where it is.
        machine: the machine.
        motions: all that are asked.
        solids: what stands there.
        truth: exact distances.
        grid: the watched box.
        occupied: what of it solids touch, shape of the grid.
    """

    name: str
    machine: Machine
    motions: tuple[Motion, ...]
    solids: tuple[Solid, ...]
    truth: ExactTravel
    grid: VoxelGrid
    occupied: NDArray[np.bool_]

    @classmethod
    def of(
        cls,
        name: str,
        machine: Machine,
        motions: tuple[Motion, ...],
        solids: tuple[Solid, ...],
        grid: VoxelGrid,
    ) -> "Scene":
        """With what is worked out of it.

        Args:
            name, machine, motions, solids, grid: as of the scene.
        """
        occupied = true_occupancy(grid, Moment(0.0, solids, {})).occupied
        return cls(name, machine, motions, solids, ExactTravel(machine, solids), grid, occupied)


def scenes(voxel_size_m: float, seed: int) -> Iterator[Scene]:
    """The C-arm in the six setups, and the arm on a table among things in as many places.

    Args:
        voxel_size_m: edge of a voxel [m].
        seed: of the places.
    """
    machine = c_arm()
    for number in range(1, SETUPS + 1):
        yield Scene.of(
            f"C-arm, setup {number}",
            machine,
            room_motions(machine),
            setup(number).solids(),
            room_grid(voxel_size_m),
        )
    site = Site.load(example("arm_on_a_table/cell"))
    arm = site.machine()
    grid = site.grid(voxel_size_m)
    table = Solid("table", join([box(*TABLE_M)]), np.eye(4))
    assert arm is not None
    for number in range(1, SETUPS + 1):
        rng = np.random.default_rng([seed, number])
        things = (table, *(_thing(n, rng) for n in range(THINGS)))
        yield Scene.of(f"arm on a table, {number}", arm, tuple(site.motions(arm)), things, grid)


def _thing(number: int, rng: np.random.Generator) -> Solid:
    """Something round within the arm's reach."""
    angle, away = rng.uniform(0, 2 * np.pi), rng.uniform(0.25, 0.8)
    middle = np.array([away * np.cos(angle), away * np.sin(angle), rng.uniform(0.85, 1.6)])
    return Solid(f"thing {number}", join([ellipsoid(middle, tuple(rng.uniform(0.04, 0.12, 3)))]), np.eye(4))


def pose_beside(scene: Scene, rng: np.random.Generator) -> tuple[dict[str, float], float]:
    """A random pose from which one joint was driven on until a small gap was left; and that gap [m].

    Args:
        scene: where.
        rng: of the pose.
    """
    while True:
        joints = random_joints(scene.machine, rng)
        gap = float(np.exp(rng.uniform(*np.log(GAPS_M))))
        if scene.truth.gap(joints, GAPS_M[1]) < GAPS_M[1]:
            continue
        motion = scene.motions[rng.integers(len(scene.motions))]
        far = Motion(motion.joint, motion.direction, motion.braking_distance, FAR_M)
        contact = scene.truth.until_contact(joints, far)
        found = _driven(scene, joints, far, contact.travel, gap) if contact.touches else None
        if found is not None:
            return found


def _driven(
    scene: Scene, joints: Mapping[str, float], motion: Motion, until: float, gap: float
) -> tuple[dict[str, float], float] | None:
    """The pose with a gap on the way to a contact, by halving; None: it cannot be told so near."""
    low, high = 0.0, until
    for _ in range(40):
        middle = (low + high) / 2
        there = {**joints, motion.joint: joints[motion.joint] + motion.direction * middle}
        here = scene.truth.gap(there, 2 * GAPS_M[1])
        if abs(here - gap) <= NEAR * gap:
            return there, here
        low, high = (middle, high) if here > gap else (low, middle)
    return None
