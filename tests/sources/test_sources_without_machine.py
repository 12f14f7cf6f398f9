"""A recording from before its machine was installed: by the site's word alone, and never with a gate."""

import pytest

from elbowroom.errors import InputError
from elbowroom.monitor.gate.made import gate_of
from elbowroom.site import Site
from elbowroom.site.notes import notes_of
from elbowroom.sources import open_room

JOINTS = {"turn": 0.1, "slide": 0.0}


@pytest.fixture
def room_of(folder, plain, arm_urdf):
    """Opens the room, as a key of its recording says, with joints or without."""

    def opened(joints=None, **recording):
        for camera in ("north", "south"):
            folder.image(f"recording/{camera}/1000000000.png")
        speeds = {"turn": {"max_speed_deg_s": 10, "braking_time_s": 0.2}}
        content = plain | {"machine": {"urdf": str(arm_urdf)}, "joints": speeds}
        content["recording"] = {"layout": "folder", "folder": "recording"} | recording
        return open_room(Site.load(folder.write(content)), joints=joints)

    return opened


def test_without_the_word_there_must_be_joints(room_of):
    with pytest.raises(InputError, match=r"joints\.csv"):
        room_of().snapshot(0)


def test_by_the_word_it_needs_none_and_whoever_asks_for_a_motion_says_where(room_of):
    room = room_of(without_machine=True)
    snapshot = room.snapshot(0)
    assert snapshot.joints is None
    with pytest.raises(InputError, match="--joints"):
        room.placed(snapshot)
    assert room_of(JOINTS, without_machine=True).snapshot(0).joints == JOINTS


def test_it_stands_in_every_summary(room_of):
    room = room_of(without_machine=True)
    assert any("recording.without_machine" in note for note in notes_of(room.site))
    assert any("recording.without_machine" in line for line in room.allowances)
    assert room_of().allowances == ()


def test_it_lets_no_machine_move(room_of, tmp_path):
    with pytest.raises(InputError, match="without_machine"):
        gate_of(room_of(JOINTS, without_machine=True), tmp_path / "gate")
