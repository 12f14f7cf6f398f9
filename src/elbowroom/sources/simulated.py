"""The simulated intervention room as a source: people walk, the machine moves, as time goes on."""

import itertools
import time
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass

from elbowroom.geometry import DepthCamera
from elbowroom.machine import Machine
from elbowroom.sensing import DepthFrame, Snapshot
from elbowroom.simulate import InterventionRoom, render
from elbowroom.simulate.knock import Knock, PlacedKnocks, reported_joints
from elbowroom.simulate.rounds import walking_staff

GOLDEN = 0.6180339887
"""Its multiples, less the whole, keep neighbours apart."""


@dataclass(frozen=True, slots=True, eq=False)
class Simulated:
    """The simulated room; frames are new when they come, however long it took to make them.

    Args:
        cameras: where they are said to be.
        machine: what moves there; None: the ceiling C-arm.
        joints: positions that hold throughout [m or rad]; None: it moves.
        seed: of the sensors' noise.
        knocks: what is knocked, and when.
        skew_ms: cameras are exposed up to so long before the moment, each by its share [ms]; 0: all at once.
    """

    cameras: Sequence[DepthCamera]
    machine: Machine | None = None
    joints: Mapping[str, float] | None = None
    seed: int = 0
    knocks: Sequence[Knock] = ()
    skew_ms: float = 0.0

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
        room = InterventionRoom(machine=self.machine, staff=walking_staff())
        placed = PlacedKnocks(self.knocks, self.cameras)
        for number, time_s in enumerate(times_s):
            moment = room.at(time_s, joints=self.joints)
            told = reported_joints(self.knocks, moment.joints, moment.time_s)
            if not self.skew_ms:
                frames = render(placed.cameras(moment.time_s), moment, seed=self.seed + number)
                yield Snapshot(tuple(frames), told, now_ns=moment.stamp_ns)
                continue
            exposed, joints_of = list[DepthFrame](), dict[str, Mapping[str, float]]()
            for index, lag_s in enumerate(self._lags_s()):
                then = room.at(time_s - lag_s, joints=self.joints)
                camera = placed.cameras(then.time_s)[index]
                exposed += render([camera], then, seed=self.seed + number)
                joints_of[camera.name] = reported_joints(self.knocks, then.joints, then.time_s)
            yield Snapshot(tuple(exposed), told, joints_of, now_ns=moment.stamp_ns)

    def _lags_s(self) -> list[float]:
        """By camera, how long before the moment it is exposed [s]: evenly spread, neighbours far apart."""
        many = len(self.cameras)
        order = sorted(range(many), key=lambda number: number * GOLDEN % 1)
        return [order.index(number) / max(1, many - 1) * self.skew_ms / 1e3 for number in range(many)]

    def close(self) -> None:
        """Nothing is held."""
