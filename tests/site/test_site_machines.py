"""Several machines of one site: what an entry says is said of its own machine, or the most careful counts for all."""

import math

import numpy as np
import pytest
import yaml
from hypothesis import given
from hypothesis import strategies as st

from elbowroom.errors import MachineError
from elbowroom.site import Site
from elbowroom.site.notes import notes_of
from reference.contact_machines import BASE, POST, SWING

ROOM = {
    "grid": {"origin_m": [-1, -1, -1], "upper_m": [3, 1, 1], "voxel_size_m": 0.1},
    "simulated": {"cameras": 4, "resolution": "64x48"},
}
USUAL_M = 0.01


def site(folder, *entries, apart_m=2.0, **keys):
    """A site of two arms with posts, each with keys of its own."""
    (folder / "arm.urdf").write_text(f'<robot name="arm">{"".join((BASE, *SWING, *POST))}</robot>')
    machines = []
    for n, (name, more) in enumerate(zip(("left", "right"), entries, strict=True)):
        pose = np.eye(4)
        pose[0, 3] = n * apart_m
        machines.append(
            {"name": name, "urdf": "arm.urdf", "joint_prefix": f"{name}_", "world_from_base": pose.tolist()}
            | more
        )
    path = folder / "site.yaml"
    path.write_text(yaml.safe_dump(ROOM | {"machines": machines} | keys))
    return Site.load(path)


VALUES = st.none() | st.floats(0.001, 0.4)


@given(VALUES, VALUES)
def test_no_machine_is_explained_more_widely_than_it_would_be_alone(tmp_path_factory, left, right):
    entries = [{} if value is None else {"explain_tolerance_m": value} for value in (left, right)]
    folder = tmp_path_factory.mktemp("site")
    assert site(folder, *entries).explain_tolerance_m == min(
        USUAL_M if value is None else value for value in (left, right)
    )


def test_a_tolerance_that_has_no_effect_is_a_note(tmp_path):
    notes = notes_of(site(tmp_path, {"explain_tolerance_m": 0.05}, {}))
    assert any("explain_tolerance_m: left 0.05 m have no effect" in note for note in notes)
    assert not any("no effect" in note for note in notes_of(site(tmp_path, {}, {})))


def test_each_joint_has_the_tolerance_of_its_machine(tmp_path):
    machine = site(tmp_path, {"limit_tolerance_deg": 10}, {}).machine()
    beyond = 3 + math.radians(5)
    assert machine.checked({"left_turn": beyond, "right_turn": 0.0})["left_turn"] == beyond
    with pytest.raises(MachineError, match=r"right_turn: .* out of its limits"):
        machine.checked({"left_turn": 0.0, "right_turn": beyond})
    assert not site(tmp_path, {}, {}).machine().tolerance.own


@pytest.mark.parametrize("apart_m", [0.0, 0.05, 2.0])
def test_machines_that_stand_in_each_other_are_a_note(tmp_path, apart_m):
    notes = notes_of(site(tmp_path, {}, {}, apart_m=apart_m))
    said = [note for note in notes if "lie in each other" in note]
    assert len(said) == (apart_m < 1)
    if said:
        assert "left/base and right/base" in said[0] and "world_from_base" in said[0]


def test_a_machine_whose_base_stands_within_anothers_is_a_note_unless_it_is_allowed(tmp_path):
    small = BASE.replace("0.1 0.1 0.1", "0.02 0.02 0.02")
    (tmp_path / "small.urdf").write_text(f'<robot name="small">{small}</robot>')
    notes = notes_of(site(tmp_path, {}, {"urdf": "small.urdf"}, apart_m=0.0))
    assert any("in each other in nearly all poses: left/base and right/base;" in note for note in notes)
    allowed = {"allowed_contacts": [["left/base", "right/base"]]}
    notes = notes_of(site(tmp_path, {}, {"urdf": "small.urdf"}, apart_m=0.0, **allowed))
    assert not any("in each other" in note for note in notes)
