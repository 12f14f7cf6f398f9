"""What is asked: one joint in one direction, or a path of all joints."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from elbowroom.errors import InputError, MachineError

REACH_IN_BRAKING_DISTANCES = 5
"""A motion is looked at as far as the distance L (thesis 4.1), unless its reach says otherwise."""


@dataclass(frozen=True, slots=True)
class Motion:
    """One joint moves in one direction, all others stand still.

    Args:
        joint: name of the joint.
        direction: +1 or -1, the way in which the joint's value changes.
        braking_distance: S, at full speed [m or rad along the joint].
        reach: how far to look [m or rad along the joint]; None: 5 braking distances.
        reaction_distance: what the joint still goes at full speed before it brakes, v T_r, as far as S does not hold it
            already; only `Verdict.safe_speed` asks for it [m or rad along the joint].
        clearance: what shall be left where the joint rests; only `Verdict.safe_speed` asks for it, too [m or rad].

    Raises:
        InputError: another direction, a distance that is not a finite number above 0, or one of the last two below 0.
    """

    joint: str
    direction: int
    braking_distance: float
    reach: float | None = None
    reaction_distance: float = 0.0
    clearance: float = 0.0

    def __post_init__(self) -> None:
        if isinstance(self.direction, bool) or self.direction not in (1, -1):
            raise InputError(f"motion of {self.joint}: direction is {self.direction}, must be +1 or -1")
        object.__setattr__(self, "direction", int(self.direction))
        _check_distances(f"motion of {self.joint}", self.braking_distance, self.reach)
        for name in ("reaction_distance", "clearance"):
            value = getattr(self, name)
            if not (np.isfinite(value) and value >= 0):
                raise InputError(
                    f"motion of {self.joint}: {name} is {value}, must be a finite number of at least 0 [m or rad]"
                )

    @property
    def name(self) -> str:
        """Joint and direction, such as "larm +"."""
        return f"{self.joint} {'+' if self.direction > 0 else '-'}"

    @property
    def looked_at(self) -> float:
        """The reach that holds [m or rad along the joint]."""
        return self.reach if self.reach is not None else REACH_IN_BRAKING_DISTANCES * self.braking_distance


@dataclass(frozen=True, slots=True, eq=False)
class JointPath:
    """All joints move along straight lines in joint space, from where they are through each waypoint in turn.

    Progress is measured as *travel*: along one line it is the displacement of the joint that moves most there
    [m or rad, as the joint has it], and the lines add up. So for a path of one joint it is that joint's own
    displacement.

    Args:
        waypoints: joint positions by name [m or rad]; a joint that is not named stays where it was.
        braking_distance: S, in travel.
        reach: how far along the path to look, in travel; None: to its end.

    Raises:
        MachineError: a joint position that is not a finite number.
        InputError: no waypoint, or a distance that is not a finite number above 0.
    """

    waypoints: tuple[Mapping[str, float], ...]
    braking_distance: float
    reach: float | None = None

    def __init__(
        self, waypoints: Sequence[Mapping[str, float]], braking_distance: float, reach: float | None = None
    ) -> None:
        points = tuple(dict(point) for point in waypoints)
        if not points:
            raise InputError("joint path: no waypoints, at least one is needed")
        for index, point in enumerate(points):
            for joint, value in point.items():
                if not np.isfinite(value):
                    raise MachineError(
                        f"joint path: waypoint {index}: joint {joint} is {value}, must be finite [m or rad]"
                    )
        _check_distances("joint path", braking_distance, reach)
        object.__setattr__(self, "waypoints", points)
        object.__setattr__(self, "braking_distance", float(braking_distance))
        object.__setattr__(self, "reach", reach)

    @property
    def name(self) -> str:
        """What an operator reads: the joints that are named, such as "path of long, larm"."""
        return "path of " + ", ".join(dict.fromkeys(joint for point in self.waypoints for joint in point))


def _check_distances(what: str, braking_distance: float, reach: float | None) -> None:
    for name, value in (("braking_distance", braking_distance), ("reach", reach)):
        if value is not None and not (np.isfinite(value) and value > 0):
            raise InputError(f"{what}: {name} is {value}, must be a finite number above 0 [m or rad]")
