import numpy as np
import pytest

from elbowroom.errors import InputError
from elbowroom.evaluate.rooms.exact import ExactTravel
from elbowroom.evaluate.thesis.thesis import sensor_cameras
from elbowroom.geometry import VoxelGrid
from elbowroom.machine.c_arm import ceiling_c_arm
from elbowroom.simulate import SETUPS, setup, true_occupancy
from elbowroom.simulate.inside import check_outside, winding_number
from elbowroom.simulate.shapes import box, join
from elbowroom.simulate.solid import Solid
from elbowroom.simulate.truth import true_centres

MUST_STAND_THERE = (
    "table",
    "patient skin",
    "doctor gown",
    "nurse 1 gown",
    "nurse 2 gown",
    "monitors",
    "lamp",
)


@pytest.fixture(scope="module")
def machine():
    return ceiling_c_arm()


def test_the_thesis_asked_35_movements():
    assert [len(s.movements) for s in SETUPS] == [8, 4, 5, 7, 9, 2]
    assert sum(s.path.stat().st_size for s in SETUPS) <= 10e6


def test_the_verdicts_of_the_thesis_are_those_it_counts():
    printed = [m.thesis_verdict for s in SETUPS for m in s.movements]
    assert (printed.count("s"), printed.count("ts") + printed.count("tts"), printed.count("u")) == (27, 6, 2)


@pytest.mark.parametrize("number", range(1, 7))
def test_a_setup_has_all_that_the_thesis_names_and_no_camera_is_inside_any(number, machine):
    scene = setup(number)
    names = {solid.name for solid in scene.solids()}
    assert names >= {*MUST_STAND_THERE, "cabinet", "open shelf", "cart", "drape", "cables"}
    check_outside(sensor_cameras("64x48"), scene.at(machine).solids)


@pytest.mark.parametrize("number", range(1, 7))
def test_the_machine_touches_nothing_before_any_movement(number, machine):
    pytest.importorskip("coal", reason="coal is not installed; exact mesh distance is left out")
    scene = setup(number)
    truth = ExactTravel(machine, scene.solids())
    assert all(truth.gap(scene.joints_before(movement), 0.02) > 0.01 for movement in scene.movements)


def test_a_second_step_begins_where_the_first_ended():
    scene = setup(5)
    moved = {m.name: scene.joints_before(m)["long"] - scene.joints["long"] for m in scene.movements}
    assert moved["2 x Long"] == moved["Long - Prop"] == pytest.approx(moved["2 x Long - Prop"] / 2)
    assert moved["Prop"] == 0


def test_an_unknown_setup_names_those_that_are_known():
    assert setup("setup3") is setup(3)
    with pytest.raises(InputError, match="setup6"):
        setup(7)


def test_winding_number_tells_inside_from_outside():
    solid = Solid("box", join([box((0, 0, 0), (1, 1, 1))]), np.eye(4))
    assert winding_number(solid, np.array([0.5, 0.4, 0.6])) == pytest.approx(1)
    assert winding_number(solid, np.array([1.5, 0.4, 0.6])) == pytest.approx(0, abs=1e-9)


def test_a_camera_in_a_cabinet_is_named():
    camera = sensor_cameras("64x48", count=1)[0]
    cabinet = Solid(
        "cabinet", join([box(camera.centre_in_world - 0.1, camera.centre_in_world + 0.1)]), np.eye(4)
    )
    with pytest.raises(InputError, match=r"cam00.*inside 'cabinet'"):
        check_outside([camera], [cabinet])


def test_a_voxel_whose_centre_is_in_a_solid_is_touched(machine):
    grid = VoxelGrid.covering((-2, -2, 0), (2, 2, 2.5), 0.1)
    moment = setup(2).at(machine)
    centres, touched = true_centres(grid, moment), true_occupancy(grid, moment).occupied
    assert centres.any() and not (centres & ~touched).any()
    assert centres.sum() < touched.sum()
