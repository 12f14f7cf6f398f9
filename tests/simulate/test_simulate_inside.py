"""A camera inside a solid would see the solid's inside: it is refused by name, or moved along the wall."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as some

from elbowroom.errors import CameraError, InputError
from elbowroom.simulate import InterventionRoom, Moment, Solid, Walls, render, wall_cameras
from elbowroom.simulate.inside import hung_clear, solid_about
from elbowroom.simulate.shapes import box, join
from elbowroom.site import Site
from elbowroom.sources import cameras_of

ROOM = InterventionRoom(people=False)


def cabinet(lower, upper, **changes):
    return Solid("cabinet", join([box(lower, upper)]), np.eye(4), is_static=True, **changes)


def test_a_camera_in_a_cabinet_is_an_error_that_names_both():
    cameras = wall_cameras(21, (2.4, 0.4), width=8, height=6)
    with pytest.raises(InputError, match=r"camera cam03 at \(1.71, 1.99, 0.40\) m is inside 'cabinet \+y'"):
        render(cameras, ROOM.at(0.0))
    assert len(render(hung_clear(cameras, ROOM.solids), ROOM.at(0.0))) == 21


@settings(max_examples=12)
@given(some.integers(1, 30), some.floats(0.1, 2.4))
def test_moved_cameras_keep_their_height_and_their_wall_and_others_stay(count, height_m):
    hung = wall_cameras(count, height_m, width=8, height=6)
    for before, after in zip(hung, hung_clear(hung, ROOM.solids), strict=True):
        here = after.centre_in_world
        assert solid_about(here, ROOM.solids) is None
        assert here[2] == pytest.approx(height_m) and np.abs(here[:2]).max() == pytest.approx(1.99)
        if solid_about(before.centre_in_world, ROOM.solids) is None:
            assert after is before
        else:
            # its optical axis meets the room's middle axis
            axis = after.world_from_camera[:3, 2]
            assert axis[0] * here[1] == pytest.approx(axis[1] * here[0], abs=1e-9) and axis[:2] @ here[:2] < 0


def test_where_the_walls_are_full_it_is_said():
    full = cabinet((-3, -3, 0), (3, 3, 1))
    with pytest.raises(CameraError, match=r"cam00.*inside 'cabinet'.*no place along the walls"):
        hung_clear(wall_cameras(1, 0.4), [full])
    assert hung_clear(wall_cameras(1, 1.4), [full], Walls())


def test_a_room_that_is_a_closed_mesh_itself_has_no_inside():
    shell = cabinet((-3, -3, 0), (3, 3, 3), has_inside=False)
    (frame,) = render(wall_cameras(1, 0.4, width=8, height=6), Moment(0.0, (shell,), {}))
    assert (frame.depth_m > 0).all()


def test_the_default_room_hangs_cameras_high_and_low_with_noise_and_none_in_furniture():
    site = Site.simulated_room()
    cameras = cameras_of(site)
    heights = [round(float(camera.centre_in_world[2]), 2) for camera in cameras]
    assert heights == [2.4, 0.4] * 10 + [2.4]
    assert all(camera.noise is not None for camera in cameras)
    assert len(render(cameras[:4], ROOM.at(0.0))) == 4


@pytest.mark.parametrize("count", [12, 16, 21, 40])
def test_any_number_of_cameras_of_the_default_room_hangs_clear(count):
    for camera in cameras_of(Site.simulated_room(), count=count):
        assert solid_about(camera.centre_in_world, ROOM.solids) is None
