"""What people type becomes numbers, or one line that says what to type."""

import json
import math
import pickle

import pytest
from hypothesis import given
from hypothesis import strategies as st

from elbowroom.cli.options import parse_direction, parse_joints, parse_resolution, use_threads
from elbowroom.errors import InputError, MachineError
from reference.contact_machines import BASE, SWING, joint, link
from reference.contact_machines import machine as made_of


@given(st.dictionaries(st.sampled_from(["long", "larm", "joint_1"]), st.floats(-1e3, 1e3), min_size=1))
def test_joints_are_read_back_as_they_were_written(joints):
    assert parse_joints(",".join(f"{name}={value!r}" for name, value in joints.items())) == joints


def test_joints_may_carry_a_unit():
    given_joints = parse_joints("long=120mm, larm = -12deg,carc=0.2 rad,rail=1m")
    assert given_joints == pytest.approx({"long": 0.12, "larm": -math.radians(12), "carc": 0.2, "rail": 1.0})


def test_no_joints_are_none():
    assert parse_joints(None) is None


@pytest.mark.parametrize(
    "text", ["", "long", "long=", "=1", "long=1,,", "long=nan", "long=inf", "long=1ft", "long=.", "a=1e999"]
)
def test_joints_that_are_none_are_named(text):
    with pytest.raises(InputError, match=r"--joints: .* write name=value"):
        parse_joints(text)


def test_resolution_is_width_and_height():
    assert parse_resolution("160x120") == (160, 120)


@pytest.mark.parametrize("text", ["160", "x120", "0x4", "160x-1", "1e3x4", "160x120x3"])
def test_what_is_no_resolution_is_named(text):
    with pytest.raises(InputError, match=r"--resolution: .* such as 160x120"):
        parse_resolution(text)


def test_direction_is_a_sign():
    assert [parse_direction(text) for text in ("+", "-", "+1", "-1")] == [1, -1, 1, -1]
    with pytest.raises(InputError, match="allowed are \\+ and -"):
        parse_direction("up")


@pytest.mark.parametrize("count", [0, 100_000])
def test_threads_that_are_not_there_are_refused(count):
    with pytest.raises(InputError, match="this process may use 1 to"):
        use_threads(count)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("turn=900mm", "joint turn: 900mm cannot be its position: it turns; write rad or deg"),
        ("turn=0.1m", "joint turn: 0.1m cannot"),
        ("slide=30deg", "joint slide: 30deg cannot be its position: it slides; write m or mm"),
        ("slide=0.1 rad", "joint slide: 0.1rad cannot"),
    ],
)
def test_a_position_in_the_unit_of_another_kind_of_joint_is_refused(machine, text, words):
    rest = {"turn": 0.0, "slide": 0.0}
    with pytest.raises(MachineError, match=words):
        machine.checked(rest | parse_joints(text))


@given(st.floats(-100, 100))
def test_a_position_in_its_own_unit_is_taken(machine, value):
    typed = parse_joints(f"turn={value!r}deg,slide={value!r}mm")
    found = machine.positions(typed)
    assert found == pytest.approx([math.radians(value), value / 1e3])
    # and it is copied and written as the number that it is
    copied = pickle.loads(pickle.dumps(typed))
    assert copied == typed and json.loads(json.dumps(typed)) == typed
    with pytest.raises(MachineError, match="cannot be its position"):
        machine.positions({"turn": copied["slide"], "slide": 0.0})


@pytest.fixture(scope="module")
def machine(tmp_path_factory):
    return made_of(
        tmp_path_factory.mktemp("machine"),
        BASE,
        *SWING,
        link("hand", (0.1, 0.1, 0.1)),
        joint("slide", "swing", "hand", (0.6, 0, 0), kind="prismatic"),
    )
