"""The thesis' six setups: rooms as GLB beside this file, the C-arm's pose in each, and the 35 movements asked there.

Rooms after Appendix A of Hamersma 2011, movements after its Appendices B and C. The thesis prints no poses; these were
chosen, by exact geometry and the volume of true voxels, so that its bands S, M, L and 0 all occur and contacts are met
face on, not grazed.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from pathlib import Path

from elbowroom.errors import InputError
from elbowroom.machine import Machine
from elbowroom.simulate.glb import solids_of_glb
from elbowroom.simulate.machine_solids import link_solids
from elbowroom.simulate.solid import Moment, Solid

FOLDER = Path(__file__).parent
TIME_S = 1.0
"""All setups stand still: this is their one moment [s]."""


@dataclass(frozen=True, slots=True)
class Movement:
    """One line of the thesis' Table 4.

    "2 x Long - Prop" is the second step of a longitudinal move and then the propeller: the machine has gone two steps
    of long, and the propeller is asked. "3 x Long" alone is the third step itself: two steps are done.

    Args:
        name: as the thesis prints it.
        before: how far each joint has gone from the setup's pose when it is asked [m or rad].
        joint, direction: what is asked.
        thesis_band, thesis_truth, thesis_verdict: the thesis' reconstruction, simulation and verdict.
    """

    name: str
    before: Mapping[str, float]
    joint: str
    direction: int
    thesis_band: str
    thesis_truth: str
    thesis_verdict: str


@dataclass(frozen=True, slots=True)
class Setup:
    """A room of Appendix A with the C-arm in a pose.

    Args:
        number: 1 to 6.
        words: what the pose is for.
        joints: of the ceiling C-arm, by name [m or rad].
        movements: asked there.
    """

    number: int
    words: str
    joints: Mapping[str, float]
    movements: tuple[Movement, ...]

    @property
    def name(self) -> str:
        """Such as "setup1"."""
        return f"setup{self.number}"

    @property
    def path(self) -> Path:
        """Its GLB."""
        return FOLDER / f"{self.name}.glb"

    def solids(self) -> tuple[Solid, ...]:
        """All of the room but the machine; read once."""
        return _solids(self.path)

    def joints_before(self, movement: Movement) -> dict[str, float]:
        """Where the machine is when a movement is asked, by name [m or rad]."""
        return {name: value + movement.before.get(name, 0.0) for name, value in self.joints.items()}

    def at(self, machine: Machine, joints: Mapping[str, float] | None = None) -> Moment:
        """The room with the machine in it.

        Args:
            machine: such as `ceiling_c_arm()`.
            joints: positions by name [m or rad]; None: the setup's own.
        """
        here = dict(self.joints if joints is None else joints)
        return Moment(TIME_S, self.solids() + link_solids(machine, here), here)


def setup(number: int | str) -> Setup:
    """One of the six, by number or name such as "setup3".

    Raises:
        InputError: there is no such setup.
    """
    for known in SETUPS:
        if number in (known.number, known.name):
            return known
    raise InputError(f"setup: {number!r} is unknown, known are {', '.join(s.name for s in SETUPS)}")


@cache
def _solids(path: Path) -> tuple[Solid, ...]:
    return solids_of_glb(path)


def _pose(
    long: float = 0.0, larm_deg: float = 0.0, propeller_deg: float = 0.0, carc_deg: float = 0.0
) -> dict[str, float]:
    degrees = {"larm": larm_deg, "propeller": propeller_deg, "carc": carc_deg}
    return {"long": long, **{name: math.radians(value) for name, value in degrees.items()}}


def _steps(words: str, joint: str, direction: int, step: float, outcomes: str) -> tuple[Movement, ...]:
    """A joint's movement step by step; each outcome is the thesis' band, truth and verdict, as "MLts"."""
    return tuple(
        Movement(
            words if done == 0 else f"{done + 1} x {words}",
            {joint: direction * step * done},
            joint,
            direction,
            *_outcome(outcome),
        )
        for done, outcome in enumerate(outcomes.split())
    )


def _after(
    words: str, before: Mapping[str, float], joint: str, direction: int, outcome: str
) -> tuple[Movement, ...]:
    return (Movement(words, before, joint, direction, *_outcome(outcome)),)


def _outcome(text: str) -> tuple[str, str, str]:
    return text[0], text[1], text[2:]


_STEP5 = 0.0475

SETUPS: tuple[Setup, ...] = (
    Setup(
        1,
        "upright at the head end",
        _pose(),
        _after("Larm +", {}, "larm", 1, "00s")
        + _after("Larm -", {}, "larm", -1, "LLs")
        + _after("Propeller +", {}, "propeller", 1, "00s")
        + _after("Propeller -", {}, "propeller", -1, "00s")
        + _after("Carc +", {}, "carc", 1, "00s")
        + _after("Carc -", {}, "carc", -1, "00s")
        + _after("Long +", {}, "long", 1, "00s")
        + _after("Long -", {}, "long", -1, "00s"),
    ),
    Setup(
        2,
        "over the patient, towards the lamp",
        _pose(-0.09),
        _steps("Long", "long", 1, 0.035, "MLts MLts MMs LLs"),
    ),
    Setup(
        3,
        "across the table from the side",
        _pose(-0.1995, larm_deg=90),
        _steps("Long", "long", 1, 0.0485, "00s LLs LLs MMs SSs"),
    ),
    Setup(
        4,
        "tilted between doctor and nurse",
        _pose(larm_deg=14.9),
        _steps("Prop", "propeller", 1, math.radians(15.4), "M0ts S0tts SSs")
        + _steps("Larm", "larm", 1, math.radians(3.8), "LLs LLs MMs SSs"),
    ),
    Setup(
        5,
        "among thin things: hose, drip stand, lines",
        _pose(0.065, larm_deg=-12, propeller_deg=10),
        _steps("Long", "long", 1, _STEP5, "LLs LLs MMs")
        + _after("Prop", {}, "propeller", 1, "LLs")
        + _after("Long - Prop", {"long": _STEP5}, "propeller", 1, "MLu")
        + _after("2 x Long - Prop", {"long": 2 * _STEP5}, "propeller", 1, "SMu")
        + _after("Larm", {}, "larm", -1, "LLs")
        + _after("Long - Larm", {"long": _STEP5}, "larm", -1, "LMts")
        + _after("2 x Long - Larm", {"long": 2 * _STEP5}, "larm", -1, "MMs"),
    ),
    Setup(
        6,
        "turned along its ring",
        _pose(carc_deg=16),
        _steps("Carc Rotation", "carc", 1, math.radians(20), "MLts SSs"),
    ),
)
"""All of them, with the movements that the thesis asked."""
