"""The pass of a room in which no motion is asked: a snapshot in, free space out. Without verdicts its level is stop."""

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace

from elbowroom.geometry import DepthCamera, VoxelGrid
from elbowroom.machine import Machine
from elbowroom.monitor.cycle import cameras_of, failure, lateness
from elbowroom.monitor.result import CycleResult
from elbowroom.monitor.stages import raise_interrupt, timed
from elbowroom.reconstruct import Terms, free_space_of
from elbowroom.sensing import Snapshot


@dataclass(slots=True, eq=False)
class SpaceCycle:
    """The pass, and all that stays the same from one to the next, as `Cycle` without motions.

    Args:
        grid: the watched box.
        cameras: all cameras of the room.
        machine: whose body is explained and taken out; None: the bare room.
        terms: how strictly space is judged.
        clock_ns: by which the time that a pass takes is told [ns]; it never goes back.
    """

    grid: VoxelGrid
    cameras: Sequence[DepthCamera]
    machine: Machine | None
    terms: Terms = field(default_factory=Terms)
    clock_ns: Callable[[], int] = time.perf_counter_ns
    sequence: int = field(default=0, init=False)

    def run(self, snapshot: Snapshot, begun_ns: int | None = None) -> CycleResult:
        """The free space of a snapshot. It does not raise: a fault leaves no space, and its reason.

        Args:
            snapshot: what came.
            begun_ns: when it came [ns of `clock_ns`]; None: now.
        """
        begun_ns = self.clock_ns() if begun_ns is None else begun_ns
        stage_ms: dict[str, float] = {}
        try:
            oldest_ms = snapshot.oldest_age_ms
            space = free_space_of(
                self.grid,
                self.cameras,
                snapshot,
                self.machine,
                self.terms,
                timer=lambda stage: timed(stage, stage_ms),
            )
            late = lateness(snapshot, self.terms, (self.clock_ns() - begun_ns) / 1e6)
        except Exception as error:
            raise_interrupt(error)
            return self.failed(error, snapshot, stage_ms)
        now_ns = snapshot.now_ns or 0
        skew_ms = snapshot.fresh(self.terms.max_age_ns).skew_ms
        result = CycleResult(self._number(), now_ns, space.released(), (), stage_ms, oldest_ms)
        return replace(result, late=late, skew_ms=skew_ms, given=cameras_of(snapshot))

    def failed(
        self, error: Exception, snapshot: Snapshot | None, stage_ms: dict[str, float] | None = None
    ) -> CycleResult:
        """A pass that came to nothing.

        Args:
            error: what was raised.
            snapshot: what the pass was about; None: nothing had come.
            stage_ms: time that each stage took [ms], as far as it came.
        """
        return failure(self._number(), error, snapshot, stage_ms)

    def unplaced(self, snapshot: Snapshot) -> CycleResult:
        """A pass in which nobody knows where the machine is: nothing is free."""
        return CycleResult(self._number(), snapshot.now_ns or 0, None, (), {}, snapshot.oldest_age_ms)

    def _number(self) -> int:
        self.sequence += 1
        return self.sequence - 1
