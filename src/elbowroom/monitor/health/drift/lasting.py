"""How long a camera has been hidden, covered, blind or silent without a break, and when that is too long."""

from collections.abc import Mapping, Set
from dataclasses import dataclass, field

from elbowroom.monitor.health.health import Condition

LIMITS_S: Mapping[Condition, float] = {
    Condition.SILENT: 2.0,
    Condition.BLIND: 1.0,
    Condition.COVERED: 5.0,
    Condition.HIDDEN: 60.0,
}
"""After so long nothing may move; the worst first. Who stands before a camera for a moment hides it for less."""


@dataclass(slots=True, eq=False)
class Lasting:
    """Since when a camera has been in each of these conditions."""

    _since_ns: dict[Condition, int] = field(default_factory=dict, init=False)
    _last_ns: dict[Condition, int] = field(default_factory=dict, init=False)

    def seen(self, said: Set[Condition], stamp_ns: int) -> None:
        """A frame came; it ends the silence and all that it does not say.

        Args:
            said: all that is true of it: a camera that is covered is hidden as well.
            stamp_ns: when it was taken [ns].
        """
        for lasting in LIMITS_S:
            if lasting in said:
                self._go_on(lasting, stamp_ns)
            else:
                self._since_ns.pop(lasting, None)

    def silent(self, now_ns: int) -> None:
        """No new frame came; it says nothing of whether something hides the view [ns]."""
        self._go_on(Condition.SILENT, now_ns)

    def not_silent(self) -> None:
        """A frame came, and nobody looked at it."""
        self._since_ns.pop(Condition.SILENT, None)

    @property
    def too_long(self) -> tuple[Condition, float] | None:
        """The worst condition that has lasted beyond its limit, and for how long [s]; None: none has."""
        for condition, limit_s in LIMITS_S.items():
            if condition in self._since_ns:
                lasted = (self._last_ns[condition] - self._since_ns[condition]) / 1e9
                if lasted >= limit_s:
                    return condition, lasted
        return None

    def _go_on(self, condition: Condition, stamp_ns: int) -> None:
        self._since_ns.setdefault(condition, stamp_ns)
        self._last_ns[condition] = stamp_ns
