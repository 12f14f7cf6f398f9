import numpy as np
import pytest

from elbowroom.errors import CameraError
from elbowroom.geometry import VoxelGrid
from elbowroom.simulate import InterventionRoom, Optics, render, wall_cameras


def views(cameras, points):
    """How many cameras have each point in their image."""
    count = np.zeros(len(points), dtype=int)
    for camera in cameras:
        x, y, z = (points @ camera.camera_from_world[:3, :3].T + camera.camera_from_world[:3, 3]).T
        u = camera.intrinsics.fx * x / z + camera.intrinsics.cx
        v = camera.intrinsics.fy * y / z + camera.intrinsics.cy
        count += (
            (z > 0)
            & (np.abs(u - camera.intrinsics.cx) < camera.width / 2)
            & (np.abs(v - camera.intrinsics.cy) < camera.height / 2)
        )
    return count


@pytest.mark.parametrize(("count", "least"), [(21, 7), (8, 3)])
def test_every_part_of_an_empty_room_is_in_view_of_several_cameras(count, least):
    grid = VoxelGrid.covering((-2, -2, 0), (2, 2, 2.5), 0.125)
    points = grid.centre_of(np.argwhere(np.ones(grid.shape, dtype=bool)))
    assert views(wall_cameras(count), points).min() >= least


@pytest.mark.parametrize("count", [1, 4, 21])
def test_cameras_hang_at_equal_distances_along_the_walls_and_look_inwards(count):
    cameras = wall_cameras(count, 2.2)
    centres = np.array([camera.centre_in_world for camera in cameras])
    assert (centres[:, 2] == 2.2).all()
    assert np.abs(centres[:, :2]).max(axis=1) == pytest.approx(1.99)
    x, y = centres[:, 0], centres[:, 1]
    way = np.select(
        [np.isclose(x, 1.99), np.isclose(y, 1.99), np.isclose(x, -1.99)],
        [y, 2 * 1.99 - x, 4 * 1.99 - y],
        6 * 1.99 + x,
    )
    assert np.diff(np.sort(way % (8 * 1.99))) == pytest.approx(np.full(count - 1, 8 * 1.99 / count))
    for camera in cameras:
        right, down, forward = camera.world_from_camera[:3, :3].T
        assert right[2] == pytest.approx(0, abs=1e-12)
        assert down[2] < 0
        assert forward @ -camera.centre_in_world > 0
    assert [camera.name for camera in cameras] == [f"cam{n:02d}" for n in range(count)]


def test_sizes_and_field_of_view():
    assert wall_cameras()[0].intrinsics.fx == pytest.approx(320)
    thesis = wall_cameras(size="thesis")[0]
    assert (thesis.width, thesis.height, thesis.depth_kind) == (64, 48, "radial")
    assert wall_cameras(optics=Optics(hfov_deg=40), width=64, height=48)[0].intrinsics.fx == pytest.approx(
        32 / np.tan(np.radians(20))
    )


@pytest.mark.parametrize("wrong", [{"count": 0}, {"size": "huge"}, {"width": -3}])
def test_impossible_cameras_are_refused(wrong):
    with pytest.raises(CameraError, match=str(next(iter(wrong.values())))):
        wall_cameras(**wrong)


def test_a_field_of_view_that_no_pinhole_has_is_refused():
    with pytest.raises(CameraError, match="hfov_deg is 180, must be between"):
        Optics(hfov_deg=180)


def test_no_camera_is_inside_a_solid():
    cameras = wall_cameras(21, width=16, height=12)
    for time_s in (0.0, 9.0):
        for frame in render(cameras, InterventionRoom().at(time_s)):
            assert frame.depth_m.min() > 0.2
