"""What a knock means, where it meets, and when."""

import numpy as np
import pytest

from elbowroom.errors import InputError
from elbowroom.simulate import wall_cameras
from elbowroom.simulate.knock import Knock, PlacedKnocks, reported_joints, require_known

CAMERAS = wall_cameras(3, size="thesis")


@pytest.mark.parametrize(
    ("text", "turn_deg", "move_m", "at_s"),
    [
        ("cam01:1deg@5", (0, 1, 0), (0, 0, 0), 5),
        ("cam01:-0.5degz@0.5", (0, 0, -0.5), (0, 0, 0), 0.5),
        ("cam01:20mm@2", (0, 0, 0), (0.02, 0, 0), 2),
        (" cam01:2cmz ", (0, 0, 0), (0, 0, 0.02), 0),
    ],
)
def test_a_knock_is_read_as_it_is_written(text, turn_deg, move_m, at_s):
    knock = Knock.parse(text)
    assert knock.what == "cam01" and knock.at_s == at_s
    assert np.degrees(knock.turn_rad) == pytest.approx(turn_deg) and knock.move_m == pytest.approx(move_m)


@pytest.mark.parametrize(
    "text", ["", "cam01", "cam01:1", "cam01:1rad@5", "cam01:deg", "cam01:1deg@", "cam01:1..2deg@5", ":1deg@5"]
)
def test_what_is_no_knock_is_refused_in_one_line(text):
    with pytest.raises(InputError, match="is no knock") as caught:
        Knock.parse(text)
    assert "\n" not in str(caught.value)


def test_a_knock_of_nothing_names_what_there_is():
    require_known([Knock("cam01"), Knock("larm")], CAMERAS, ("larm",))
    with pytest.raises(InputError, match=r"'cam9'.*cam00.*larm"):
        require_known([Knock("cam9")], CAMERAS, ("larm",))


def test_the_camera_is_elsewhere_from_its_time_on_and_the_others_stay():
    knocks = [Knock.parse("cam01:1deg@5"), Knock.parse("cam01:2deg@8"), Knock.parse("larm:3deg@5")]
    placed = PlacedKnocks(knocks, CAMERAS)
    assert placed.cameras(4.9) == CAMERAS
    for time_s, angle_deg in ((5.0, 1.0), (9.0, 2.0)):
        now = placed.cameras(time_s)
        assert now[0] is CAMERAS[0] and now[2] is CAMERAS[2]
        old_from_new = CAMERAS[1].camera_from_world @ now[1].world_from_camera
        assert np.degrees(np.arccos((np.trace(old_from_new[:3, :3]) - 1) / 2)) == pytest.approx(angle_deg)
        assert placed.cameras(time_s)[1] is now[1]
    assert reported_joints(knocks, {"larm": 1.0, "long": 2.0}, 4.0) == {"larm": 1.0, "long": 2.0}
    assert reported_joints(knocks, {"larm": 1.0, "long": 2.0}, 5.0) == {
        "larm": 1.0 - np.radians(3),
        "long": 2.0,
    }
