"""How strictly space is judged: one value from the site file to the last stage."""

from dataclasses import dataclass, field

import numpy as np

from elbowroom.choices import DETAILS, RULES, Detail, Rule
from elbowroom.errors import InputError, MachineError
from elbowroom.geometry.margin import Margin

WITNESS_ANGLE_DEG = 2.0
"""Two cameras side by side, 10 cm apart, at 3 m; of hand-held views it takes a twenty-fifth of what they find free."""
MOST_ANGLE_DEG = 45.0
PEOPLE_SPEED_M_S = 2.0
"""How fast a hand is taken to reach out where nobody measured it (ISO 13855:2010); people walk at 1.6 m/s."""

_NOTHING_MOVES = (
    "nothing but the machine moves here (nothing_moves, people_speed_m_s 0): what a camera saw to be free is taken to "
    "be so for as long as its image counts"
)
_ABSENT = (
    "the machine stood in none of these images (recording.without_machine): all that they show is something else, also "
    "where it is to stand; nothing is said of a room in which it stands"
)


@dataclass(frozen=True, slots=True)
class Terms:
    """How strictly space is judged. Two terms are equal if they judge alike.

    Args:
        rule: how cameras that disagree are decided between: `three`, `majority`, `veto`, `any` (see `resolve`).
        detail: how closely images are looked at: `pixel`, `footprint`, `point` (see `carve`).
        margin: of cameras without one of their own.
        max_age_ns: frames older than this are not used [ns]; None: no limit.
        explain_tolerance_m: how near to the machine's model a return counts as the machine, besides its noise [m].
        body_growth_m: by how much the body is grown where it is taken out, at least a quarter voxel [m]; None: by
            what a pixel covers (`growth.growth_of`).
        witness_angle_deg: by rule `three`, cameras nearer to each other than this, as seen from the grid, are one
            witness (`witnesses`) [deg]; 0: each is one.
        look_again: voxels in the way are looked at again in parts. False: what the volume says holds, so that who has
            images and who has only the volume say the same.
        people_speed_m_s: the most that anything but the machine moves: what a camera saw to be free holds for what
            such a thing cannot have reached since [m/s].
        nothing_moves: somebody vouches that nothing but the machine moves here: only then that speed is 0.
        pass_ns: how long after the snapshot verdicts count, at most: a pass that is assumed to take so long [ns].
        without_machine: somebody vouches that the machine is in none of the images: nothing in them is taken for it,
            and no space is its body's.

    Raises:
        InputError: an unknown rule or detail, an age or a time of a pass below zero, or a speed that is not above zero
            though something moves, or not 0 though nothing does.
        MachineError: a tolerance or growth that cannot be.
    """

    rule: Rule = "three"
    detail: Detail = "pixel"
    margin: Margin = field(default_factory=Margin)
    max_age_ns: int | None = None
    explain_tolerance_m: float = 0.01
    body_growth_m: float | None = None
    look_again: bool = True
    witness_angle_deg: float = WITNESS_ANGLE_DEG
    people_speed_m_s: float = PEOPLE_SPEED_M_S
    nothing_moves: bool = False
    pass_ns: int = 0
    without_machine: bool = False

    def __post_init__(self) -> None:
        if self.rule not in RULES:
            raise InputError(f"rule: {self.rule!r} is unknown, allowed are {', '.join(RULES)}")
        if self.detail not in DETAILS:
            raise InputError(f"detail: {self.detail!r} is unknown, allowed are {', '.join(DETAILS)}")
        if self.max_age_ns is not None and self.max_age_ns < 0:
            raise InputError(f"max_age_ns: is {self.max_age_ns}, must be at least 0")
        if not 0 <= self.witness_angle_deg <= MOST_ANGLE_DEG:
            raise InputError(
                f"witness_angle_deg is {self.witness_angle_deg}, must be from 0 to {MOST_ANGLE_DEG:g} degrees"
            )
        if not self.explain_tolerance_m >= 0:
            raise MachineError(f"explain_tolerance_m is {self.explain_tolerance_m}, must be at least 0 [m]")
        require_speed(self.people_speed_m_s, self.nothing_moves)
        if self.pass_ns < 0:
            raise InputError(f"pass_ns: is {self.pass_ns}, must be at least 0")
        growth = self.body_growth_m
        if growth is not None and not (np.isfinite(growth) and growth > 0):
            raise MachineError(f"body_growth_m is {growth}, must be at least a quarter voxel [m]")

    @property
    def allowances(self) -> tuple[str, ...]:
        """What somebody vouches for, and what nobody checks: a line each."""
        return (
            *((_NOTHING_MOVES,) if self.nothing_moves else ()),
            *((_ABSENT,) if self.without_machine else ()),
        )

    @property
    def needs_counts(self) -> bool:
        """Whether the rule needs every camera asked of every voxel, and counted: all but `three` do."""
        return self.rule != "three"


def require_speed(people_speed_m_s: float, nothing_moves: bool) -> None:
    """Refuses a speed of people that does not go with whether anything moves.

    Args:
        people_speed_m_s: the most that anything but the machine moves [m/s].
        nothing_moves: whether somebody vouches that nothing does.

    Raises:
        InputError: not a number of at least 0; 0 though something may move, or more though nothing does.
    """
    if not (np.isfinite(people_speed_m_s) and people_speed_m_s >= 0):
        raise InputError(f"people_speed_m_s: is {people_speed_m_s}, must be at least 0 [m/s]")
    if people_speed_m_s == 0 and not nothing_moves:
        raise InputError(
            "people_speed_m_s: 0 says that nothing but the machine ever moves here; if that is so, say nothing_moves "
            f"as well, else {PEOPLE_SPEED_M_S:g} m/s is usual"
        )
    if people_speed_m_s > 0 and nothing_moves:
        raise InputError(
            f"nothing_moves: goes with people_speed_m_s 0 alone, it is {people_speed_m_s:g} m/s; leave one of them out"
        )
