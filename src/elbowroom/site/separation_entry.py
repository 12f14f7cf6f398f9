"""What a site file says of separation distances: how people move, and what no monitor can measure."""

from typing import Annotated

from elbowroom.motion.separation import REACHING_M_S, WALKING_M_S
from elbowroom.site.entry import Entry, NotNegative, Positive
from elbowroom.site.ranges import KM_AN_HOUR, MILLIMETRES, MM_A_SECOND, SECONDS, between, up_to


class SeparationEntry(Entry):
    """Figures for ISO 10218-2 and ISO 13855; what is left out is as `elbowroom budget` says it.

    `command_ms` is what lies between the decision and the first braking torque: the receiver's poll, the machine's
    control. `reaction_ms` is a reaction time that somebody vouches for; what is measured to be more counts. `look_m` is
    how far from the machine is looked; left out, its stopping distance.
    """

    walking_m_s: Annotated[Positive, between(0.1, 10, "m/s", MM_A_SECOND, KM_AN_HOUR)] = WALKING_M_S
    reaching_m_s: Annotated[Positive, between(0.1, 10, "m/s", MM_A_SECOND, KM_AN_HOUR)] = REACHING_M_S
    intrusion_mm: Annotated[NotNegative, up_to(5000, "mm")] | None = None
    person_uncertainty_mm: Annotated[NotNegative, up_to(1000, "mm")] | None = None
    machine_uncertainty_mm: Annotated[NotNegative, up_to(1000, "mm")] | None = None
    command_ms: Annotated[NotNegative, up_to(10_000, "ms")] | None = None
    reaction_ms: Annotated[Positive, between(1, 10_000, "ms", SECONDS)] | None = None
    look_m: Annotated[Positive, between(0.01, 10, "m", MILLIMETRES)] | None = None
