"""The closed loop in simulated time: people walk, cameras see, the pass judges, the machine does as it is told."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace

import numpy as np

from elbowroom.errors import InputError
from elbowroom.evaluate.lag.drive import Drive
from elbowroom.evaluate.lag.moves import Moves
from elbowroom.evaluate.lag.near import LinkBoxes
from elbowroom.evaluate.lag.people import People
from elbowroom.evaluate.rooms.exact import ExactTravel
from elbowroom.geometry import VoxelGrid
from elbowroom.machine import Machine
from elbowroom.monitor import Cycle
from elbowroom.motion import Level, Motion
from elbowroom.reconstruct import Terms
from elbowroom.sensing import NOISE_PRESETS, DepthFrame, Margin, Snapshot
from elbowroom.simulate import InterventionRoom, Moment, render, wall_cameras
from elbowroom.simulate.inside import hung_clear
from elbowroom.simulate.rounds import walking_staff
from elbowroom.site import Site

TICK_S = 1 / 30
"""The room is looked at so often [s]."""
PASS_TICKS, LATENCY_TICKS = 3, 2
"""A pass begins every so many ticks, and is decided so many later."""
START_S = 1.0
"""Of the room's time, so that no image is of a time before it [s]."""
GOLDEN = 0.6180339887
"""Its multiples, less the whole, keep neighbours apart."""


@dataclass(frozen=True, slots=True)
class Setting:
    """How the loop is run.

    Args:
        skew_ms: cameras are exposed up to so long before a pass begins, each at a time of its own [ms].
        ahead: whether claims are aged up to the end of the time for which a decision holds (`pass_time_ms`).
        voxel_size_m: edge of a voxel [m].
        size: of the images, width and height.
        cameras: along the walls at 2.4 and 0.4 m in turn.
        people_speed_m_s: as which people are taken.
    """

    skew_ms: float = 0.0
    ahead: bool = False
    voxel_size_m: float = 0.1
    size: tuple[int, int] = (160, 120)
    cameras: int = 12
    people_speed_m_s: float = 2.0

    @property
    def reaction_ticks(self) -> int:
        """From something happening to the decision that knows of it, at most: skew, a period, and what a pass takes."""
        return int(np.ceil(self.skew_ms / 1e3 / TICK_S - 1e-9)) + PASS_TICKS + LATENCY_TICKS

    @property
    def terms(self) -> Terms:
        """How strictly space is judged."""
        holds_s = (PASS_TICKS + LATENCY_TICKS) * TICK_S
        return Terms(
            margin=Margin(lateral_px=0.0),
            max_age_ns=300_000_000,
            people_speed_m_s=self.people_speed_m_s,
            pass_ns=round(holds_s * 1e9) if self.ahead else 0,
        )


@dataclass(frozen=True, slots=True, eq=False)
class Tick:
    """What is at one time.

    Args:
        time_s: since the room's start [s].
        active: the motion that the machine is about to make.
        share: of full speed that it goes [1].
        levels: what holds, by motion; motions without one are stopped, as nothing was decided yet.
        contacts: motions that would touch a person or a thing within the braking distance, with what they touch; things
            are only looked for of the active one.
        gap_m: between machine and people, as far as it matters [m].
    """

    time_s: float
    active: Motion
    share: float
    levels: Mapping[Motion, Level]
    contacts: Mapping[Motion, str]
    gap_m: float


def run_loop(setting: Setting, moves: Moves, seconds: float, seed: int) -> Iterator[Tick]:
    """Runs the loop; the machine begins standing still.

    Args:
        setting: how.
        moves: that the machine chooses from, of `find_moves`.
        seconds: of simulated time.
        seed: of moves and of the sensors' noise.

    Raises:
        PackageError: coal is not installed.
        InputError: a pass failed.
    """
    site, staff = Site.simulated_room(), walking_staff()
    room = InterventionRoom(staff=staff)
    machine, motions = room.machine, tuple(site.motions(room.machine))
    rng = np.random.default_rng(seed)
    speeds = site.override(machine).speeds
    asked = {(motion.joint, motion.direction): motion for motion in motions}
    drive = Drive(moves, asked, speeds, rng)
    people = People(staff, machine, rng)
    watching = _Watching.of(setting, room, motions)
    truth, held = _Truth(machine, room, motions), dict[Motion, Level]()
    decided: dict[int, dict[Motion, Level]] = {}
    past: list[Moment] = []
    for tick in range(round(seconds / TICK_S)):
        moment = room.at(START_S + tick * TICK_S, joints=drive.joints, people=people.stances)
        past = [*past, moment][-watching.memory :]
        if tick % PASS_TICKS == 0:
            decided[tick + LATENCY_TICKS] = watching.levels(past, seed + tick)
        held = decided.pop(tick, held)
        active = drive.motion
        contacts, gap_m = truth.contacts(moment, active, tick % PASS_TICKS == 0)
        yield Tick(tick * TICK_S, active, drive.share, dict(held), contacts, gap_m)
        drive.step(held.get(active, Level.STOP), TICK_S)
        people.step(drive.joints, TICK_S)


@dataclass(frozen=True, slots=True, eq=False)
class _Watching:
    """Cameras that are exposed one after the other, and the pass that judges."""

    cycle: Cycle
    lags: tuple[int, ...]

    @classmethod
    def of(cls, setting: Setting, room: InterventionRoom, motions: tuple[Motion, ...]) -> "_Watching":
        cameras = wall_cameras(
            setting.cameras,
            (2.4, 0.4),
            width=setting.size[0],
            height=setting.size[1],
            noise=NOISE_PRESETS["tof"],
        )
        clear = hung_clear(cameras, room.solids)
        grid = VoxelGrid.covering((-2.0, -2.0, 0.0), (2.0, 2.0, 2.5), setting.voxel_size_m)
        # how long a pass takes on this computer makes no difference: time is simulated
        cycle = Cycle(grid, clear, room.machine, motions, setting.terms, clock_ns=lambda: 0)
        return cls(cycle, _lags(len(clear), setting.skew_ms))

    @property
    def memory(self) -> int:
        """So many ticks of the room's past are asked for."""
        return max(self.lags) + 1

    def levels(self, past: list[Moment], seed: int) -> dict[Motion, Level]:
        """What a pass that begins now comes to.

        Args:
            past: the room at the latest ticks, the last of them now.
            seed: of the sensors' noise.
        """
        now, frames, joints_of = past[-1], dict[str, DepthFrame](), dict[str, Mapping[str, float]]()
        for lag in set(self.lags):
            then = past[max(-len(past), -1 - lag)]
            own = [camera for camera, its in zip(self.cycle.cameras, self.lags, strict=True) if its == lag]
            frames |= {frame.camera: frame for frame in render(own, then, seed=seed)}
            joints_of |= {camera.name: then.joints for camera in own}
        ordered = tuple(frames[camera.name] for camera in self.cycle.cameras)
        result = self.cycle.run(Snapshot(ordered, now.joints, joints_of, now_ns=now.stamp_ns))
        if result.fault is not None:
            raise InputError(f"lag: a pass failed: {result.fault}")
        return {v.motion: v.level for v in result.verdicts if isinstance(v.motion, Motion)}


def _lags(cameras: int, skew_ms: float) -> tuple[int, ...]:
    """By camera, how many ticks before a pass it is exposed: evenly spread, neighbours far apart."""
    most = round(skew_ms / 1e3 / TICK_S)
    order = sorted(range(cameras), key=lambda number: number * GOLDEN % 1)
    return tuple(round(order.index(number) / max(1, cameras - 1) * most) for number in range(cameras))


class _Truth:
    """What is really in the way, by exact geometry."""

    def __init__(self, machine: Machine, room: InterventionRoom, motions: tuple[Motion, ...]) -> None:
        self._machine = machine
        # a braking distance is as far as it is asked
        self._asked = {motion: replace(motion, reach=motion.braking_distance) for motion in motions}
        self._boxes = LinkBoxes.of(machine)
        self._things = ExactTravel(machine, room.solids)
        levers = {name: 1.0 if machine.joint(name).unit == "m" else 2.5 for name in machine.joint_names}
        self._near_m = max(levers[m.joint] * m.braking_distance for m in motions)
        self._last: tuple[Motion, tuple[float, ...], str | None] | None = None

    def contacts(self, moment: Moment, active: Motion, things: bool) -> tuple[dict[Motion, str], float]:
        """What motions would touch within the braking distance; and the gap between machine and people [m].

        Args:
            moment: what is there.
            active: the motion of which it is also asked what stands still in its way.
            things: whether that is asked anew; else it is as it was, if the motion is the same.
        """
        bodies = [s for s in moment.moving_solids if not s.is_machine and "hair" not in s.name]
        near = self._boxes.may_be_near(moment.joints, bodies, self._near_m)
        found, gap_m = dict[Motion, str](), self._near_m
        if near:
            people = ExactTravel(self._machine, near)
            gap_m = people.gap(moment.joints, self._near_m)
            for motion, asked in self._asked.items() if gap_m < self._near_m else ():
                contact = people.until_contact(moment.joints, asked)
                if contact.touches:
                    found[motion] = str(contact.solid)
        thing = self._thing(moment.joints, active, things)
        if thing is not None:
            found.setdefault(active, thing)
        return found, gap_m

    def _thing(self, joints: Mapping[str, float], motion: Motion, anew: bool) -> str | None:
        """What stands still in the way of a motion; asked once while the machine stands."""
        where = tuple(joints.values())
        last = self._last
        if last is None or last[0] is not motion or (anew and last[1] != where):
            contact = self._things.until_contact(joints, self._asked[motion])
            self._last = motion, where, contact.solid
        assert self._last is not None
        return self._last[2]
