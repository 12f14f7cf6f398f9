"""Links are named by their names, whatever these hold, or by wildcards; joints by whom they follow."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from elbowroom.errors import MachineError
from elbowroom.machine.names import is_named, named_by
from elbowroom.machine.own_links import OwnLinks
from elbowroom.motion.contacts import is_allowed
from reference.contact_machines import BASE, POST, SWING, joint, link, machine

NAMES = st.text("ab[]!-*?", min_size=1, max_size=5)


@given(NAMES, st.lists(NAMES))
def test_a_links_own_name_always_names_it(name, others):
    assert is_named(name, name) and name in named_by(name, [*others, name])


def with_brackets(folder, *more):
    return machine(
        folder,
        BASE,
        link("arm[1]", (0.45, 0.05, 0.05), (0.25, 0, 0)),
        joint("turn", "base", "arm[1]", (0, 0, 0.1)),
        *POST,
        *more,
    )


def test_a_link_with_brackets_in_its_name_can_be_named(tmp_path):
    made = with_brackets(tmp_path).allowing(("arm[1]", "post"))
    assert is_allowed(made, "post", "arm[1]") and not is_allowed(made, "base", "arm[1]")


def test_a_name_that_stands_for_other_links_as_well_is_refused(tmp_path):
    other = link("arm1", (0.1, 0.1, 0.1)), joint("f", "base", "arm1", (0, 0, 1), kind="fixed")
    made = with_brackets(tmp_path, *other)
    with pytest.raises(MachineError, match=r"'arm\[1\]' is a link, and stands for arm1 as well"):
        made.allowing(("arm[1]", "post"))


def test_of_a_follower_it_is_said_whom_it_follows(tmp_path):
    mimic = joint("nod", "swing", "hand", (0.6, 0, 0)).replace("</joint>", '<mimic joint="turn"/></joint>')
    made = machine(tmp_path, BASE, *SWING, link("hand", (0.1, 0.1, 0.1)), mimic)
    assert made.leader_of("nod") == "turn" and made.leader_of("turn") is None
    with pytest.raises(MachineError, match="no joint 'nod' that is commanded: it follows turn"):
        made.joint("nod")


def test_an_srdf_that_is_xacro_yet_is_refused(tmp_path):
    path = tmp_path / "arm.srdf"
    path.write_text(
        '<robot name="arm"><disable_collisions link1="base" link2="${prefix}hand" reason="Never"/></robot>'
    )
    with pytest.raises(MachineError, match=r"line 1: link '\$\{prefix\}hand': the file is xacro"):
        OwnLinks.from_srdf(path)
    path.write_text(path.read_text().replace("${prefix}", ""))
    assert "names no two of its links" in OwnLinks.from_srdf(path).among(["post"]).said
