"""Which distance has to stay between a machine and what it may hit: terms from the literature, in plain sums.

ISO 10218-2:2025 (speed and separation monitoring, before in ISO/TS 15066) and ISO 13855:2024, as the literature gives
them: texts of standards are not free, check them there before relying on this.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from elbowroom.errors import InputError

WALKING_M_S = 1.6
"""How fast people are taken to walk where nobody measured it (ISO 13855, ISO 10218-2) [m/s]."""
REACHING_M_S = 2.0
"""How fast a hand is taken to reach out where it may be near (ISO 13855) [m/s]."""
WALKING_FROM_M = 0.5
"""From this distance on the walking speed is the one that counts (ISO 13855) [m]."""
ARM_M = 0.85
"""How far a person reaches before a body is noticed, where hands are too small to be: an arm (ISO 13855) [m]."""
HAND_M = 0.04
"""Up to this detection capability a hand is noticed, and less is reached beyond (ISO 13855) [m]."""


@dataclass(frozen=True, slots=True)
class Separation:
    """The figures of a site that separation distances are made of.

    Args:
        speeds_m_s: by link, the greatest speed of any of its points.
        stopping_m: by link, the way of any of its points while the machine brakes [m].
        stopping_time_s: until the machine stands, from the beginning of braking [s].
        walking_m_s, reaching_m_s: how fast people and their hands come near.
        intrusion_m: C and D_DS: how far somebody reaches before being noticed [m].
        person_m, machine_m: Z_d and Z_r: by how much it is not known where a person is, and the machine [m].

    Raises:
        InputError: a speed that is not above 0, or another figure below 0 or not a number.
    """

    speeds_m_s: Mapping[str, float] = field(default_factory=dict)
    stopping_m: Mapping[str, float] = field(default_factory=dict)
    stopping_time_s: float = 0.0
    walking_m_s: float = WALKING_M_S
    reaching_m_s: float = REACHING_M_S
    intrusion_m: float = ARM_M
    person_m: float = 0.0
    machine_m: float = 0.0

    def __post_init__(self) -> None:
        for name in ("walking_m_s", "reaching_m_s"):
            if not (np.isfinite(getattr(self, name)) and getattr(self, name) > 0):
                raise InputError(
                    f"separation: {name} is {getattr(self, name)}, must be a finite number above 0"
                )
        for name in ("stopping_time_s", "intrusion_m", "person_m", "machine_m"):
            if not (np.isfinite(getattr(self, name)) and getattr(self, name) >= 0):
                raise InputError(
                    f"separation: {name} is {getattr(self, name)}, must be a finite number of 0 or more"
                )

    def person_way_m(self, reaction_s: float) -> float:
        """S_h = v_h (T_r + T_s): what a person walks until the machine stands [m]."""
        return self.walking_m_s * (reaction_s + self.stopping_time_s)

    def reaction_way_m(self, link: str, reaction_s: float) -> float:
        """S_r = v_r T_r: the way of a link until it begins to brake [m].

        Args:
            link: its name.
            reaction_s: T_r [s].
        """
        return self.speeds_m_s[link] * reaction_s

    def from_standing_m(self, link: str, reaction_s: float) -> float:
        """S_r + S_s + Z_d + Z_r: what has to lie between a link and what stands still [m].

        Args:
            link: its name.
            reaction_s: T_r [s].
        """
        way = self.reaction_way_m(link, reaction_s) + self.stopping_m[link]
        return way + self.person_m + self.machine_m

    def from_person_m(self, link: str, reaction_s: float) -> float:
        """S_p = S_h + S_r + S_s + C + Z_d + Z_r: what has to lie between a link and a person who comes near [m].

        Args:
            link: its name.
            reaction_s: T_r [s].
        """
        return self.from_standing_m(link, reaction_s) + self.person_way_m(reaction_s) + self.intrusion_m

    def fixed_m(self, reaction_s: float, speed_m_s: float) -> float:
        """S = K T + D_DS + Z of ISO 13855: from where a person is noticed to where the machine may be [m].

        Args:
            reaction_s: T_r [s]; T is that and the stopping time.
            speed_m_s: K.
        """
        still = self.intrusion_m + self.person_m + self.machine_m
        return speed_m_s * (reaction_s + self.stopping_time_s) + still

    def required_fixed_m(self, reaction_s: float) -> float:
        """By K for hands; where that is more than half a metre, by K for bodies, but at least half a metre [m].

        Args:
            reaction_s: T_r [s].
        """
        reaching = self.fixed_m(reaction_s, self.reaching_m_s)
        if reaching <= WALKING_FROM_M:
            return reaching
        return max(WALKING_FROM_M, self.fixed_m(reaction_s, self.walking_m_s))


def intrusion_of(capability_m: float) -> float:
    """How far somebody reaches unnoticed: 8 (d - 14 mm) where hands are noticed, else an arm (ISO 13855) [m].

    Args:
        capability_m: d, the smallest thing that is surely noticed, across [m].
    """
    return max(0.0, 8 * (capability_m - 0.014)) if capability_m <= HAND_M else ARM_M
