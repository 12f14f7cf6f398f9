"""A site opened for a command: its values with what the command line says otherwise, and its moments."""

import itertools
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from elbowroom.choices import Detail, Rule
from elbowroom.errors import InputError
from elbowroom.geometry import DepthCamera, VoxelGrid
from elbowroom.machine import Machine
from elbowroom.motion import Motion
from elbowroom.sensing import DepthFrame, JointRecord, Margin
from elbowroom.site import Site
from elbowroom.sources import RecordedMoment, moments
from elbowroom.view.screen.watched import Watched

if TYPE_CHECKING:
    from elbowroom.simulate.knock import Knock

REAL_TIME_SLACK_S = 0.001


@dataclass(frozen=True, slots=True, eq=False)
class Scene:
    """What a room delivers at one moment.

    Args:
        frames: newest frame of each camera that has one.
        joints: positions of the machine now [m or rad]; None: there is no machine.
        joints_at_frames: the same at the frames' own times, where they are recorded; None: as `joints`.
        now_ns: the time now [ns, the clock of the frames].
        source_ms: what simulating or reading took [ms].
    """

    frames: tuple[DepthFrame, ...]
    joints: Mapping[str, float] | None
    joints_at_frames: JointRecord | None
    now_ns: int
    source_ms: float


@dataclass(frozen=True, slots=True, eq=False)
class Room:
    """All that a command needs of a site.

    Args:
        site: the file.
        grid, cameras, machine, rule, detail: of the site, or as the command line says otherwise.
        scenes: gives the moments from the beginning; without end where the room is simulated.
    """

    site: Site
    grid: VoxelGrid
    cameras: tuple[DepthCamera, ...]
    machine: Machine | None
    rule: Rule
    detail: Detail
    scenes: Callable[[], Iterator[Scene]]

    @property
    def margin(self) -> Margin:
        """The margin of cameras that have none of their own."""
        return self.site.margin()

    @property
    def watched(self) -> Watched:
        """What the head of the screen says."""
        sizes = sorted({f"{camera.width}x{camera.height}" for camera in self.cameras})
        cameras = f"{len(self.cameras)} camera{'s' * (len(self.cameras) > 1)} {', '.join(sizes)}"
        source = "simulator" if self.site.simulated else "reading"
        unchecked = self.machine.unchecked_links if self.machine else ()
        return Watched(self.site.name, self.grid, cameras, self.rule, self.detail, source, unchecked)

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


def open_room(
    site: Site,
    *,
    voxel_size_m: float | None = None,
    rule: Rule | None = None,
    detail: Detail | None = None,
    joints: Mapping[str, float] | None = None,
    cameras: int | None = None,
    resolution: tuple[int, int] | None = None,
    in_real_time: bool = False,
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
        in_real_time: recorded moments with times come no faster than they were recorded.
        knocks: what is knocked in a simulated room, as `Knock.parse` reads it.

    Raises:
        InputError: cameras, resolution or knocks where the room is not simulated, joints that no machine has, a knock
            of nothing that is there.
    """
    grid, machine = site.grid(voxel_size_m), site.machine()
    if joints is not None:
        if machine is None:
            raise InputError(f"--joints: {site.path} names no machine; leave it out")
        machine.checked(joints)
    if site.simulated is not None:
        from elbowroom.simulate import wall_cameras

        if not site.lists_cameras:
            settings = site.simulated_cameras()
            if cameras is not None:
                settings["count"] = cameras
            if resolution is not None:
                settings["width"], settings["height"] = resolution
            made = wall_cameras(**settings)
        elif cameras is not None or resolution is not None:
            raise InputError(
                f"{site.path}: lists its cameras; --cameras and --resolution do not go with that"
            )
        else:
            made = site.cameras()
        from elbowroom.simulate.knock import Knock, require_known

        seed = site.simulated.seed
        given = tuple(Knock.parse(text) for text in knocks)
        require_known(given, made, machine.joint_names if machine else ())
        scenes: Callable[[], Iterator[Scene]] = lambda: _simulated(made, machine, joints, seed, given)  # noqa: E731
    else:
        if cameras is not None or resolution is not None:
            raise InputError(
                f"{site.path}: --cameras and --resolution are for simulated rooms; leave them out"
            )
        if knocks:
            raise InputError(f"{site.path}: --knock is for simulated rooms; leave it out")
        made = site.cameras()
        scenes = lambda: _recorded(site, joints, in_real_time)  # noqa: E731
    return Room(site, grid, made, machine, rule or site.rule, detail or site.detail, scenes)


def _simulated(
    cameras: tuple[DepthCamera, ...],
    machine: Machine | None,
    joints: Mapping[str, float] | None,
    seed: int,
    knocks: "Sequence[Knock]" = (),
) -> Iterator[Scene]:
    """Moments of the simulated room as time goes on. Frames are new when they come, however long it took."""
    from elbowroom.simulate import InterventionRoom, render
    from elbowroom.simulate.knock import PlacedKnocks, reported_joints

    room = InterventionRoom(machine=machine)
    moved = PlacedKnocks(knocks, cameras)
    start = time.perf_counter()
    for number in itertools.count():
        begun = time.perf_counter()
        moment = room.at(begun - start, joints=joints)
        where = moved.cameras(moment.time_s)
        frames = tuple(render(where, moment, seed=seed + number))
        said = reported_joints(knocks, moment.joints, moment.time_s)
        yield Scene(frames, said, None, moment.stamp_ns, (time.perf_counter() - begun) * 1e3)


def _recorded(site: Site, joints: Mapping[str, float] | None, in_real_time: bool) -> Iterator[Scene]:
    recorded, first_ns, start = iter(moments(site, joints)), None, time.perf_counter()
    while True:
        begun = time.perf_counter()
        moment = next(recorded, None)
        if moment is None:
            return
        source_ms = (time.perf_counter() - begun) * 1e3
        if in_real_time and moment.stamp_ns is not None:
            first_ns = moment.stamp_ns if first_ns is None else first_ns
            early_s = (moment.stamp_ns - first_ns) / 1e9 - (time.perf_counter() - start)
            if early_s > REAL_TIME_SLACK_S:
                time.sleep(early_s)
        yield Scene(moment.frames, moment.joints, _record_of(moment), moment.stamp_ns or 0, source_ms)


def _record_of(moment: RecordedMoment) -> JointRecord | None:
    """The positions at the frames' times as a record; None where there are no times."""
    at = {
        frame.stamp_ns: moment.joints_of[frame.camera]
        for frame in moment.frames
        if frame.stamp_ns is not None and frame.camera in moment.joints_of
    }
    if not at:
        return None
    stamps = np.array(sorted(at), dtype=np.int64)
    rows = [at[int(stamp)] for stamp in stamps]
    return JointRecord(stamps, {name: np.array([row[name] for row in rows]) for name in rows[0]})
