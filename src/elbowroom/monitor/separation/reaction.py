"""How long it takes from something happening to the decision that knows of it: measured by the run itself.

Something happens right after the middle of an exposure. The camera's next image shows it at the earliest, and the pass
that uses this one. So of each camera the reaction time is from the middle of the exposure that was used *before* to the
decision: one frame period, the age of the image when the pass begins, the pass, and the way to the output.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field, fields
from typing import Any, Self

from elbowroom.sensing import Snapshot


@dataclass(frozen=True, slots=True)
class Reaction:
    """The terms of a reaction time, from the middle of an exposure to the decision [ms].

    Args:
        period_ms: from the exposure that was used before to the one that is used now.
        age_ms: from that to the beginning of the pass: half the exposure, the way to this computer, waiting.
        pass_ms: from frames to verdicts.
        output_ms: from verdicts to the decision, said to whoever passes it on.
    """

    period_ms: float = 0.0
    age_ms: float = 0.0
    pass_ms: float = 0.0
    output_ms: float = 0.0

    @property
    def total_ms(self) -> float:
        """All of them [ms]."""
        return self.period_ms + self.age_ms + self.pass_ms + self.output_ms

    def worst(self, other: Self) -> Self:
        """The greater of each term: never less than either total."""
        return type(self)(*(max(getattr(self, f.name), getattr(other, f.name)) for f in fields(self)))

    def row(self) -> dict[str, float]:
        """As a file has it [ms]."""
        return {**{f.name: getattr(self, f.name) for f in fields(self)}, "total_ms": self.total_ms}


@dataclass(slots=True, eq=False)
class ReactionWatch:
    """Measures, pass by pass, and remembers the worst of each term.

    Args:
        max_age_ns: frames older than this are not used [ns]; None: all are.
    """

    max_age_ns: int | None = None
    worst: Reaction | None = field(default=None, init=False)
    greatest_ms: float | None = field(default=None, init=False)
    _used_ns: dict[str, int] = field(default_factory=dict, init=False)

    def add(self, snapshot: Snapshot, pass_ms: float, output_ms: float) -> Reaction | None:
        """The reaction time of a pass: of the camera that knew last of what happened; None: nobody can know it yet.

        A camera whose image is the same as before says nothing new: it counts when its next one comes. One without an
        image frees nothing any more, so what it would have seen late is blocked now.

        Args:
            snapshot: what the pass was about.
            pass_ms: from its beginning to its verdicts [ms].
            output_ms: from its verdicts to its decision [ms].
        """
        if snapshot.now_ns is None:
            return None
        used = {
            f.camera: f.stamp_ns for f in snapshot.fresh(self.max_age_ns).frames if f.stamp_ns is not None
        }
        waits = [
            self._of(camera, before_ns, used, snapshot)
            for camera, before_ns in self._used_ns.items()
            if used.get(camera) != before_ns
        ]
        self._used_ns = dict(used)
        if not waits:
            return None
        period_ms, age_ms = max(waits, key=sum)
        reaction = Reaction(period_ms, age_ms, pass_ms, output_ms)
        every = [Reaction(period, age, pass_ms, output_ms) for period, age in waits]
        for one in every if self.worst is None else [self.worst, *every]:
            self.worst = one if self.worst is None else self.worst.worst(one)
        self.greatest_ms = max(self.greatest_ms or 0.0, reaction.total_ms)
        return reaction

    def _of(
        self, camera: str, before_ns: int, used: Mapping[str, int], snapshot: Snapshot
    ) -> tuple[float, float]:
        """A camera's period and the age of its image [ms]."""
        assert snapshot.now_ns is not None
        bound_ns = snapshot.clock_bounds_ns.get(camera, 0)
        exposed_ns = used.get(camera, snapshot.now_ns)
        return max(0, exposed_ns - before_ns) / 1e6, max(0, snapshot.now_ns - exposed_ns + bound_ns) / 1e6

    def row(self) -> dict[str, Any]:
        """The worst of each term, their sum, the greatest reaction time of a single pass; empty: none is known."""
        if self.worst is None:
            return {}
        return {**self.worst.row(), "greatest_ms": self.greatest_ms}
