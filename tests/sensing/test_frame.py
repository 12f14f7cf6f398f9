"""A frame is what it was when it was made, and is in metres."""

import numpy as np
import pytest

from elbowroom.errors import FrameError
from elbowroom.sensing import DepthFrame


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
@pytest.mark.parametrize(
    "view", [lambda a: a, lambda a: a[:], lambda a: a[::-1, ::2], lambda a: np.asfortranarray(a)]
)
def test_a_frame_keeps_its_pixels_when_a_buffer_is_filled_again(dtype, view):
    buffer = np.full((6, 8), 2.0, dtype)
    given = view(buffer)
    frame = DepthFrame("one", 0, given)
    buffer[:], given[...] = 9.0, 9.0
    assert (frame.depth_m == 2.0).all() and not frame.depth_m.flags.writeable


def test_a_view_that_cannot_be_written_through_is_copied_as_well():
    buffer = np.full((6, 8), 2.0, np.float32)
    given = buffer.view()
    given.setflags(write=False)
    frame = DepthFrame("one", 0, given)
    buffer[:] = 9.0
    assert (frame.depth_m == 2.0).all()


def test_an_array_that_is_fixed_is_kept_without_a_copy():
    fixed = np.full((6, 8), 2.0, np.float32)
    fixed.setflags(write=False)
    assert DepthFrame("one", 0, fixed).depth_m is fixed


def test_millimetres_are_refused():
    with pytest.raises(FrameError, match=r"metres; these look like millimetres \(2\.5 m\)"):
        DepthFrame("one", 0, np.full((6, 8), 2500.0))
    with pytest.raises(FrameError, match="scale_m"):
        DepthFrame.from_raw("one", 0, np.full((6, 8), 2500, np.uint16), scale_m=1000.0)


def test_few_depths_far_away_and_what_is_no_number_are_no_millimetres():
    depth = np.full((60, 80), 2.5)
    depth[:20] = 3000.0
    depth[20:25], depth[25:30] = np.nan, np.inf
    assert DepthFrame("one", 0, depth).depth_m[0, 0] == 3000.0
    DepthFrame("one", 0, np.zeros((6, 8)))
    DepthFrame("one", 0, np.full((6, 8), np.inf))


@pytest.mark.parametrize("stamp", [1.7e9, "5", np.float64(3.0)])
def test_a_time_that_is_no_whole_number_is_refused(stamp):
    with pytest.raises(FrameError, match="whole nanoseconds"):
        DepthFrame("c", stamp, np.ones((2, 2), np.float32))


def test_a_time_of_numpy_is_a_time():
    assert type(DepthFrame("c", np.int64(5), np.ones((2, 2), np.float32)).stamp_ns) is int
