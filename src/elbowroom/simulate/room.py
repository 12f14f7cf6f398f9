"""The intervention room: C-arm, table with patient, doctor and two nurses, cabinets, monitors, lamp."""

from collections.abc import Mapping, Sequence
from functools import cache

import numpy as np

from elbowroom.errors import InputError
from elbowroom.geometry import VoxelGrid
from elbowroom.machine import Machine
from elbowroom.machine.c_arm import ceiling_c_arm
from elbowroom.simulate.furniture import furniture as room_furniture
from elbowroom.simulate.furniture import shell
from elbowroom.simulate.machine_solids import course, link_solids, random_joints
from elbowroom.simulate.person import Person, Stance, Walk
from elbowroom.simulate.solid import Moment, Solid
from elbowroom.simulate.truth import true_occupancy

STAFF = (
    Person("doctor", Walk((1.15, 0.98), (0.34, 0.20), 12.0, start_rad=-1.8), 1.80, elbow_rad=1.2),
    Person("nurse 1", Walk((1.05, -0.92), (0.45, 0.10), 14.0, start_rad=2.6, direction=-1), 1.68),
    Person("nurse 2", Walk((-0.75, 1.45), (0.40, 0.20), 10.0, start_rad=0.6, direction=-1), 1.72),
)
"""Who works in the room, and where they walk."""

REACH: dict[str, float] = {"long": 0.1875, "larm": 0.2618, "propeller": 0.5454, "carc": 0.5454}
"""Five braking distances of the ceiling C-arm at full speed and 0.5 s of braking time [m or rad]."""

TRIES = 2000
COLLISION_VOXEL_M = 0.04


class InterventionRoom:
    """A room of 4 x 4 m, floor at z = 0, ceiling at 2.9 m, middle at x = y = 0. It remembers nothing.

    The walls' inner faces are at 2.05 m, just outside a grid over [-2, 2] x [-2, 2] x [0, 2.5] m.

    Args:
        people: False: without doctor, nurses and patient.
        furniture: False: without table, patient, cabinets, monitors and lamp; both False: the machine alone.
        machine: any machine; None: the ceiling C-arm.
        staff: who walks; as many as one likes.
    """

    def __init__(
        self,
        *,
        people: bool = True,
        furniture: bool = True,
        machine: Machine | None = None,
        staff: Sequence[Person] = STAFF,
    ) -> None:
        self.machine = machine if machine is not None else _default_machine()
        self.staff = tuple(staff) if people else ()
        fixtures = tuple(s for s in room_furniture() if people or s.name != "patient") if furniture else ()
        self._static: tuple[Solid, ...] = shell() + fixtures

    @property
    def solids(self) -> tuple[Solid, ...]:
        """What never moves: walls, floor, ceiling, furniture."""
        return self._static

    def at(
        self,
        time_s: float,
        *,
        joints: Mapping[str, float] | None = None,
        people: Sequence[Stance] | None = None,
    ) -> Moment:
        """All that is in the room at a time.

        Args:
            time_s: time since the room's start [s].
            joints: the machine's joint positions by name [m or rad]; None: where its course has brought it.
            people: where the staff stand, in the order of `staff`; None: where their walks have brought them.

        Raises:
            InputError: another number of people than the room's staff.
            MachineError: unknown or missing joints, or positions beyond their limits.
        """
        stances = [person.walk.at(time_s) for person in self.staff] if people is None else list(people)
        if len(stances) != len(self.staff):
            raise InputError(f"room: {len(stances)} people placed, this room has {len(self.staff)}")
        positions = (
            course(self.machine, time_s) if joints is None else {k: float(v) for k, v in joints.items()}
        )
        bodies = tuple(
            s for person, stance in zip(self.staff, stances, strict=True) for s in person.solids(stance)
        )
        return Moment(time_s, self._static + bodies + link_solids(self.machine, positions), positions)

    def random_moment(
        self, rng: np.random.Generator, *, grid: VoxelGrid | None = None, reach: Mapping[str, float] = REACH
    ) -> Moment:
        """A time and a pose of the machine drawn at random, such that the machine touches nothing.

        Each joint can move by its reach in both directions, as far as its limits let it, without a checked
        link leaving the grid. The machine's own voxels of 4 cm share none with another solid's.

        Args:
            rng: source of randomness.
            grid: the watched box; None: 4 x 4 x 2.5 m about the room's middle.
            reach: by joint [m or rad]; a joint that is not named stays where it is.

        Raises:
            InputError: no such pose was found in 2000 tries.
        """
        box = grid or VoxelGrid((-2.0, -2.0, 0.0), (100, 100, 63), COLLISION_VOXEL_M)
        coarse = VoxelGrid.covering(box.lower_m, box.upper_m, COLLISION_VOXEL_M)
        for _ in range(TRIES):
            time_s = float(rng.uniform(0.0, 600.0))
            joints = random_joints(self.machine, rng)
            if not self._stays_inside(joints, reach, box):
                continue
            moment = self.at(time_s, joints=joints)
            truth = true_occupancy(coarse, moment)
            if not (truth.occupied & truth.machine).any():
                return moment
        raise InputError(f"room: no pose of {self.machine.name} without collision in {TRIES} tries")

    def _stays_inside(self, joints: Mapping[str, float], reach: Mapping[str, float], grid: VoxelGrid) -> bool:
        """Whether the checked links stay in the grid while one joint after the other moves by its reach."""
        poses = [dict(joints)]
        for name in set(reach) & set(joints):
            joint = self.machine.joint(name)
            for share in (-1.0, -0.5, 0.5, 1.0):
                value = min(max(joints[name] + share * reach[name], joint.lower), joint.upper)
                poses.append({**joints, name: value})
        stacked = {name: np.array([pose[name] for pose in poses]) for name in joints}
        world_from_links = self.machine.world_from_links(stacked)
        for link in self.machine.links:
            if link.name not in self.machine.checked_links:
                continue
            placed = world_from_links[link.name]
            points = link.vertices @ placed[:, :3, :3].transpose(0, 2, 1) + placed[:, None, :3, 3]
            if (points.min(axis=(0, 1)) < grid.lower_m).any() or (
                points.max(axis=(0, 1)) > grid.upper_m
            ).any():
                return False
        return True


@cache
def _default_machine() -> Machine:
    return ceiling_c_arm()
