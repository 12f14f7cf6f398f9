"""When something new came from a source, counted pass by pass: whether the next is overdue, or the source is gone."""

from dataclasses import dataclass, replace
from typing import Self

A_PASS_NS, MOST_A_PASS_NS = 50_000_000, 500_000_000
"""A pass counts for no more than this or a usual step, for what is overdue, and for no more than the second, for what
is gone [ns]: where the monitor itself stalled, or a recording skipped, no source is late."""
LEAST_STEPS = 8
"""After so many steps it is known how often something comes."""
REMEMBERED = 15
OVERDUE_STEPS, OVERDUE_NS = 2.25, 100_000_000
"""What did not come for so many usual steps, and for this long at least [ns], is overdue: one that is lost is not."""
GONE_STEPS, GONE_NS = 5.0, 1_000_000_000
"""What did not come for so many usual steps, and for this long at least [ns], is gone."""


@dataclass(frozen=True, slots=True)
class Arrivals:
    """How things came.

    Args:
        waited_ns: since something new came last, or since the start [ns]; a pass counts as `MOST_A_PASS_NS` at most.
        passed_ns: likewise; a pass counts as `A_PASS_NS` or a usual step at most.
        steps_ns: the latest steps between things that came [ns], as `waited_ns`.
        came: how many did.
        usual_ns: the mean of the latest steps [ns], as passes fall as they fall but their sum is sure; without those
            that are long beside the middle one, in which the monitor itself stalled; None: too few are known.
    """

    waited_ns: int = 0
    passed_ns: int = 0
    steps_ns: tuple[int, ...] = ()
    came: int = 0
    usual_ns: int | None = None

    def passing(self, went_ns: int, is_new: bool) -> Self:
        """The same after one more pass.

        Args:
            went_ns: between this pass and the one before, by the clock of what comes [ns].
            is_new: whether something new came with it.
        """
        waited_ns = self.waited_ns + min(max(went_ns, 0), MOST_A_PASS_NS)
        passed_ns = self.passed_ns + min(max(went_ns, 0), max(A_PASS_NS, self.usual_ns or 0))
        if not is_new:
            return replace(self, waited_ns=waited_ns, passed_ns=passed_ns)
        # a gap is no step: else what comes with gaps would soon have them by right
        is_step = self.came > 0 and not self._is_over(passed_ns)
        steps_ns = (*self.steps_ns, waited_ns)[-REMEMBERED:] if is_step or self._learns else self.steps_ns
        usual_ns = _usual_ns(steps_ns)
        return replace(
            self, waited_ns=0, passed_ns=0, steps_ns=steps_ns, came=self.came + 1, usual_ns=usual_ns
        )

    @property
    def is_overdue(self) -> bool:
        """Whether the next one should have come."""
        return self._is_over(self.passed_ns)

    @property
    def is_gone(self) -> bool:
        """Whether nothing has come for so long that nothing is expected."""
        return self.waited_ns > max(GONE_NS, GONE_STEPS * (self.usual_ns or 0))

    @property
    def _learns(self) -> bool:
        return self.came > 0 and self.usual_ns is None

    def _is_over(self, passed_ns: int) -> bool:
        usual_ns = self.usual_ns
        return usual_ns is not None and passed_ns > max(OVERDUE_NS, OVERDUE_STEPS * usual_ns)


def _usual_ns(steps_ns: tuple[int, ...]) -> int | None:
    if len(steps_ns) < LEAST_STEPS:
        return None
    middle_ns = sorted(steps_ns)[len(steps_ns) // 2]
    usual_ns = [step_ns for step_ns in steps_ns if step_ns <= OVERDUE_STEPS * middle_ns]
    return sum(usual_ns) // len(usual_ns)
