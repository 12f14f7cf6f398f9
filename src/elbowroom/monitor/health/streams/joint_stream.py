"""The machine's joint positions as they come: which causes are there by now. It remembers."""

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field

from elbowroom.errors import MachineError
from elbowroom.machine import Machine
from elbowroom.machine.joint import Joint
from elbowroom.monitor.health.held import Held
from elbowroom.monitor.health.streams.arrivals import Arrivals
from elbowroom.monitor.health.streams.cause import HealthCause

C = HealthCause
START_NS = 5_000_000_000
"""Positions may take so long to come at first; then they are missing [ns]."""
UNSURE_NS = 50_000_000
"""By so much the time between two positions may be longer than is known [ns]."""
STILL_NS = 100_000_000
"""A joint that is commanded to move, and has not by so long, or that is seen elsewhere, stands still [ns]."""
CLEARS = {
    C.JOINTS_STARTING: "the first positions of all joints",
    C.JOINTS_MISSING: "3 positions of all joints in a row",
    C.JOINTS_BEYOND: "3 positions in a row within all limits",
    C.JOINTS_IMPLAUSIBLE: "3 positions in a row that follow from each other",
    C.JOINTS_FROZEN: "3 positions in a row that are new",
}
SOURCE = "joints"


@dataclass(frozen=True, slots=True)
class Heard:
    """What came of the joints at one moment.

    Args:
        positions: by name [m or rad]; None: none came.
        stamp_ns: when they were so [ns, the clock of the frames]; None: nobody says.
        went_ns: between this pass and the one before [ns].
        speeds: at which the machine is commanded to move, by joint [m/s or rad/s]; None: nobody says.
        is_elsewhere: whether cameras see the machine elsewhere than its joints say.
    """

    positions: Mapping[str, float] | None
    stamp_ns: int | None
    went_ns: int
    speeds: Mapping[str, float] | None = None
    is_elsewhere: bool = False


@dataclass(slots=True, eq=False)
class JointStream:
    """What is remembered of a machine's joints.

    Args:
        machine: whose.
        greatest: by joint, the greatest speed [m/s or rad/s]; of others no jump is too far.
    """

    machine: Machine
    greatest: Mapping[str, float] = field(default_factory=dict)

    texts: dict[HealthCause, str] = field(default_factory=dict, init=False)
    """What was found last, by cause."""
    _held: dict[HealthCause, Held] = field(init=False)
    _arrivals: Arrivals = field(default_factory=Arrivals, init=False)
    _last: Heard | None = field(default=None, init=False)
    _since_ns: int = field(default=0, init=False)
    _apart_ns: int = field(default=0, init=False)
    _still_ns: dict[str, int] = field(default_factory=dict, init=False)
    _has_moved: bool = field(default=False, init=False)

    def __post_init__(self) -> None:
        self._held = {cause: Held(clears_after=3) for cause in CLEARS}
        self._held[C.JOINTS_STARTING] = Held(1, 1, is_there=True)
        self.texts[C.JOINTS_STARTING] = "positions are awaited"

    def hear(self, heard: Heard) -> None:
        """Takes one pass into account."""
        self._since_ns += max(heard.went_ns, 0)
        self._apart_ns += max(heard.went_ns, 0)
        missing = self._missing(heard.positions)
        self._hear_missing(missing)
        if missing is not None or heard.positions is None:
            self._arrivals = self._arrivals.passing(heard.went_ns, False)
            return
        wrong = self._not_finite(heard.positions)
        beyond = None if wrong is not None else self._beyond(heard.positions)
        self._say(C.JOINTS_BEYOND, None if wrong is not None else beyond is not None, beyond or "")
        if beyond is None:
            wrong = wrong or self._impossible(heard.positions) or self._jump(heard)
            self._say(C.JOINTS_IMPLAUSIBLE, wrong is not None, wrong or "")
        if self._is_bad:
            return
        self._hear_standing(heard)
        self._last, self._apart_ns = heard, 0

    @property
    def causes(self) -> Iterator[HealthCause]:
        """Those that are there."""
        there = {cause for cause, held in self._held.items() if held.is_there}
        return (cause for cause in HealthCause if cause in there)

    @property
    def is_usable(self) -> bool:
        """Whether the newest positions are some that the machine can be at."""
        return not (
            self._held[C.JOINTS_STARTING].is_there or self._held[C.JOINTS_MISSING].bad or self._is_bad
        )

    @property
    def _is_bad(self) -> bool:
        """Whether the newest positions are out of reach, or none."""
        return bool(self._held[C.JOINTS_BEYOND].bad or self._held[C.JOINTS_IMPLAUSIBLE].bad)

    def _say(self, cause: HealthCause, is_bad: bool | None, text: str) -> None:
        if is_bad:
            self.texts[cause] = text
        self._held[cause] = self._held[cause].hearing(is_bad)

    def _missing(self, positions: Mapping[str, float] | None) -> str | None:
        """What is not there; None: all is."""
        if positions is None:
            return "positions do not come"
        names = [name for name in self.machine.joint_names if name not in positions]
        return f"positions lack {', '.join(names)}" if names else None

    def _hear_missing(self, missing: str | None) -> None:
        if self._held[C.JOINTS_STARTING].is_there and missing is not None:
            is_over = self._since_ns > START_NS
            self.texts[C.JOINTS_STARTING] = f"are awaited for {self._since_ns / 1e9:.1f} s: {missing}"
            self._say(C.JOINTS_MISSING, True if is_over else None, missing)
            return
        self._say(C.JOINTS_STARTING, False, "")
        self._say(C.JOINTS_MISSING, missing is not None, missing or "")

    def _not_finite(self, positions: Mapping[str, float]) -> str | None:
        for name in self.machine.joint_names:
            if not math.isfinite(positions[name]):
                return f"{name} is {positions[name]}, no finite number"
        return None

    def _beyond(self, positions: Mapping[str, float]) -> str | None:
        for joint in self._commanded():
            value, over = positions[joint.name], self.machine.tolerance.of(joint)
            if not joint.lower - over <= value <= joint.upper + over:
                limits = f"{joint.lower:g} to {joint.upper:g} {joint.unit}"
                return f"{joint.name} is at {value:g} {joint.unit}, its limits are {limits}"
        return None

    def _impossible(self, positions: Mapping[str, float]) -> str | None:
        try:
            self.machine.checked(positions)
        except MachineError as error:
            return str(error)
        return None

    def _commanded(self) -> Iterator[Joint]:
        return (joint for joint in self.machine.joints if joint.mimic is None)

    def _jump(self, heard: Heard) -> str | None:
        """That the machine cannot have come here from where it was last; None: it can."""
        last = self._last
        if heard.positions is None or last is None or last.positions is None:
            return None
        stamps_ns = 0 if heard.stamp_ns is None or last.stamp_ns is None else heard.stamp_ns - last.stamp_ns
        took_s = (max(stamps_ns, self._apart_ns) + UNSURE_NS) / 1e9
        for joint in self._commanded():
            most = self.greatest.get(joint.name)
            went = abs(_way(joint, last.positions[joint.name], heard.positions[joint.name]))
            if most is not None and went > most * took_s + self.machine.tolerance.of(joint):
                return (
                    f"{joint.name} went {went:.3g} {joint.unit} in {1e3 * took_s:.0f} ms, at most "
                    f"{most:.3g} {joint.unit}/s are possible"
                )
        return None

    def _hear_standing(self, heard: Heard) -> None:
        """Whether stamps stand still, or joints do that are commanded to move, or are seen elsewhere."""
        last = self._last
        is_new = last is None or heard.stamp_ns is None or heard.stamp_ns != last.stamp_ns
        self._arrivals = self._arrivals.passing(heard.went_ns, is_new)
        still = self._standing(heard)
        if self._arrivals.is_overdue:
            text = f"positions are {self._arrivals.waited_ns / 1e6:.0f} ms old: their stamp stands still"
            self._say(C.JOINTS_FROZEN, True, text)
        elif still is not None:
            self._say(C.JOINTS_FROZEN, True, still)
        elif is_new and (not any(self._still_ns.values()) or not self._should_move(heard)):
            self._say(C.JOINTS_FROZEN, False, "")

    def _standing(self, heard: Heard) -> str | None:
        """What stands still though it should not; None: nothing does."""
        assert heard.positions is not None
        last = None if self._last is None else self._last.positions
        for name in self.machine.joint_names:
            is_same = last is not None and last[name] == heard.positions[name]
            self._has_moved |= last is not None and not is_same
            self._still_ns[name] = self._still_ns.get(name, 0) + max(heard.went_ns, 0) if is_same else 0
        for name, speed in (heard.speeds or {}).items():
            if speed != 0 and self._still_ns.get(name, 0) > STILL_NS:
                return f"{name} stays at {heard.positions[name]:g} though it is commanded to move"
        stood_ns = min(self._still_ns.values(), default=0)
        if heard.is_elsewhere and self._has_moved and stood_ns > STILL_NS:
            return (
                f"positions have not changed for {stood_ns / 1e6:.0f} ms, and the machine is seen elsewhere"
            )
        return None

    def _should_move(self, heard: Heard) -> bool:
        return heard.is_elsewhere or any(speed != 0 for speed in (heard.speeds or {}).values())


def _way(joint: Joint, start: float, end: float) -> float:
    """From one position to another; a continuous joint goes the shorter way [m or rad]."""
    if joint.kind != "continuous":
        return end - start
    return (end - start + math.pi) % (2 * math.pi) - math.pi
