"""A small recording, made anew: the simulated room with few cameras, and what goes wrong in a run."""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from elbowroom.evaluate.faults.scene import written_site
from elbowroom.evaluate.recording.sliding import Sliding
from elbowroom.monitor import Checks, Loop
from elbowroom.monitor.blackbox.configuration import plain_cycle
from elbowroom.monitor.blackbox.recorder import Recorder
from elbowroom.monitor.blackbox.sinks import WholeRun
from elbowroom.monitor.cycle import Cycle
from elbowroom.monitor.separation.separating import Separating
from elbowroom.sensing import Snapshot
from elbowroom.site import Site
from elbowroom.sources import Room, open_room
from elbowroom.sources.simulated import Simulated

RATE_HZ = 15.0
CAMERAS, SIZE, VOXEL_M = 5, (48, 36), 0.2
LOSES, AGES, FORGETS = 0.05, 0.05, 0.01
"""Shares of images that do not come, and that are old; and of passes in which nobody knows where the machine is."""
PORT, DEADLINE_MS = 5020, 60.0
"""Of the cell's gate, which is not begun."""
TELLS_SPEED = 0.9
"""Of joints, so many say how fast they are."""


@dataclass(frozen=True, slots=True, eq=False)
class Troubled:
    """The simulated room as a source of so many snapshots, of which some lack images, or joints.

    Args:
        simulated: the room, or the cell.
        passes: how many.
        seed: of what goes wrong.
    """

    simulated: Simulated | Sliding
    passes: int
    seed: int

    @property
    def name(self) -> str:
        """What its time is spent on."""
        return "simulator"

    def __iter__(self) -> Iterator[Snapshot]:
        """The snapshots."""
        chance, before = np.random.default_rng(self.seed), Snapshot(())
        for one in self.simulated.at(number / RATE_HZ for number in range(self.passes)):
            old = {frame.camera: frame for frame in before.frames}
            frames = [
                old.get(frame.camera, frame) if chance.random() < AGES else frame
                for frame in one.frames
                if chance.random() >= LOSES
            ]
            joints = one.joints if chance.random() >= FORGETS else {}
            # where nobody knows how fast it is, one of them has no speed
            speeds = {
                name: chance.uniform(-0.2, 0.2) for name in one.joints or {} if chance.random() < TELLS_SPEED
            }
            before = replace(one, frames=tuple(frames), joints=joints, velocities=speeds)
            yield before

    def close(self) -> None:
        """Nothing is held."""


def record_cell(path: Path, passes: int, seed: int = 1) -> Path:
    """Runs the monitor over the cell, and keeps all of it: a fifth of what a pass of the room takes.

    Args:
        path: of a file that is not there yet, in a folder in which the cell's files are written.
        passes: how many.
        seed: of noise, and of what goes wrong.
    """
    room = open_room(Site.load(written_site(path.parent, PORT, DEADLINE_MS)))
    return _recorded(path, room, Troubled(Sliding(room, seed), passes, seed))


def record_sample(path: Path, passes: int, seed: int = 1, exact: bool = False) -> Path:
    """Runs the monitor over the room, and keeps all of it.

    Args:
        path: of a file that is not there yet.
        passes: how many.
        seed: of noise, and of what goes wrong.
        exact: without noise of the sensors.
    """
    from elbowroom.sources.cameras import with_noise

    site = with_noise(Site.simulated_room(), "exact") if exact else Site.simulated_room()
    room = open_room(site, voxel_size_m=VOXEL_M, cameras=CAMERAS, resolution=SIZE)
    assert isinstance(room.source, Simulated)
    return _recorded(path, room, Troubled(replace(room.source, seed=seed), passes, seed))


def _recorded(path: Path, room: Room, source: Troubled) -> Path:
    recorder = Recorder([WholeRun(path)])
    loop = loop_of(replace(room, source=source))
    recorder.cycle = loop.cycle
    loop.run([recorder])
    assert not recorder.troubles, recorder.troubles
    return path


def loop_of(room: Room) -> Loop:
    """The loop of a room, without a watch, and without a clock: how fast a computer is changes no verdict."""
    separating = replace(Separating.of(room), clock_ns=lambda: 0)
    cycle = plain_cycle(room)
    assert isinstance(cycle, Cycle)
    cycle = replace(cycle, look_m=separating.figures.look_m, clock_ns=lambda: 0)
    return Loop(room, Checks(), cycle, separating=separating)
