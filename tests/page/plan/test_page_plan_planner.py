import math

import numpy as np
import pytest

from elbowroom.errors import InputError
from elbowroom.page.plan.furniture import MOST_BYTES, kinds, thing_of, thing_of_file
from elbowroom.page.plan.ground import OWN
from elbowroom.page.plan.planner import Planner
from elbowroom.page.plan.room_file import write_room
from elbowroom.page.plan.sensor_choice import choice_of, field_of
from elbowroom.simulate.shapes import box, join
from elbowroom.simulate.solid import Solid


@pytest.fixture
def planner(ground) -> Planner:
    return Planner(ground)


def glb(tmp_path, scale: float = 1.0) -> bytes:
    chair = Solid("chair", join([box((0, 0, 0), (0.5 * scale, 0.5 * scale, 0.9 * scale))]), np.eye(4))
    return write_room([chair], tmp_path / "chair.glb").read_bytes()


def test_the_first_layout_is_the_sites(planner) -> None:
    assert planner.layout.camera_names == ("a", "b", "c", "d")
    assert {placed.sensor for placed in planner.layout.cameras} == {"small"}
    assert not planner.history.can_undo


def test_every_deed_can_be_undone(planner, tmp_path) -> None:
    first = planner.layout
    pose = first.camera("a").camera.world_from_camera.copy()
    pose[0, 3] = 0.3
    planner.place_camera("a", pose)
    planner.aim_camera("a", (0.5, 0.5, 0.5))
    planner.add_camera("wide")
    planner.remove_camera("b")
    planner.choose_sensor("a", "wide")
    planner.tune_camera("a", type(choice_of(first.cameras[0].camera))("tof", (160, 120), 70.0))
    planner.add_person()
    for kind in kinds():
        planner.add_thing(kind)
    planner.add_file("chair.glb", glb(tmp_path))
    planner.move("chair 1", (0.1, 0.2), 0.5)
    planner.remove("person 1")
    while planner.history.can_undo:
        planner.undo()
    assert planner.layout is first


def test_a_new_camera_hangs_far_from_the_others_and_looks_at_the_middle(planner) -> None:
    name = planner.add_camera("wide")
    camera = planner.layout.camera(name).camera
    away = [np.linalg.norm(camera.centre_in_world - other.camera.centre_in_world)
            for other in planner.layout.cameras if other.name != name]  # fmt: skip
    assert min(away) > 0.7
    to_middle = -camera.centre_in_world + (0, 0, 0.38 * 2.2)
    assert camera.world_from_camera[:3, 2] @ to_middle == pytest.approx(np.linalg.norm(to_middle))
    assert planner.add_camera("wide") != name


def test_what_is_chosen_of_a_camera_is_what_it_is(planner) -> None:
    was = choice_of(planner.layout.camera("a").camera)
    assert (was.noise, was.size_px) == ("exact", (64, 48)) and was.field_deg == pytest.approx(90)
    assert planner.layout.camera("a").sensor == "small"
    planner.tune_camera("a", type(was)("realsense_d435", (320, 240), 60.0))
    placed = planner.layout.camera("a")
    assert choice_of(placed.camera).noise == "realsense_d435"
    assert choice_of(placed.camera).size_px == (320, 240)
    assert field_of(placed.camera) == pytest.approx(60.0)
    assert placed.sensor == "small" and placed.camera.max_depth_m == 5.0
    np.testing.assert_allclose(
        placed.camera.world_from_camera, planner.history.undo().camera("a").camera.world_from_camera
    )


def test_choosing_what_is_already_so_changes_no_bit(planner) -> None:
    before = planner.layout.camera("b").camera
    planner.tune_camera("b", choice_of(before))
    after = planner.layout.camera("b").camera
    assert after.intrinsics == before.intrinsics and after.noise == before.noise


def test_a_camera_that_is_no_sensor_of_the_site_is_its_own_kind(ground, planner) -> None:
    planner.tune_camera("a", type(choice_of(planner.layout.cameras[0].camera))("exact", (100, 80), 90.0))
    assert ground.kind_of(planner.layout.camera("a").camera) == OWN


@pytest.mark.parametrize(
    ("deed", "word"),
    [
        (lambda p: p.remove_camera("z"), "z"),
        (lambda p: p.choose_sensor("a", "none"), "sensor"),
        (lambda p: p.add_camera("none"), "sensor"),
        (lambda p: p.aim_camera("a", tuple(p.layout.camera("a").camera.centre_in_world)), "direction"),
        (lambda p: p.place_camera("a", np.full((4, 4), np.nan)), "near"),
        (lambda p: p.move("nobody", (0, 0), 0), "nobody"),
        (lambda p: p.move_joint("larm", 0.1), "no machine"),
        (lambda p: p.add_thing("sofa"), "sofa"),
        (lambda p: p.add_file("a.exe", b""), "a.exe"),
        (lambda p: p.add_file("big.glb", bytes(MOST_BYTES + 1)), "30 MB"),
        (lambda p: p.add_file("broken.glb", b"glTF" + bytes(50)), "broken.glb"),
        (lambda p: p.add_file("cut.obj", b"v 0 0"), "cut.obj"),
    ],
)
def test_what_cannot_be_done_is_said_and_changes_nothing(planner, deed, word) -> None:
    before, told = planner.layout, []
    planner.on_change = told.append
    with pytest.raises(InputError, match=word):
        deed(planner)
    assert planner.layout is before and not planner.history.can_undo and not told


def test_a_file_stands_on_the_floor_where_it_was_put(planner, tmp_path) -> None:
    name = planner.add_file("chair.glb", glb(tmp_path))
    planner.move(name, (0.25, -0.5), math.pi / 2)
    (solid,) = planner.layout.thing(name).solids()
    lower, upper = solid.vertices_in_world.min(axis=0), solid.vertices_in_world.max(axis=0)
    np.testing.assert_allclose(lower, (0.0, -0.75, 0.0), atol=1e-6)
    np.testing.assert_allclose(upper, (0.5, -0.25, 0.9), atol=1e-6)


def test_a_file_in_millimetres_is_refused(tmp_path) -> None:
    with pytest.raises(InputError, match="mesh_unit_m"):
        thing_of_file("chair.glb", glb(tmp_path, 1000.0), "chair 1")


def test_furniture_of_the_package_is_solid(ground) -> None:
    for kind in kinds():
        thing = thing_of(kind, "one")
        assert all(solid.is_static and solid.has_inside for solid in thing.solids()), kind


def test_whoever_listens_hears_of_each_deed(planner) -> None:
    told = []
    planner.on_change = told.append
    planner.add_person()
    planner.undo()
    planner.redo()
    assert [len(layout.people) for layout in told] == [1, 0, 1]
