"""What one pass from frames to verdicts came to."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Self

from elbowroom.finding import Finding
from elbowroom.monitor.health.health import Health
from elbowroom.monitor.health.known import Known
from elbowroom.monitor.health.streams.cause import Sick
from elbowroom.motion import Cause, Distances, Level, PathVerdict, Verdict, machine_speed
from elbowroom.reconstruct.free_space import FreeSpace


@dataclass(frozen=True, slots=True, eq=False)
class CycleResult:
    """The verdicts of one pass, and how it came to them.

    Args:
        sequence: number of the pass, from 0.
        stamp_ns: time at which it began [ns, the clock of the frames]; 0: nothing had a time.
        space: the free space that was judged; None: there is none, since the pass failed.
        verdicts: one for each motion that was asked, in their order; where something failed: stop.
        stage_ms: time that each stage took [ms], in the order of the stages.
        oldest_age_ms: age of the oldest frame when the pass began [ms]; None: no frame, or none with a stamp.
        fault: why verdicts are missing, one sentence; None: the pass is whole.
        health: whether cameras and machine are where they are said to be; None: nobody watches, or the watch failed.
            While it names a reason, every verdict is stop.
        findings: what the looks at the input found; while one of them stops, every verdict is stop.
        late: that frames were past their age when the verdicts were out, so that every one is stop, one sentence; None:
            they were in time, or there is no limit.
        skew_ms: between the stamps of the oldest and the newest frame that was used [ms]; None: there are no two.
        distances: of the links from blocked space; None: nobody asked, or the pass failed.
        sick: what is wrong with which source. A camera of it was left out; while joints are, every verdict is stop.
        blind: that no camera gave anything that counts, so that every verdict is stop, one sentence; None: one did.
        stopping: whether the machine, as fast as it is, would come to rest in free space; None: that is not known.
        velocities: how fast its joints are, by name [m/s or rad/s]; None: that is not known.
        path: how far it may follow the path that it means to take; its time 0 is the pass's. None: none was said.
        off_path: why that path is none from where it is, so that every verdict is stop, one sentence; None: it is one.
        given: names of the cameras whose frames were judged; None: nothing was.
    """

    sequence: int
    stamp_ns: int
    space: FreeSpace | None
    verdicts: tuple[Verdict, ...]
    stage_ms: Mapping[str, float]
    oldest_age_ms: float | None
    fault: str | None = None
    health: Health | None = None
    findings: tuple[Finding, ...] = ()
    late: str | None = None
    skew_ms: float | None = None
    sick: tuple[Sick, ...] = ()
    blind: str | None = None
    given: tuple[str, ...] | None = None
    distances: Distances | None = None
    stopping: PathVerdict | None = None
    velocities: Mapping[str, float] | None = None
    path: PathVerdict | None = None
    off_path: str | None = None

    def knowing(self, known: Known) -> Self:
        """The same pass with what is known of cameras and machine: every verdict is stop if that failed, or says so."""
        cause = known.stop_cause
        return replace(
            self,
            # free space that comes from a camera that is elsewhere is no free space
            verdicts=tuple(v if cause is None else _stopped(v, cause) for v in self.verdicts),
            stage_ms={**known.stage_ms, **self.stage_ms},
            fault=self.fault or known.fault,
            health=known.health,
            findings=known.findings,
            sick=known.sick,
            blind=known.blind,
        )

    @property
    def stopped_by(self) -> str | None:
        """Why every verdict is stop, whatever the space is: the fault, else frames that are too old by now, else input
        that cannot be right, else what the watch found; None: none of them.
        """
        found = [each.text for each in self.sick if each.stops]
        wrong = "; ".join([*found, *(finding.text for finding in self.findings if finding.stops)])
        watched = self.health.reason if self.health is not None else None
        return self.fault or self.late or wrong or self.blind or watched

    @property
    def safe_speed(self) -> float:
        """The greatest share of full speed that is safe for the machine, as `machine_speed`; 0 without a verdict."""
        return machine_speed(self.verdicts, self.velocities) if self.verdicts else 0.0

    @property
    def age_ms(self) -> float | None:
        """Age of the oldest frame when the verdicts are out [ms]; None: as `oldest_age_ms`."""
        return None if self.oldest_age_ms is None else self.oldest_age_ms + self.cycle_ms

    @property
    def cycle_ms(self) -> float:
        """Time of the whole pass [ms]."""
        return sum(self.stage_ms.values())

    @property
    def level(self) -> Level:
        """The most cautious level of all motions; stop where there is no verdict."""
        return min(
            (verdict.level for verdict in self.verdicts), key=lambda level: level.rank, default=Level.STOP
        )


def _stopped(verdict: Verdict, cause: Cause) -> Verdict:
    """Stop for the same motion; a fault stays one, and so does what is too old."""
    if verdict.cause in (Cause.FAULT, Cause.STALE):
        return verdict
    return Verdict.stop(verdict.motion, verdict.free_travel_unit, cause)
