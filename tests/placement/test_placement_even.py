"""Cameras evenly along the walls, and the curve over their number."""

import numpy as np
import pytest

from elbowroom.errors import InputError
from elbowroom.geometry import VoxelGrid
from elbowroom.placement.even import best_aim, even_cameras, sweep
from elbowroom.placement.fixed_room import FixedRoom
from elbowroom.placement.requirement import Requirement
from elbowroom.placement.sensor import known_sensors
from elbowroom.simulate import Walls, wall_cameras
from reference.placement_rooms import room_of

COARSE = VoxelGrid((-2.0, -2.0, 0.0), (16, 16, 10), 0.25)


def test_in_a_square_room_they_hang_where_the_simulators_cameras_hang():
    made = even_cameras(room_of().walls_m, known_sensors()["vga"], 21, heights_m=(2.4, 0.4), aim_m=1.1)
    for one, other in zip(made, wall_cameras(21, (2.4, 0.4), walls=Walls(half_side_m=2.49)), strict=True):
        assert one.name == other.name
        np.testing.assert_allclose(one.world_from_camera, other.world_from_camera, atol=1e-12)


def test_in_a_long_room_they_keep_equal_distances_along_the_walls():
    walls = np.array([[0.0, -1.0, 0.0], [6.0, 1.0, 3.0]])
    eyes = np.array([c.centre_in_world for c in even_cameras(walls, known_sensors()["vga"], 16)])
    assert (eyes[:, :2] > walls[0, :2]).all() and (eyes[:, :2] < walls[1, :2]).all()
    steps = np.abs(np.diff(np.concatenate([eyes, eyes[:1]]), axis=0)).sum(axis=1)
    np.testing.assert_allclose(steps, steps[0])


def test_known_sensors_are_90_degrees_wide_and_the_thesis_one_ends_at_7_m():
    for sensor in known_sensors().values():
        half_px, focal_px = sensor.camera.width / 2, sensor.camera.intrinsics.fx
        assert np.degrees(2 * np.arctan(half_px / focal_px)) == pytest.approx(90.0)
    thesis = known_sensors()["thesis"].camera
    assert (thesis.width, thesis.height, thesis.max_depth_m, thesis.depth_kind) == (64, 48, 7.0, "radial")


def test_half_a_metre_to_the_walls_is_worth_more_than_nineteen_cameras():
    """With walls at the edge of the watched box 40 cameras leave more points invalid than 21 do half a metre out."""
    sensor = known_sensors()["thesis"]
    near = room_of(walls={"lower_m": [-2.0, -2.0, 0.0], "upper_m": [2.0, 2.0, 2.9]})
    at_edge = sweep(COARSE, near, sensor, [40], aim_m=0.6)
    farther = sweep(COARSE, room_of(), sensor, [12, 21], aim_m=0.4)
    assert at_edge.valid_pct[0] < 85 < farther.valid_pct[0] < farther.valid_pct[1]
    assert farther.valid_pct[1] > 97
    assert farther.least(97.0) == 21 and farther.least(100.0) is None
    assert farther.seen_pct[1] >= farther.valid_pct[1]


def test_the_aim_is_the_best_of_those_tried():
    sensor, room = known_sensors()["thesis"], room_of()
    aims = (0.4, 1.2)
    shares = [sweep(COARSE, room, sensor, [9], aim_m=aim).valid_pct[0] for aim in aims]
    assert best_aim(COARSE, room, sensor, Requirement(), count=9, aims_m=aims) == aims[int(np.argmax(shares))]


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (lambda: sweep(COARSE, room_of(), known_sensors()["vga"], []), "no numbers of cameras"),
        (lambda: sweep(COARSE, FixedRoom(), known_sensors()["vga"], [3]), "no walls to spread cameras along"),
        (lambda: even_cameras(room_of().walls_m, known_sensors()["vga"], 0), "0 cameras"),
        (lambda: even_cameras(room_of().walls_m, known_sensors()["vga"], 3, heights_m=()), "no height"),
    ],
)
def test_bad_input_is_one_line(call, words):
    with pytest.raises(InputError, match=words):
        call()
