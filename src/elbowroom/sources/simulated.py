"""The simulated intervention room as a source: people walk, the machine moves, as time goes on."""

import itertools
import time
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass

from elbowroom.geometry import DepthCamera
from elbowroom.machine import Machine
from elbowroom.sensing import Snapshot
from elbowroom.simulate import InterventionRoom, render
from elbowroom.simulate.knock import Knock, PlacedKnocks, reported_joints


@dataclass(frozen=True, slots=True, eq=False)
class Simulated:
    """The simulated room; frames are new when they come, however long it took to make them.

    Args:
        cameras: where they are said to be.
        machine: what moves there; None: the ceiling C-arm.
        joints: positions that hold throughout [m or rad]; None: it moves.
        seed: of the sensors' noise.
        knocks: what is knocked, and when.
    """

    cameras: Sequence[DepthCamera]
    machine: Machine | None = None
    joints: Mapping[str, float] | None = None
    seed: int = 0
    knocks: Sequence[Knock] = ()

    @property
    def name(self) -> str:
        """What its time is spent on."""
        return "simulator"

    def __iter__(self) -> Iterator[Snapshot]:
        """Snapshots from time 0 on, without end."""
        start = time.perf_counter()
        return self.at(time.perf_counter() - start for _ in itertools.count())

    def at(self, times_s: Iterable[float]) -> Iterator[Snapshot]:
        """Snapshots at given times, each with noise of its own [s]."""
        room, placed = InterventionRoom(machine=self.machine), PlacedKnocks(self.knocks, self.cameras)
        for number, time_s in enumerate(times_s):
            moment = room.at(time_s, joints=self.joints)
            frames = render(placed.cameras(moment.time_s), moment, seed=self.seed + number)
            told = reported_joints(self.knocks, moment.joints, moment.time_s)
            yield Snapshot(tuple(frames), told, now_ns=moment.stamp_ns)

    def close(self) -> None:
        """Nothing is held."""
