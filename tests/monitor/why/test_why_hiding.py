"""What hides a place: moved aside as far as is said, the camera sees the place."""

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from elbowroom.geometry import DepthCamera, Intrinsics, VoxelGrid
from elbowroom.monitor.why.hiding import hiding_of
from elbowroom.reconstruct import reconstruct
from elbowroom.reconstruct.point_report import Sight
from elbowroom.sensing import DepthFrame

WALL_M, EDGE_M = 4.0, 0.1
GRID = VoxelGrid((-1.0, -1.0, 2.0), (20, 20, 10), EDGE_M)


def camera(kind: str = "planar") -> DepthCamera:
    """At the origin, looking along z."""
    return DepthCamera("one", 160, 120, np.eye(4), Intrinsics(120.0, 120.0, 79.5, 59.5), depth_kind=kind)


def image(of: DepthCamera, left: float, right: float, depth_m: float) -> DepthFrame:
    """A wall, and before it a post from the floor to the ceiling between two x [m]."""
    k = of.intrinsics
    x = (np.arange(of.width) - k.cx) / k.fx
    depth = np.full((of.height, of.width), WALL_M)
    depth[:, (x * depth_m >= left) & (x * depth_m <= right)] = depth_m
    if of.depth_kind == "radial":
        y = (np.arange(of.height) - k.cy) / k.fy
        depth *= np.sqrt(1 + x[None, :] ** 2 + y[:, None] ** 2)
    return DepthFrame("one", 0, depth.astype(np.float32))


def space_of(of: DepthCamera, frame: DepthFrame):
    return reconstruct(GRID, [of], [frame], looks=False)


@settings(max_examples=15)
@given(
    st.sampled_from(["planar", "radial"]),
    st.floats(-0.4, 0.2),
    st.floats(0.1, 0.5),
    st.floats(0.6, 1.6),
)
def test_moved_aside_as_far_as_is_said_the_place_is_seen(kind, left, width, depth_m):
    of, place = camera(kind), (0.05, 0.05, 2.55)
    space = space_of(of, image(of, left, left + width, depth_m))
    (seen,) = space.explain(place).cameras
    assume(seen.sight in (Sight.HIDDEN, Sight.EDGE))
    found = hiding_of(space.source, seen, place, EDGE_M)
    assert found is not None and found.side in ("left", "right") and not found.is_machine
    assert found.distance_m == pytest.approx(depth_m, rel=0.03)
    by = found.shift_m * (-1 if found.side == "left" else 1)
    pixel_m = depth_m / 120
    moved = space_of(of, image(of, left + by, left + width + by, depth_m))
    assert moved.explain(place).cameras[0].sight is Sight.THROUGH
    # and not much less would do
    less = by * max(0.0, 1 - (7 * pixel_m + 0.02) / abs(by))
    short = space_of(of, image(of, left + less, left + width + less, depth_m))
    assert short.explain(place).cameras[0].sight is not Sight.THROUGH


def test_a_wall_that_leaves_the_image_on_all_sides_has_no_side():
    of, place = camera(), (0.05, 0.05, 2.55)
    space = space_of(of, image(of, -9.0, 9.0, 1.0))
    (seen,) = space.explain(place).cameras
    found = hiding_of(space.source, seen, place, EDGE_M)
    assert found is not None and found.side is None and found.shift_m == 0.0


def test_where_nothing_is_in_between_nothing_hides():
    of, place = camera(), (0.05, 0.05, 2.55)
    space = space_of(of, image(of, 0.9, 1.0, 1.0))
    (seen,) = space.explain(place).cameras
    assert seen.sight is Sight.THROUGH and hiding_of(space.source, seen, place, EDGE_M) is None
