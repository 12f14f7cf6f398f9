import json

import numpy as np
import pytest
from PIL import Image

from elbowroom.cli.site import site_app
from elbowroom.errors import GridError, InputError, SiteError
from elbowroom.geometry import DepthCamera, Intrinsics, VoxelGrid
from elbowroom.site import Site, memory_of
from elbowroom.site.coverage import in_view, views_per_voxel
from elbowroom.view.draw.site import draw_site, frustum_in_world


def command(*words):
    site_app(args=[str(word) for word in words], standalone_mode=False)


def test_new_writes_a_file_that_check_accepts(tmp_path, capsys):
    command("new", tmp_path / "room.yaml")
    command("check", tmp_path / "room.yaml", "--out", tmp_path / "room.png", "--json", tmp_path / "room.json")
    said = capsys.readouterr().out
    assert "is valid" in said and "memory    about" in said and "note      links that are not checked" in said
    with Image.open(tmp_path / "room.png") as picture:
        assert picture.size[0] > 1000
    written = json.loads((tmp_path / "room.json").read_text())
    assert {"command", "commit", "processor", "versions"} <= written["meta"].keys()
    (row,) = written["rows"]
    assert row["cameras"] == 2 and row["shape"] == [80, 80, 50] and row["motions"] == 8
    assert row["plane_bytes"] == 5 * 5 * 4 * 512


def test_new_replaces_a_file_only_by_force(tmp_path):
    path = tmp_path / "room.yaml"
    path.write_text("mine")
    with pytest.raises(SiteError, match="is there already; choose another name, or --force"):
        command("new", path)
    assert path.read_text() == "mine"
    command("new", path, "--force")
    assert Site.load(path).name == "my room"
    assert [found.name for found in tmp_path.iterdir()] == ["room.yaml"]


def test_new_in_a_folder_that_is_not_there_is_one_line(tmp_path):
    with pytest.raises(InputError, match="cannot be written"):
        command("new", tmp_path / "none" / "room.yaml")


def test_check_of_a_broken_site_leaves_nothing_behind(folder, plain):
    plain["recording"] = {"layout": "stampless", "folder": "rec"}
    folder.image("rec/north/a.png")
    folder.image("rec/south/a.png", size=(6, 8))
    path = folder.write(plain)
    with pytest.raises(InputError, match="6 x 8 pixels, its camera has 8 x 6"):
        command("check", path, "--out", folder.path / "room.png", "--json", folder.path / "room.json")
    assert not (folder.path / "room.png").exists() and not (folder.path / "room.json").exists()


def test_check_counts_moments_and_images(folder, plain, capsys):
    plain["recording"] = {"layout": "stampless", "folder": "rec"}
    for camera in ("north", "south"):
        for name in ("a", "b", "c"):
            folder.image(f"rec/{camera}/{name}.png")
    command("check", folder.write(plain))
    said = capsys.readouterr().out
    assert "6 images of 3 moments, headers checked" in said
    assert "note      frames have no times: no limit on their age" in said


def test_the_simulated_room_can_be_checked(capsys):
    command("check", Site.simulated_room().path)
    assert "cameras   21 of " in capsys.readouterr().out


@pytest.fixture
def camera():
    """At the origin, looks along +z; 90 degrees across."""
    intrinsics = Intrinsics(fx=5.0, fy=5.0, cx=4.5, cy=4.5)
    return DepthCamera("up", 10, 10, np.eye(4), intrinsics, min_depth_m=0.5, max_depth_m=4.0)


def test_what_is_in_view(camera):
    points = np.array(
        [[0, 0, 1], [0.9, 0.9, 1], [1.1, 0, 1], [0, 0, -1], [0, 0, 0.4], [0, 0, 5], [0, 0, 0]], float
    )
    assert in_view(camera, points).tolist() == [True, True, False, False, False, False, False]


def test_a_grid_that_nobody_looks_at_is_seen_by_none(camera):
    behind = VoxelGrid((-1, -1, -3), (20, 20, 20), 0.1)
    assert (views_per_voxel(behind, [camera, camera]) == 0).all()
    before = VoxelGrid((-0.5, -0.5, 1), (10, 10, 10), 0.1)
    assert (views_per_voxel(before, [camera, camera]) == 2).all()
    assert len(views_per_voxel(VoxelGrid((0, 0, 0), (500, 500, 500), 0.01), [camera])) <= 30_000


def test_a_frustum_is_the_edge_of_the_view(camera):
    frustum = frustum_in_world(camera, 2.0)
    assert frustum[0].tolist() == [0, 0, 0]
    np.testing.assert_allclose(np.abs(frustum[1:]), 2.0)


def test_the_picture_shows_grid_and_cameras(camera):
    grid = VoxelGrid((-1, -1, 0), (20, 20, 30), 0.1)
    with_camera = np.asarray(draw_site("room", grid, [camera]))
    without = np.asarray(draw_site("room", grid, []))
    assert with_camera.shape == without.shape and (with_camera != without).any()
    # a second one that looks the same way deepens the colour
    assert (np.asarray(draw_site("room", grid, [camera, camera])) != with_camera).any()


def test_the_picture_shows_the_machine_where_it_stands():
    grid = VoxelGrid((-1, -1, 0), (20, 20, 30), 0.1)
    triangle = np.array([[[-0.5, -0.5, 1.0], [0.5, -0.5, 1.0], [0.0, 0.5, 2.0]]])
    bare, drawn = (np.asarray(draw_site("room", grid, [], triangles)) for triangles in (None, triangle))
    rows, columns = np.nonzero((bare != drawn).any(axis=-1))
    # 3 m on 700 px; x from column 60 in the left view, from 840 in the right one; z up from row 784
    px_per_m = 700 / 3
    left, right = columns < 800, columns > 840
    assert columns[left].min() == pytest.approx(60 + 0.5 * px_per_m, abs=2)
    assert np.ptp(rows[left]) == pytest.approx(px_per_m, abs=2)
    assert rows[right].max() == pytest.approx(784 - px_per_m, abs=2)
    assert rows[right].min() == pytest.approx(784 - 2 * px_per_m, abs=2)


def test_a_site_with_a_machine_has_it_in_its_picture(monkeypatch, tmp_path):
    from elbowroom.view.draw import site as picture

    given = []
    monkeypatch.setattr(picture, "draw_site", lambda *args: given.append(args) or draw_site(*args))
    command("new", tmp_path / "room.yaml")
    command("check", tmp_path / "room.yaml", "--out", tmp_path / "room.png")
    ((_, grid, _, triangles),) = given
    machine = Site.load(tmp_path / "room.yaml").machine()
    assert len(triangles) == sum(len(link.triangles) for link in machine.links) > 0
    # most of it stands in the watched box
    inside = ((triangles > grid.lower_m) & (triangles < grid.upper_m)).all(axis=-1)
    assert inside.mean() > 0.5


def test_memory_grows_with_grid_and_cameras(camera):
    small, large = VoxelGrid((0, 0, 0), (16, 16, 16), 0.1), VoxelGrid((0, 0, 0), (32, 32, 32), 0.1)
    assert memory_of(large, []).plane_bytes == 8 * memory_of(small, []).plane_bytes == 8 * 512
    one, two = memory_of(small, [camera]), memory_of(small, [camera, camera])
    assert two.frames_bytes == 2 * one.frames_bytes == 800
    assert two.total_bytes > one.total_bytes
    assert one.maps_bytes == 0
    with pytest.raises(GridError):
        VoxelGrid((0, 0, 0), (10**5, 10**5, 10**5), 0.1)
