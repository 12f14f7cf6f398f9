"""The fixed room, the mounts in it, the kinds of sensors, and the site file that a layout becomes."""

import numpy as np
import pytest
import trimesh
import yaml

from elbowroom.errors import InputError, SiteError
from elbowroom.geometry import VoxelGrid
from elbowroom.placement.bill import bill
from elbowroom.placement.candidates import candidates_of, default_aims
from elbowroom.placement.fixed_room import FixedRoom, clear_sight
from elbowroom.placement.requirement import requirement_of
from elbowroom.placement.sensor import sensors_of
from elbowroom.sensing import NOISE_PRESETS
from elbowroom.site import Site
from elbowroom.site.site import THESIS_ROOM
from elbowroom.site.written import write_site
from elbowroom.sources import cameras_of
from reference.placement_rooms import camera_at, room_of

SITE = """
name: hall
grid: {origin_m: [-2, -2, 0], upper_m: [2, 2, 2.5], voxel_size_m: 0.25}
camera_defaults: {width: 64, height: 48, fx: 32.0, fy: 32.0, cx: 31.5, cy: 23.5, noise: tof}
room: {walls: {lower_m: [-2.5, -2.5, 0.0], upper_m: [2.5, 2.5, 2.9]}}
placement:
  mounts:
    - {name: post, position_m: [2.0, 0.0, 2.0], price: 7.0, cable_m: 3.0}
    - {name: beam, position_m: [0.0, 2.0, 2.0]}
    - {name: door, position_m: [-2.0, 0.0, 2.0]}
    - {name: lamp, position_m: [0.0, 0.0, 2.8], taken: true}
  forbidden: [{name: doorway, lower_m: [-2.5, -0.5, 0.0], upper_m: [-1.5, 0.5, 2.2]}]
  aims_m: [[0.0, 0.0, 1.0], [0.5, 0.5, 0.5]]
  sensors: [{name: a, price: 100.0}, {name: b, price: 50.0, max_depth_m: 3.0}]
  prices: {mount: 20.0, cable_per_m: 2.0, hub_m: [2.0, 2.0, 0.0]}
"""


@pytest.fixture
def load(tmp_path):
    def make(text=SITE, name="hall.yaml"):
        (tmp_path / name).write_text(text)
        return Site.load(tmp_path / name)

    return make


def test_candidates_are_free_mounts_times_aims_times_sensors_and_cost_what_the_site_says(load):
    site = load()
    made = candidates_of(site, site.grid(), FixedRoom.of_site(site))
    assert len(made) == 2 * 2 * 2
    assert {c.mount.name for c in made} == {"post", "beam"}
    price = {(c.mount.name, c.sensor.name): c.price for c in made}
    assert price["post", "a"] == 100 + 7 + 2 * 3 and price["beam", "b"] == 50 + 20 + 2 * (2 + 0 + 2)
    assert {c.camera.max_depth_m for c in made if c.sensor.name == "b"} == {3.0}
    looks = made[0].camera.world_from_camera[:3, 2]
    assert looks @ (np.array([0, 0, 1.0]) - made[0].mount.position_m) == pytest.approx(np.sqrt(5))


def test_a_bill_adds_up(load):
    site = load()
    made = candidates_of(site, site.grid(), FixedRoom.of_site(site))[:3]
    *items, total = bill(made)
    assert total["price"] == sum(item["price"] for item in items) == sum(c.price for c in made)
    for item in items:
        parts = item["sensor_price"] + item["mount_price"] + item["cable_price"]
        assert item["price"] == pytest.approx(parts)


def test_without_mounts_they_are_along_walls_and_ceiling_and_none_inside_furniture(load):
    text = (SITE[: SITE.index("placement:")] + "placement: {}").replace(
        "2.9]}}", "2.9]}, furniture: [{name: cupboard, lower_m: [1.5, -2.5, 0.0], upper_m: [2.5, 2.5, 2.5]}]}"
    )
    site = load(text)
    made = candidates_of(site, site.grid(), FixedRoom.of_site(site))
    names = {c.mount.name for c in made}
    heights = {round(float(c.mount.position_m[2]), 2) for c in made if c.mount.name.startswith("wall")}
    assert heights == {2.4, 0.4} and any(name.startswith("ceiling") for name in names)
    assert all(c.mount.position_m[0] < 1.5 or c.mount.position_m[2] > 2.5 for c in made)
    assert len({c.camera.name for c in made}) == len(names)
    assert len(default_aims(site.grid())) == 7


def test_mounts_may_lie_on_the_surfaces_of_a_mesh(load, tmp_path):
    """A room as a mesh that is closed about its inside: nothing in it is inside a solid."""
    shell = trimesh.creation.box(extents=(5, 5, 3))
    shell.invert()
    shell.apply_translation((0, 0, 1.5))
    shell.export(tmp_path / "room.stl")
    text = (
        SITE[: SITE.index("room:")] + "room: {mesh: room.stl}\nplacement: {mounts_along: {mesh_count: 12}}\n"
    )
    site = load(text)
    room = FixedRoom.of_site(site)
    assert room.solids == () and not room.occupied(site.grid()).any()
    made = candidates_of(site, site.grid(), room)
    places = np.unique([c.mount.position_m for c in made], axis=0)
    assert len(places) == 12
    assert (np.abs(np.abs(places - (0, 0, 1.5)) - (2.5, 2.5, 1.5)).min(axis=1) < 0.011).all()
    again = candidates_of(site, site.grid(), room)
    assert all((a.mount.position_m == b.mount.position_m).all() for a, b in zip(made, again, strict=True))


def test_a_mesh_with_y_up_is_turned_and_a_closed_one_is_solid(load, tmp_path):
    block = trimesh.creation.box(bounds=((-1, 0.0, -0.5), (1, 1.8, 0.5)))
    block.export(tmp_path / "block.glb")
    text = SITE[: SITE.index("room:")] + "room: {mesh: block.glb}\nplacement: {}\n"
    room = FixedRoom.of_site(load(text))
    assert len(room.solids) == 1
    low, high = room.triangles.min(axis=(0, 1)), room.triangles.max(axis=(0, 1))
    np.testing.assert_allclose([low, high], [(-1, -0.5, 0), (1, 0.5, 1.8)], atol=1e-6)
    occupied = room.occupied(VoxelGrid((-2, -2, 0), (8, 8, 5), 0.5))
    assert occupied[2:6, 3:5, :3].all() and not occupied[:2].any()


def test_objects_of_a_mesh_are_solids_one_by_one(load, tmp_path):
    """An open object blocks sight and leaves the others closed."""
    scene = trimesh.Scene()
    scene.add_geometry(trimesh.creation.box(bounds=((-1, 0.0, -0.5), (0, 1.0, 0.5))), node_name="closed")
    open_box = trimesh.creation.box(bounds=((0.5, 0.0, -0.5), (1, 1.0, 0.5)))
    open_box.update_faces(np.arange(len(open_box.faces)) > 1)
    scene.add_geometry(open_box, node_name="open")
    scene.export(tmp_path / "two.glb")
    text = SITE[: SITE.index("room:")] + "room: {mesh: two.glb}\nplacement: {}\n"
    room = FixedRoom.of_site(load(text))
    assert [solid.name for solid in room.solids] == ["closed"]
    assert [solid.name for solid in room.surfaces] == ["open"]


def test_rooms_of_the_package_go_by_name(load):
    text = SITE[: SITE.index("room:")] + "room: {mesh: setup2}\nplacement: {}\n"
    room = FixedRoom.of_site(load(text))
    assert {"floor", "wall +x"} < {solid.name for solid in room.solids} and not room.surfaces
    np.testing.assert_allclose(room.walls_m, [(-2.05, -2.05, 0), (2.05, 2.05, 2.9)])


def test_a_clear_sight_ends_at_its_point():
    triangle = np.array([[(0, -1, -1), (0, 2, -1), (0, 0, 2)]], float)
    eye, points = np.array([-1.0, 0, 0]), np.array([(-0.1, 0, 0), (0.1, 0, 0), (1, 9, 0)], float)
    assert clear_sight(triangle, eye, points).tolist() == [True, False, True]
    assert clear_sight(triangle[:0], eye, points).all()


def test_surfaces_behind_the_camera_and_beyond_the_box_block_nothing():
    room = room_of()
    corners = VoxelGrid((-2, -2, 0), (1, 1, 1), 2.5)
    box = np.array([[x, y, z] for x in (-2, 2) for y in (-2, 2) for z in (0, 2.5)], float)
    assert corners.size == 1 and len(room.blocking(np.array([2.4, 0, 2.4]), box)) == 0
    with_pillar = room_of((((-0.1, -0.1, 0.0), (0.1, 0.1, 1.0)),))
    assert 0 < len(with_pillar.blocking(np.array([2.4, 0, 2.4]), box)) <= 12


def test_the_simulated_room_has_walls_and_its_own_sensor():
    site = Site.simulated_room()
    room = FixedRoom.of_site(site)
    assert {solid.name for solid in room.solids} >= {"wall +x", "table", "lamp"}
    assert "patient" not in {solid.name for solid in room.solids}
    (sensor,) = sensors_of(site)
    assert (sensor.camera.width, sensor.camera.height) == (160, 120)


def test_no_camera_of_the_simulated_room_hangs_inside_its_furniture():
    site = Site.simulated_room()
    FixedRoom.of_site(site).refuse_inside(cameras_of(site))


def test_the_requirement_is_the_sites_or_the_commands(load):
    site = load(SITE.replace("placement:", "placement:\n  views: 2\n  angle_deg: 90.0"))
    assert (requirement_of(site).views, requirement_of(site).angle_deg) == (2, 90.0)
    assert (requirement_of(site, 1, 0.0).views, requirement_of(site, 1, 0.0).angle_deg) == (1, 0.0)
    with pytest.raises(InputError, match="do not fit on a circle"):
        requirement_of(site, 5)


def test_a_written_site_has_the_cameras_and_all_else(load, tmp_path):
    site = load(SITE + "recording: {layout: folder, folder: recorded}\n")
    cameras = [
        camera_at(
            "north", (0, 2, 2), (0, 0, 1), noise=NOISE_PRESETS["tof"], max_depth_m=5.0, depth_kind="radial"
        ),
        camera_at("south", (0, -2, 2), (0, 0, 1)),
    ]
    (tmp_path / "sub").mkdir()
    written = Site.load(write_site(site, cameras, tmp_path / "sub" / "placed.yaml"))
    for one, other in zip(cameras_of(written), cameras, strict=True):
        np.testing.assert_allclose(one.world_from_camera, other.world_from_camera, atol=1e-8)
        for name in (
            "name",
            "width",
            "height",
            "depth_kind",
            "noise",
            "min_depth_m",
            "max_depth_m",
            "flying_pixels",
        ):
            assert getattr(one, name) == getattr(other, name), name
        assert one.intrinsics == other.intrinsics
    assert written.grid() == site.grid() and written.entry.placement == site.entry.placement
    assert yaml.safe_load(written.path.read_text())["recording"]["folder"] == "../recorded"


def test_a_layout_of_the_simulated_room_stays_simulated(tmp_path):
    site = Site.simulated_room()
    written = Site.load(
        write_site(site, [camera_at("a", (0, 1.9, 2.4), (0, 0, 1))], tmp_path / "placed.yaml")
    )
    assert written.simulated is not None and written.lists_cameras
    assert [camera.name for camera in cameras_of(written)] == ["a"]
    with pytest.raises(SiteError, match="lists its cameras"):
        written.simulated_cameras()


def test_a_site_is_not_written_over_itself(load):
    site = load()
    with pytest.raises(SiteError, match="is the site file itself"):
        write_site(site, [camera_at("a", (0, 1.9, 2.4), (0, 0, 1))], site.path)


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("taken: true", "taken: yes please", "placement.mounts[3].taken"),
        ("forbidden:", "forbiden:", "placement.forbiden: unknown key (did you mean forbidden?)"),
        (
            "price: 100.0",
            "price: -1.0",
            "placement.sensors[0].price: found -1.0, allowed: greater than or equal to 0",
        ),
        ("name: b, ", "name: a, ", "each sensor a name of its own; a is there more than once"),
        ("name: beam", "name: post", "each mount a name of its own; post is there more than once"),
        (", hub_m: [2.0, 2.0, 0.0]", "", "hub_m, where the cables end, with cable_per_m"),
        ("lower_m: [-2.5, -0.5, 0.0]", "lower_m: [9.0, -0.5, 0.0]", "upper_m above lower_m in x, y and z"),
        ("room: {walls", "room: {wall", "room.wall: unknown key (did you mean walls?)"),
        ("upper_m: [2.5, 2.5, 2.9]", "upper_m: [2.5, -2.5, 2.9]", "upper_m above lower_m"),
        (
            "placement:\n",
            "placement:\n  mounts_along: {heights_m: [2.0]}\n",
            "at least one of wall_spacing_m",
        ),
        ("placement:\n", "placement:\n  angle_deg: 181.0\n", "placement.angle_deg: found 181.0"),
        ("2.9]}}", "2.9]}, mesh_up: y}", "mesh_up only with a mesh"),
        ("room: {walls", "simulated: {cameras: 3}\nroom: {walls", "no key room where the room is simulated"),
    ],
)
def test_wrong_entries_are_one_line(load, old, new, words):
    with pytest.raises(SiteError) as caught:
        load(SITE.replace(old, new, 1))
    assert words in str(caught.value) and "\n" not in str(caught.value)


def test_a_room_without_cameras_says_where_they_come_from(load):
    with pytest.raises(SiteError, match="none yet; `elbowroom placement optimise` finds places"):
        load().cameras()
    with pytest.raises(SiteError, match="at least one camera"):
        load(SITE[: SITE.index("placement:")])


def test_a_list_of_cameras_or_even_ones_not_both(load):
    text = (
        SITE[: SITE.index("room:")]
        + "simulated: {resolution: 64x48}\ncameras: [{name: a, position_m: [0, 1, 2], look_at_m: [0, 0, 1]}]\n"
    )
    with pytest.raises(SiteError, match=r"a list of cameras, or simulated.resolution"):
        load(text.replace("position_m: [0, 1, 2]", "position_m: [0.0, 1.0, 2.0]"))


@pytest.mark.parametrize("kind", ["taken", "forbidden"])
def test_when_no_mount_is_left_there_are_no_candidates(load, kind):
    text = SITE.replace("  mounts:\n", "  mounts:\n").replace(
        "lower_m: [-2.5, -0.5, 0.0], upper_m: [-1.5, 0.5, 2.2]",
        "lower_m: [-3.0, -3.0, 0.0], upper_m: [3.0, 3.0, 3.0]",
    )
    if kind == "taken":
        text = SITE.replace("[2.0, 0.0, 2.0]", "[2.0, 0.0, 2.0], taken: true").replace(
            "[0.0, 2.0, 2.0]", "[0.0, 2.0, 2.0], taken: true"
        )
    site = load(text)
    with pytest.raises(
        InputError, match="no candidates; every mount is taken, forbidden or inside something fixed"
    ):
        candidates_of(site, site.grid(), FixedRoom.of_site(site))


def test_meshes_that_cannot_be_read_are_one_line(load, tmp_path):
    text = SITE[: SITE.index("room:")] + "room: {mesh: room.stl}\nplacement: {}\n"
    with pytest.raises(SiteError, match="correct the path of the room's mesh"):
        FixedRoom.of_site(load(text))
    (tmp_path / "room.stl").write_text("no mesh")
    with pytest.raises(SiteError, match=r"room\.stl"):
        FixedRoom.of_site(load(text))


def test_the_thesis_room_is_a_valid_site_without_cameras():
    site = Site.load(THESIS_ROOM)
    assert site.grid().size == 320_000 and not site.lists_cameras


def test_a_mesh_beside_the_grid_and_one_that_is_not_closed_are_said(load, tmp_path):
    box = trimesh.creation.box(bounds=[[10, 10, 0], [11, 11, 1]])
    box.submesh([np.arange(11)], append=True).export(tmp_path / "room.ply")
    room = FixedRoom.of_site(load(SITE[: SITE.index("room:")] + "room: {mesh: room.ply}\nplacement: {}\n"))
    open_, beside = room.notes
    assert "'room' not closed" in open_ and "lies beside the grid, from [10.0, 10.0, 0.0]" in beside


def test_a_mesh_in_millimetres_is_refused_and_read_by_its_unit(load, tmp_path):
    trimesh.creation.box(bounds=[[-500, -500, 0], [500, 500, 1000]]).export(tmp_path / "room.stl")
    text = SITE[: SITE.index("room:")] + "room: {mesh: room.stl}\nplacement: {}\n"
    with pytest.raises(SiteError, match=r"room\.mesh: .*'room' is 1,000 m long; .* mesh_unit_m: 0\.001"):
        FixedRoom.of_site(load(text))
    room = FixedRoom.of_site(load(text.replace("room.stl", "room.stl, mesh_unit_m: 0.001")))
    np.testing.assert_allclose(room.walls_m, [(-0.5, -0.5, 0), (0.5, 0.5, 1)], atol=1e-6)
    assert [solid.name for solid in room.solids] == ["room"] and not room.notes
