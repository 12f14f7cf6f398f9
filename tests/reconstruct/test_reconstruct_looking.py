"""`reconstruct` looks at the first moments: what cannot be meant so is refused, what is doubtful is a warning."""

import warnings
from dataclasses import replace

import numpy as np
import pytest

from elbowroom.errors import ImplausibleError, InputError, ValueWarning
from elbowroom.geometry import VoxelGrid
from elbowroom.reconstruct import reconstruct
from elbowroom.reconstruct.looking import FIRST, require_plausible
from elbowroom.reconstruct.nothing_seen import nothing_seen
from elbowroom.sensing import DepthFrame
from reference import values_room as room


def frames(scale=1.0):
    return [DepthFrame(camera.name, 0, room.depth_of(camera) * scale) for camera in room.cameras()]


def test_what_is_right_is_reconstructed_without_a_word():
    space = reconstruct(room.GRID, room.cameras(), frames())
    assert 0.5 < space.free.mean() < 1


@pytest.mark.parametrize("scale", [4.0, 0.1, 0.25 / 0.0254])
def test_another_unit_is_refused_each_time(scale):
    cameras = room.cameras()
    for _ in range(FIRST + 2):
        with pytest.raises(ImplausibleError, match="unit of depth"):
            reconstruct(room.GRID, cameras, frames(scale))
    assert issubclass(ImplausibleError, InputError)
    reconstruct(room.GRID, cameras, frames(scale), looks=False)


def test_what_is_doubtful_is_a_warning_at_the_first_moments():
    cameras = room.cameras()
    black = [replace(frames()[0], depth_m=np.zeros((room.HEIGHT, room.WIDTH), np.float32)), *frames()[1:]]
    for _ in range(FIRST):
        with pytest.warns(ValueWarning, match="camera ne: no pixel has a return"):
            require_plausible(room.GRID, cameras, black)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        require_plausible(room.GRID, cameras, black)


def test_a_depth_at_the_greatest_range_frees_nothing():
    """Whatever is written where there is no return: the greatest range, or a little less by rounding."""
    cameras = [room.camera_at("ne", room.EYES["ne"], max_depth_m=10.0)]
    for end in (10.0, np.nextafter(np.float32(10.0), np.float32(0.0)), 11.0):
        depth = np.full((room.HEIGHT, room.WIDTH), end, np.float32)
        space = reconstruct(room.GRID, cameras, [DepthFrame("ne", 0, depth)], rule="any", looks=False)
        assert not space.free.any()


IN_MID_AIR = VoxelGrid((-0.6, -0.6, 1.9), (12, 12, 3), 0.1)
"""Before walls that are not far: no unit tells, and nothing in it is seen."""


def test_a_grid_in_which_nothing_is_a_surface_is_said_where_cameras_agree_on_what_lies_behind():
    with pytest.warns(ValueWarning, match="nothing in it is a surface"):
        space = reconstruct(IN_MID_AIR, room.cameras(), frames(), rule="any")
    assert space.free.all()


def test_a_grid_in_which_nothing_is_a_surface_is_refused_where_nobody_vouches_for_the_depths():
    for _ in range(FIRST + 1):
        with pytest.raises(ImplausibleError, match="no two cameras agree on what is there"):
            reconstruct(IN_MID_AIR, room.cameras()[:1], frames()[:1], rule="any")
    assert reconstruct(IN_MID_AIR, room.cameras()[:1], frames()[:1], rule="any", looks=False).free.all()


@pytest.mark.parametrize(("lower", "size"), [((-1.9, -1.9, 0.0), 22), ((-0.6, -0.6, 0.0), 12)])
def test_a_grid_in_which_a_floor_or_a_box_is_seen_needs_nobody_to_vouch(lower, size):
    grid = VoxelGrid(lower, (size, size, 10), 0.1)
    assert not nothing_seen(grid, room.cameras()[:1], frames()[:1])


def test_what_leaves_much_without_a_return_does_not_read_free_and_is_no_fault():
    (camera,), (frame,) = room.cameras()[:1], frames()[:1]
    depth = frame.depth_m.copy()
    depth[::2] = 0
    assert nothing_seen(IN_MID_AIR, [camera], [frame])
    assert not nothing_seen(IN_MID_AIR, [camera], [DepthFrame("ne", 0, depth)])
