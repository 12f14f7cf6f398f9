"""The loop of a run: snapshots in, verdicts out to every face. Whatever fails in it, every face is told to stop."""

import time
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import ExitStack, suppress
from dataclasses import dataclass, replace

from elbowroom.garbage import uncollected, what_is_here_stays
from elbowroom.monitor.cycle import Cycle
from elbowroom.monitor.face import Face, Pass
from elbowroom.monitor.gate.gate import Gate
from elbowroom.monitor.gate.state import Decision
from elbowroom.monitor.health.checks import Checks
from elbowroom.monitor.health.streams.streams import without_sick
from elbowroom.monitor.result import CycleResult
from elbowroom.monitor.separation.margins import Margins
from elbowroom.monitor.separation.separating import Separating
from elbowroom.monitor.space_cycle import SpaceCycle
from elbowroom.sensing import MeantPaths, Snapshot
from elbowroom.sources import Room, Source
from elbowroom.sources.pace import SLACK_S

LISTENS_S = 0.1
"""While it waits it listens so often for the wish to end [s]."""


@dataclass(frozen=True, slots=True, eq=False)
class Loop:
    """What takes part in a run, faces apart.

    Args:
        room: whose source gives the snapshots.
        checks: look after cameras and machine.
        cycle: judges; or, where no motion is asked, sees what is free.
        pace: called with each snapshot before it is judged; says for how long it is early [s], and so long the loop
            waits, unless the run ends before; None: nobody waits.
        gate: decides after each pass, before any face is told, and stops the machine at the end; None: nobody does.
        separating: measures reaction times and says how far the machine is from what it may hit; None: nobody does.
        paths: what the machine means to do; None: nobody says, or the source does.
    """

    room: Room
    checks: Checks
    cycle: Cycle | SpaceCycle
    pace: Callable[[Snapshot], float | None] | None = None
    gate: Gate | None = None
    separating: Separating | None = None
    paths: MeantPaths | None = None

    def run(
        self,
        faces: Sequence[Face],
        seconds: float | None = None,
        is_over: Callable[[], bool] = lambda: False,
    ) -> None:
        """Judges one snapshot after the other until the time is over, the source ends or somebody asks for the end.

        However it ends, every face is told, in order. What the source or a face raises ends the run: before it is
        raised again, every face is shown a pass in which all motions are stop.

        Args:
            faces: who shows or keeps each pass, in the order in which they are told.
            seconds: how long, also where the pace waits; None: until the source ends. One pass is always made, if there
                is a snapshot.
            is_over: whether somebody asked for the end, asked after each pass and while the pace waits.

        Raises:
            InputError: the gate cannot begin; nothing else has begun then.
        """
        until = time.perf_counter() + (float("inf") if seconds is None else seconds)
        snapshot: Snapshot | None = None
        if self.gate is not None:
            self.gate.begin()
        with what_is_here_stays(), _ended(faces, self.room.source) as ending:
            if self.gate is not None:
                ending.callback(self.gate.end)  # before any face is told of the end
            try:
                for face in faces:
                    face.begin(self.room)
                for snapshot, source_ms in timed_source(self._meaning()):
                    if not self._waited(snapshot, until, is_over):
                        break
                    begun_ns = self._time_ns()
                    result = self.judge(snapshot)
                    judged_ns = self._time_ns()
                    decision = self._decision(result)
                    margins = self._margins(snapshot, result, begun_ns, judged_ns)
                    done = Pass(snapshot, result, source_ms, decision, margins)
                    for face in faces:
                        face.show(done)
                    if is_over() or time.perf_counter() >= until:
                        break
            except Exception as error:
                self._say_stop(faces, snapshot, error)
                raise

    def judge(self, snapshot: Snapshot) -> CycleResult:
        """What one snapshot comes to; it does not raise."""
        begun_ns = self.cycle.clock_ns()
        with uncollected():
            known = self.checks.hear(snapshot)
            if not known.is_placed:
                return self.cycle.unplaced(snapshot).knowing(known)
            return self.cycle.run(without_sick(snapshot, known.sick), begun_ns).knowing(known)

    def _meaning(self) -> Iterator[Snapshot]:
        """What the source gives, each with what the machine means to do."""
        first_ns = None
        for snapshot in self.room.source:
            now_ns = snapshot.moment_ns
            first_ns = now_ns if first_ns is None else first_ns
            if self.paths is None or now_ns is None or first_ns is None:
                yield snapshot
            else:
                yield replace(snapshot, path=self.paths.at(now_ns, first_ns))

    def _decision(self, result: CycleResult) -> Decision | None:
        """What the gate makes of a pass."""
        return None if self.gate is None else self.gate.decide(result)

    def _time_ns(self) -> int:
        """The time by the clock that reaction times are measured by [ns]; 0: nobody measures any."""
        return 0 if self.separating is None else self.separating.clock_ns()

    def _margins(
        self, snapshot: Snapshot, result: CycleResult, begun_ns: int, judged_ns: int
    ) -> Margins | None:
        """What is left of distances, with the time that it took until now."""
        if self.separating is None:
            return None
        pass_ms, output_ms = (judged_ns - begun_ns) / 1e6, (self._time_ns() - judged_ns) / 1e6
        return self.separating.judged(snapshot, result, pass_ms, output_ms)

    def _waited(self, snapshot: Snapshot, until_s: float, is_over: Callable[[], bool]) -> bool:
        """Sleeps while a snapshot is early, if the run does not end before; whether it did not."""
        early_s = (self.pace(snapshot) if self.pace is not None else None) or 0.0
        if early_s <= SLACK_S:
            return True
        due_s = time.perf_counter() + early_s
        while not is_over():
            now_s = time.perf_counter()
            if now_s >= min(due_s, until_s):
                return due_s <= until_s
            time.sleep(min(due_s - now_s, max(until_s - now_s, 0.0), LISTENS_S))
        return False

    def _say_stop(self, faces: Sequence[Face], snapshot: Snapshot | None, error: Exception) -> None:
        """Shows a failed pass to every face, also to those behind one that cannot show it."""
        result = self.cycle.failed(error, snapshot)
        done = Pass(snapshot or Snapshot(()), result, 0.0, self._decision(result))
        for face in faces:
            with suppress(Exception):
                face.show(done)


def timed_source(source: Iterable[Snapshot]) -> Iterator[tuple[Snapshot, float]]:
    """Each snapshot, and what it took to bring it [ms]."""
    snapshots = iter(source)
    while True:
        begun = time.perf_counter()
        snapshot = next(snapshots, None)
        if snapshot is None:
            return
        yield snapshot, (time.perf_counter() - begun) * 1e3


def _ended(faces: Sequence[Face], source: Source) -> ExitStack:
    """A context at whose end all faces are told of it, in order, and the source is closed; also if one fails."""
    stack = ExitStack()
    stack.callback(source.close)
    for face in reversed(faces):
        stack.callback(face.end)
    return stack
