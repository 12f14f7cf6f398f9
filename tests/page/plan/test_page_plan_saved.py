import json
import math
from dataclasses import replace

import numpy as np
import pytest

from elbowroom.errors import InputError, SiteError
from elbowroom.page.plan.figures import Reckoner
from elbowroom.page.plan.ground import Ground
from elbowroom.page.plan.layout import Layout
from elbowroom.page.plan.package_room import ROOMS, package_room
from elbowroom.page.plan.planner import Planner
from elbowroom.page.plan.room_file import write_room
from elbowroom.page.plan.saved import keep, kept, save_site
from elbowroom.simulate.shapes import cylinder, join
from elbowroom.simulate.solid import Solid
from elbowroom.site import Site


@pytest.fixture
def planned(ground, tmp_path) -> Planner:
    planner = Planner(ground)
    planner.add_camera("wide")
    planner.add_thing("box")
    planner.move("box 1", (-0.3, 0.4), math.pi / 2)
    planner.add_thing("cabinet")
    planner.move("cabinet 1", (0.2, 0.5), 0.3)
    barrel = Solid("barrel", join([cylinder((0, 0, 0), (0, 0, 0.8), 0.2)]), np.eye(4))
    planner.add_file("barrel.glb", write_room([barrel], tmp_path / "barrel.glb").read_bytes())
    return planner


def same(one: Layout, other: Layout) -> bool:
    cameras = all(
        a.sensor == b.sensor
        and np.allclose(a.camera.world_from_camera, b.camera.world_from_camera, atol=2e-9)
        and replace(a.camera, world_from_camera=np.eye(4)).intrinsics == b.camera.intrinsics
        for a, b in zip(one.cameras, other.cameras, strict=True)
    )
    corners = [
        np.concatenate([solid.vertices_in_world for thing in plan.things for solid in thing.solids()])
        for plan in (one, other)
    ]
    return cameras and one.people == other.people and np.allclose(*corners, atol=1e-5)


def test_a_saved_plan_is_a_site_with_the_same_figures(ground, planned, tmp_path) -> None:
    written = save_site(ground, planned.layout, tmp_path / "planned.yaml")
    again = Ground.of(Site.load(written.path))
    assert [c.name for c in again.site.cameras()] == list(planned.layout.camera_names)
    assert [f.name for f in again.site.entry.room.furniture] == ["shelf", "box 1"]
    before = Reckoner(ground, True).figures(planned.layout)
    after = Reckoner(again, True).figures(again.first_layout())
    assert after.valid_pct == pytest.approx(before.valid_pct, abs=0.2)
    assert after.free_pct == pytest.approx(before.free_pct, abs=0.5)
    assert after.price == pytest.approx(before.price)
    assert "who hangs where" in written.path.read_text(encoding="utf-8")  # comments stay
    assert "planned by" in written.path.read_text(encoding="utf-8").splitlines()[0]


def test_a_plan_of_a_saved_plan_keeps_its_mesh(ground, planned, tmp_path) -> None:
    first = save_site(ground, planned.layout, tmp_path / "planned.yaml").path
    (tmp_path / "more").mkdir()
    again = Planner(Ground.of(Site.load(first)))
    again.add_file("barrel.glb", (tmp_path / "barrel.glb").read_bytes())
    second = Ground.of(Site.load(save_site(again.ground, again.layout, tmp_path / "more" / "p.yaml").path))
    names = [solid.name for solid in second.room.solids]
    assert sum("barrel" in name for name in names) == 2 and sum("cabinet" in name for name in names) == 1


def test_never_over_the_site_itself(ground, planned) -> None:
    before = ground.site.path.read_bytes()
    with pytest.raises(SiteError, match="itself"):
        save_site(ground, planned.layout, ground.site.path)
    assert ground.site.path.read_bytes() == before


def test_a_plan_without_cameras_is_no_site(ground, tmp_path) -> None:
    with pytest.raises(SiteError, match="camera"):
        save_site(ground, Layout(), tmp_path / "planned.yaml")
    assert not (tmp_path / "planned.yaml").exists()


def test_what_a_site_file_cannot_say_is_said(ground, planned, tmp_path) -> None:
    planned.add_person()
    assert "people" in save_site(ground, planned.layout, tmp_path / "a.yaml").notes[0]


def test_a_kept_plan_is_the_same_plan(ground, planned, tmp_path) -> None:
    planned.add_person()
    keep(planned.layout, ground.site.path, tmp_path / "p.plan.json")
    assert same(planned.layout, kept(tmp_path / "p.plan.json", ground))
    assert kept(tmp_path / "none.plan.json", ground) is None


@pytest.mark.parametrize(
    "spoil",
    [
        lambda text: text[: len(text) // 2],
        lambda text: text.replace('"elbowroom plan"', '"shopping list"'),
        lambda text: text.replace('"version": 1', '"version": 99'),
        lambda text: text.replace('"cameras": [', '"cameras": [{"name": "x"},'),
        lambda text: text.replace('"joints": {}', '"joints": {"larm": 0.1}'),
        lambda text: json.dumps([1, 2]),
        lambda text: "\x00" * 100,
        lambda text: text.replace('"faces": [', '"faces": [99999, 1, 2, '),
        lambda text: "[" * 100_000,
        lambda text: text.replace('"joints": {}', '"joints": {"long": 1' + "0" * 400 + "}"),
    ],
)
def test_a_file_that_is_no_plan_is_refused_and_stays(ground, planned, tmp_path, spoil) -> None:
    path = tmp_path / "p.plan.json"
    keep(planned.layout, ground.site.path, path)
    path.write_text(spoil(path.read_text(encoding="utf-8")), encoding="utf-8")
    before = path.read_bytes()
    with pytest.raises(InputError, match="no plan"):
        kept(path, ground)
    assert path.read_bytes() == before


@pytest.mark.parametrize("name", ROOMS)
def test_rooms_of_the_package_can_be_planned_in_and_saved(name, tmp_path) -> None:
    ground = Ground.of(package_room(name), 0.2)
    planner = Planner(ground)
    planner.add_camera("vga")
    again = Ground.of(Site.load(save_site(ground, planner.layout, tmp_path / "planned.yaml").path))
    assert again.first_layout().camera_names == planner.layout.camera_names
    assert len(again.room.solids) == len(ground.room.solids)
