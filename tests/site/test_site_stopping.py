"""How the machine stops, as a site says it."""

import math

import pytest

from elbowroom.errors import SiteError
from elbowroom.machine.c_arm import ceiling_c_arm
from elbowroom.site.machine_entry import JointEntry, StoppingEntry, braking_of, motions_of

TURNS = {"max_speed_deg_s": 12.0, "braking_time_s": 0.5}


def test_reaction_and_clearance_come_to_the_motions_and_to_the_brakes():
    machine, joints = ceiling_c_arm(), {"larm": JointEntry(**TURNS, clearance_deg=1.5)}
    for motion in motions_of(machine, joints, 0.12):
        assert motion.reaction_distance == pytest.approx(math.radians(12) * 0.12)
        assert motion.clearance == pytest.approx(math.radians(1.5))
    braking = braking_of(machine, joints, StoppingEntry(reaction_time_ms=120, leaves_path=False))
    assert (braking.reaction_time_s, braking.leaves_path) == (0.12, False)
    assert braking.times_s == {"larm": 0.5}
    assert StoppingEntry().leaves_path


def test_a_clearance_in_the_unit_of_another_kind_of_joint_is_refused():
    with pytest.raises(SiteError, match="clearance of larm is written clearance_deg"):
        motions_of(ceiling_c_arm(), {"larm": JointEntry(**TURNS, clearance_mm=5)})
