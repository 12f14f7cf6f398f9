"""What the gate remembers, what happens to it, and what it says: values."""

from collections.abc import Mapping
from dataclasses import dataclass
from enum import Enum
from types import MappingProxyType

from elbowroom.errors import InputError
from elbowroom.guard.fault import Fault
from elbowroom.guard.reason import Reason
from elbowroom.monitor.gate.claim import Claim
from elbowroom.motion import Level


class Phase(Enum):
    """Where the gate stands; the value is what an operator reads. In all but GUARDING the machine is stop."""

    STARTING = "waits for the first whole pass"
    GUARDING = "verdicts decide"
    LATCHED = "a fault is there"
    CLEARED = "no fault is there any more; a person has to reset"
    ENDED = "the run has ended"


@dataclass(frozen=True, slots=True)
class Rules:
    """What holds for a whole run.

    Args:
        motions: names of all motions that are asked, in their order.
        deadline_ns: within which a pass has to follow the one before; two missed are a fault [ns].
        rise_per_s: by how much a speed may rise in a second, as a share of full speed.
        low_speed: at which one creeps, as a share of full speed.
        hold_ns: for how long a held signal counts once it came [ns].

    Raises:
        InputError: no motion, or a number outside its range.
    """

    motions: tuple[str, ...]
    deadline_ns: int = 250_000_000
    rise_per_s: float = 0.5
    low_speed: float = 0.1
    hold_ns: int = 200_000_000

    def __post_init__(self) -> None:
        if not self.motions:
            raise InputError("gate: no motion is judged, so there is nothing to let through")
        for name, value, most in (
            ("deadline_ns", self.deadline_ns, 60_000_000_000),
            ("rise_per_s", self.rise_per_s, 1000.0),
            ("low_speed", self.low_speed, 0.5),
            ("hold_ns", self.hold_ns, 200_000_000),
        ):
            if not 0 < value <= most:
                raise InputError(f"gate: {name} is {value}, must be above 0 and at most {most:g}")

    @property
    def silence_ns(self) -> int:
        """Two deadlines: what is longer without a pass is silence [ns]."""
        return 2 * self.deadline_ns


@dataclass(frozen=True, slots=True)
class Judged:
    """A pass was finished.

    Args:
        claims: one for each motion, in the order of `Rules.motions`; anything else is a fault.
        faults: all that are there now, also those that were there before: one that is missing is over.
    """

    claims: tuple[Claim, ...]
    faults: tuple[Fault, ...] = ()


@dataclass(frozen=True, slots=True)
class Ticked:
    """Time went by; nothing came."""


@dataclass(frozen=True, slots=True)
class Held:
    """A person holds on to the switch that allows to creep, at this moment."""


@dataclass(frozen=True, slots=True)
class ResetAsked:
    """A person asks to forget the faults that are over."""


@dataclass(frozen=True, slots=True)
class Ended:
    """There will be no more passes."""


Event = Judged | Ticked | Held | ResetAsked | Ended


@dataclass(frozen=True, slots=True, eq=False)
class GateState:
    """All that the gate remembers.

    Args:
        phase: where it stands.
        latched: faults that were found since the last reset, in the order in which they were.
        active: those that are there now, as far as is known.
        speeds: what each motion is allowed now, as a share of full speed.
        claims: of the last pass; None: there was none, or it does not count any more.
        passed_ns: when the last pass was finished [ns]; None: none was since the start or the last reset.
        seen_ns: the latest time that was heard of [ns].
        held_ns: when the held signal came last [ns]; None: never.
    """

    phase: Phase
    latched: tuple[Fault, ...]
    active: tuple[Fault, ...]
    speeds: tuple[float, ...]
    claims: tuple[Claim, ...] | None = None
    passed_ns: int | None = None
    seen_ns: int | None = None
    held_ns: int | None = None

    @classmethod
    def start(cls, rules: Rules, latched: tuple[Fault, ...] = ()) -> "GateState":
        """Before anything came: stop.

        Args:
            rules: of the run.
            latched: what the latch on disk holds; they are there until the first pass says otherwise.
        """
        phase = Phase.LATCHED if latched else Phase.STARTING
        return cls(phase, latched, latched, (0.0,) * len(rules.motions))


@dataclass(frozen=True, slots=True)
class Allowed:
    """What one motion may do until the next decision.

    Args:
        motion: its name.
        level: stop where the speed is 0, decelerate where it is below full speed; else what the verdict says.
        speed: the greatest share of full speed, 0 to 1.
        reason: what holds it back.
        held: only while the held signal keeps coming.
        escapes: it leads out of what the machine stands in, and is slow for it.
    """

    motion: str
    level: Level
    speed: float
    reason: Reason
    held: bool = False
    escapes: bool = False


@dataclass(frozen=True, slots=True, eq=False)
class Decision:
    """What the gate says, for each motion, for each joint and for the machine.

    Args:
        phase: where the gate stands.
        motions: what each motion may do, in the order of `Rules.motions`.
        latched: faults since the last reset.
        active: those that are there now.
        held_until_ns: until when motions that are `held` may move [ns of the gate's clock]; None: none is.
        answer: to who asked for a reset; None: nobody did.
        is_reset: whether that reset was done.
    """

    phase: Phase
    motions: tuple[Allowed, ...]
    latched: tuple[Fault, ...] = ()
    active: tuple[Fault, ...] = ()
    held_until_ns: int | None = None
    answer: str | None = None
    is_reset: bool = False

    @property
    def least(self) -> Allowed:
        """What holds for whoever moves any joint in any direction: the most cautious of all."""
        return min(self.motions, key=lambda allowed: (allowed.level.rank, allowed.speed))

    @property
    def level(self) -> Level:
        """Of the machine."""
        return self.least.level if self.phase is Phase.GUARDING else Level.STOP

    @property
    def speed(self) -> float:
        """Of the machine, a share of full speed."""
        return self.least.speed if self.phase is Phase.GUARDING else 0.0

    @property
    def reason(self) -> Reason:
        """Why the machine is held back: a fault that is there, else one that was, else what holds back most."""
        if self.active:
            return self.active[0].reason
        if self.latched:
            return Reason.RESET_DUE
        return {Phase.STARTING: Reason.STARTING, Phase.ENDED: Reason.ENDED}.get(self.phase, self.least.reason)

    @property
    def joints(self) -> Mapping[str, Allowed]:
        """By joint, what holds whichever way it goes; a motion without a direction is by its own name."""
        found: dict[str, Allowed] = {}
        for allowed in self.motions:
            joint = allowed.motion.removesuffix(" +").removesuffix(" -")
            least = found.get(joint, allowed)
            found[joint] = min(least, allowed, key=lambda each: (each.level.rank, each.speed))
        return MappingProxyType(found)
