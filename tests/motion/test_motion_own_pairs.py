"""Which pairs of links need not be compared: by poses between the joints' limits, wherever these lie."""

import pytest

from elbowroom.machine import Machine
from elbowroom.motion.contacts import pairs_of
from elbowroom.motion.own_pairs import found_pairs
from reference.contact_machines import link


def gantry(folder, limit, kind="prismatic", post=6):
    """A carriage on a rail with a tool that turns, and a post beside the rail."""
    path = folder / "gantry.urdf"
    joint = (
        '<joint name="{0}" type="{1}"><parent link="{2}"/><child link="{3}"/><origin xyz="{4}"/>{5}</joint>'
    )
    parts = [
        link("rail", (8, 0.1, 0.1), (4, 0, 0)),
        link("post", (0.2, 0.2, 0.6), (post, 0.5, 0.3)),
        link("car", (0.2, 0.2, 0.2), (0, 0, 0.2)),
        link("tool", (0.7, 0.1, 0.1), (0.35, 0, 0)),
        joint.format("stands", "fixed", "rail", "post", "0 0 0", ""),
        joint.format("x", kind, "rail", "car", "0 0 0", f'<axis xyz="1 0 0"/>{limit}'),
        joint.format("turn", "continuous", "car", "tool", "0 0 0.4", '<axis xyz="0 0 1"/>'),
    ]
    path.write_text(f'<robot name="gantry">{"".join(parts)}</robot>')
    return Machine.from_urdf(path)


def names(machine):
    return {
        frozenset((machine.link_names[a], machine.link_names[b]))
        for bodies in [pairs_of(machine.anywhere).bodies]
        for a, b in zip(bodies.one, bodies.other, strict=True)
    }


@pytest.mark.parametrize("limits", [(0, 8), (4, 8), (-8, 8)])
def test_links_that_meet_far_out_on_a_rail_are_not_called_never(tmp_path, limits):
    machine = gantry(tmp_path, '<limit lower="{}" upper="{}" effort="1" velocity="1"/>'.format(*limits))
    never = {frozenset(pair) for pair in found_pairs(machine, 500)["never"]}
    assert frozenset(("post", "tool")) not in never
    assert frozenset(("post", "tool")) in names(machine)


def test_links_that_a_rail_never_brings_together_are_called_never(tmp_path):
    machine = gantry(tmp_path, '<limit lower="0" upper="4" effort="1" velocity="1"/>')
    assert ("post", "tool") in found_pairs(machine, 300)["never"]


def test_no_pair_across_a_slide_without_end_is_called_never(tmp_path):
    machine = gantry(tmp_path, '<limit lower="-1e5" upper="1e5" effort="1" velocity="1"/>', post=15)
    found = found_pairs(machine, 300)["never"]
    assert not any(set(pair) & {"car", "tool"} and set(pair) & {"post"} for pair in found)


def test_a_joint_that_turns_beyond_half_a_turn_alone_has_poses(tmp_path):
    limit = '<limit lower="3.3" upper="6.2" effort="1" velocity="1"/>'
    machine = gantry(tmp_path, limit, "revolute")
    assert frozenset(("post", "tool")) in names(machine)
    assert found_pairs(machine, 100)
