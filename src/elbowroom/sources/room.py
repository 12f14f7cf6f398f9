"""A site opened for a run: its values, with what the run says otherwise, and the source of its snapshots."""

import itertools
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

from elbowroom.choices import Detail, Rule
from elbowroom.errors import InputError
from elbowroom.geometry import DepthCamera, VoxelGrid
from elbowroom.machine import Machine
from elbowroom.motion import Motion
from elbowroom.reconstruct import FreeSpace, Terms, free_space_of
from elbowroom.sensing import Snapshot
from elbowroom.site import Site
from elbowroom.site.recording_entry import BagRecording
from elbowroom.sources.cameras import cameras_of
from elbowroom.sources.played import Played
from elbowroom.sources.recorded import Recorded, times_of
from elbowroom.sources.source import Source
from elbowroom.sources.times.meeting import gap_ns


@dataclass(frozen=True, slots=True, eq=False)
class Room:
    """All that a run needs of a site.

    Args:
        site: the file.
        grid, cameras, machine, terms: of the site, or as the run says otherwise.
        source: of its snapshots; without end where the room is simulated.
    """

    site: Site
    grid: VoxelGrid
    cameras: tuple[DepthCamera, ...]
    machine: Machine | None
    terms: Terms
    source: Source

    def machine_and_motions(self) -> tuple[Machine, tuple[Motion, ...]]:
        """The machine, and each joint that has a speed in both directions.

        Raises:
            InputError: no machine, or no joint with a speed.
        """
        if self.machine is None:
            raise InputError(
                f"{self.site.path}: machine: missing; without a machine there is no motion to check"
            )
        motions = self.site.motions(self.machine)
        if not motions:
            known = ", ".join(self.machine.joint_names)
            raise InputError(
                f"{self.site.path}: joints: no speeds; give one for each of {known} to check its motions"
            )
        return self.machine, motions

    def placed(self, snapshot: Snapshot) -> Snapshot:
        """A moment, if it says where the machine is.

        Raises:
            InputError: the recording is from before the machine stood there, and nobody says where it is to be.
        """
        if snapshot.joints is None and self.terms.without_machine:
            raise InputError(
                f"joints: {self.site.path} was recorded without its machine, and has no joints: say where they are to "
                "be, as --joints NAME=VALUE,..."
            )
        return snapshot

    @property
    def allowances(self) -> tuple[str, ...]:
        """What the site lets pass by somebody's word, a line each: every summary says it."""
        return (*(self.machine.allowances if self.machine else ()), *self.terms.allowances)

    @property
    def unasked(self) -> str | None:
        """Why no motion can be asked here: no machine, or no joint with a speed; None: motions can."""
        if self.machine is None:
            return "no machine: no motion is judged, this is free space alone"
        if not self.site.motions(self.machine):
            known = ", ".join(self.machine.joint_names)
            return (
                f"no joint of {self.machine.name} has a speed (joints: {known}): no motion is judged, "
                "this is free space alone"
            )
        return None

    def snapshot(self, number: int) -> Snapshot:
        """A moment of the room by its number, from 0.

        Raises:
            InputError: the recording has fewer moments.
        """
        last = -1
        for last, snapshot in enumerate(itertools.islice(self.source, number + 1)):
            if last == number:
                return snapshot
        raise InputError(f"moment: {number} is not there; {self.site.path} has {last + 1} moments, from 0")

    def space_of(self, snapshot: Snapshot) -> FreeSpace:
        """The free space of a moment, all of it; raises as `reconstruct`."""
        return free_space_of(self.grid, self.cameras, snapshot, self.machine, self.terms)


def open_room(
    site: Site,
    *,
    voxel_size_m: float | None = None,
    rule: Rule | None = None,
    detail: Detail | None = None,
    joints: Mapping[str, float] | None = None,
    cameras: int | None = None,
    resolution: tuple[int, int] | None = None,
    knocks: Sequence[str] = (),
) -> Room:
    """Opens a site; what is None is as the site says.

    Args:
        site: the file.
        voxel_size_m: edge of a voxel [m].
        rule, detail: as of `reconstruct`.
        joints: positions that hold throughout [m or rad].
        cameras: number of cameras of a simulated room.
        resolution: width and height of their images [px].
        knocks: what is knocked in a simulated room, as `Knock.parse` reads it.

    Raises:
        InputError: cameras, resolution or knocks where the room is not simulated, joints that no machine has, a knock
            of nothing that is there.
    """
    grid, machine = site.grid(voxel_size_m), site.machine()
    if joints is not None:
        if machine is None:
            raise InputError(f"joints: {site.path} names no machine; leave them out")
        machine.require_joints(joints)
        machine.checked(joints)
    made = cameras_of(site, cameras, resolution)
    source = _source(site, made, joints, knocks)
    return Room(site, grid, made, machine, site.terms(rule, detail), source)


def live(room: Room) -> Room:
    """The same room as it is watched: a bag is played at its own pace, and the newest frame of each camera counts.

    What it was opened with stays; of other rooms there is no other source.
    """
    source = room.source
    if not isinstance(source, Recorded) or not isinstance(room.site.entry.recording, BagRecording):
        return room
    times = times_of(room.site)
    gap = gap_ns(None) if times is None else times.gap_ns
    return replace(room, source=Played(room.site, source.joints, gap))


def _source(
    site: Site,
    cameras: tuple[DepthCamera, ...],
    joints: Mapping[str, float] | None,
    knocks: Sequence[str],
) -> Source:
    """The recording, or the simulated room; the simulator is imported for it alone."""
    if site.simulated is None:
        if knocks:
            raise InputError(f"knocks: for simulated rooms, and {site.path} is none; leave them out")
        return Recorded(site, joints)
    from elbowroom.simulate.knock import Knock, require_known
    from elbowroom.sources.simulated import Simulated

    machine, given = site.machine(), tuple(Knock.parse(text) for text in knocks)
    require_known(given, cameras, machine.joint_names if machine else ())
    return Simulated(cameras, machine, joints, site.simulated.seed, given)
