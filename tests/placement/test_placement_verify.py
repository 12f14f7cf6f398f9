"""Laws of verification: what cameras see of an empty room, and whether it is enough."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from elbowroom.errors import CameraError, InputError
from elbowroom.geometry import Intrinsics, VoxelGrid, parallel
from elbowroom.placement.kernels import views as kernels
from elbowroom.placement.requirement import TIE_RAD, Requirement
from elbowroom.placement.sight import sights
from elbowroom.placement.verification import judge, verify
from elbowroom.placement.worst import worst_places
from reference.placement_rooms import camera_at, room_of, turned
from reference.placement_views import any_triple, blocked_by_box, directions, in_view, largest_set

PILLAR = ((-0.3, -0.2, 0.0), (0.2, 0.4, 1.5))


def test_three_views_at_exactly_100_degrees_are_valid():
    """100, 100 and 160 degrees apart: ties within 1e-9 count, a millionth of a degree less does not."""
    for shift in np.linspace(0, 2 * np.pi, 37):
        for least, wanted in ((100.0, 3), (100.0 + 1e-9, 3), (100.000001, 2)):
            angles = np.sort(np.mod(np.radians([0.0, 100.0, 200.0]) + shift, 2 * np.pi))
            assert kernels.largest_apart(angles, 3, math.radians(least), TIE_RAD) == wanted


@given(
    st.lists(st.floats(0, 2 * math.pi, exclude_max=True), max_size=7),
    st.sampled_from([30.0, 72.0, 90.0, 100.0, 120.0, 180.0]),
)
@settings(max_examples=200)
def test_the_largest_set_is_what_trying_all_sets_gives(angles, least_deg):
    ordered = np.sort(np.array(angles))
    found = kernels.largest_apart(ordered, len(angles), math.radians(least_deg), TIE_RAD)
    assert found == largest_set(angles, math.radians(least_deg))
    if least_deg == 100.0:
        assert (found >= 3) == any_triple(angles, math.radians(least_deg))


@pytest.mark.parametrize("furniture", [(), (PILLAR,)], ids=["empty", "pillar"])
def test_counts_and_validity_are_what_brute_force_over_all_triples_gives(grid, ring, furniture):
    found = verify(grid, ring, room_of(furniture))
    index = np.argwhere(found.asked)[::17]
    for i, point in zip(index, grid.centre_of(index), strict=True):
        seen = [
            in_view(camera, point)
            and not any(blocked_by_box(camera.centre_in_world, point, *box) for box in furniture)
            for camera in ring
        ]
        assert found.seen[(slice(None), *i)].tolist() == seen
        assert found.counts[tuple(i)] == sum(seen)
        eyes = [camera.centre_in_world for camera, sees in zip(ring, seen, strict=True) if sees]
        assert found.valid[tuple(i)] == any_triple(directions(point, eyes), math.radians(100))
    assert 5 < found.valid_pct < 95


def test_adding_a_camera_never_lowers_a_count(grid, ring):
    room = room_of((PILLAR,))
    before = None
    for count in range(1, len(ring) + 1):
        found = verify(grid, ring[:count], room)
        if before is not None:
            assert (found.counts >= before.counts).all() and (found.apart >= before.apart).all()
            assert found.valid_pct >= before.valid_pct
        before = found


@pytest.mark.parametrize("quarters", [1, 2, 3])
def test_turning_the_whole_room_about_z_changes_nothing(grid, ring, quarters):
    room, cameras = room_of((((0.5, -0.4, 0.0), (1.1, 0.3, 1.2)),)), ring
    box = np.array([(0.5, -0.4), (1.1, 0.3)])
    for _ in range(quarters):
        box = np.stack([-box[:, 1], box[:, 0]], axis=1)
    low, high = box.min(axis=0), box.max(axis=0)
    turned_room = room_of((((*low.tolist(), 0.0), (*high.tolist(), 1.2)),))
    plain = verify(grid, cameras, room)
    other = verify(grid, [turned(c, quarters * np.pi / 2) for c in cameras], turned_room)
    for name in ("counts", "apart", "valid", "asked"):
        np.testing.assert_array_equal(np.rot90(getattr(plain, name), quarters), getattr(other, name))


def test_the_order_of_cameras_does_not_matter(grid, ring):
    one, other = verify(grid, ring), verify(grid, ring[::-1])
    assert (one.counts == other.counts).all() and (one.apart == other.apart).all()
    assert (one.seen == other.seen[::-1]).all()


def test_one_thread_and_many_give_the_same(grid, ring):
    room = room_of((PILLAR,))
    with parallel.threads(1):
        one = verify(grid, ring, room)
    with parallel.threads(4):
        many = verify(grid, ring, room)
    assert (one.apart == many.apart).all()


def test_a_point_behind_a_wall_is_not_seen(grid):
    wall = ((-0.6, -2.5, 0.0), (-0.5, 2.5, 2.9))
    camera = camera_at("c", (2.4, 0.1, 1.2), (0, 0, 1.2))
    (seen,) = sights(grid, [camera], room_of((wall,)))
    x = grid.centre_of(np.argwhere(seen))[:, 0]
    assert x.min() > -0.5 and (x < 0).any()
    (without,) = sights(grid, [camera], room_of())
    assert without[:5].any()


def test_a_thin_pole_hides_exactly_what_is_behind_it():
    """Thinner than a pixel at its range: rays to the voxels find it all the same."""
    grid = VoxelGrid((-2, -2, 0), (80, 80, 2), 0.05)
    camera = camera_at("c", (-2.3, 0.025, 0.05), (2, 0.025, 0.05), width=16, height=12)
    pole = ((0.0, 0.02, 0.0), (0.01, 0.03, 2.0))
    (seen,) = sights(grid, [camera], room_of((pole,)))
    row = grid.index_of((0.0, 0.025, 0.02))[1]
    assert not seen[42:, row].any() and seen[20:39, row].all() and seen[60:, row + 4].all()


def test_what_is_out_of_range_is_not_seen(grid):
    near = camera_at("c", (2.4, 0.1, 1.2), (0, 0, 1.2), max_depth_m=3.0, depth_kind="radial")
    (seen,) = sights(grid, [near], None)
    distance = np.linalg.norm(grid.centre_of(np.argwhere(seen)) - near.centre_in_world, axis=1)
    assert 2.8 < distance.max() <= 3.0
    far = camera_at("c", (2.4, 0.1, 1.2), (0, 0, 1.2), min_depth_m=1.0)
    (seen,) = sights(grid, [far], None)
    ahead = (grid.centre_of(np.argwhere(seen)) - far.centre_in_world) @ far.world_from_camera[:3, 2]
    assert 1.0 <= ahead.min() < 1.3


def test_a_ray_whose_background_is_out_of_range_has_no_return_and_sees_nothing(grid):
    camera = camera_at("c", (2.4, 0.0, 1.2), (0, 0, 1.2), max_depth_m=4.0)
    assert sights(grid, [camera], None).any()
    (seen,) = sights(grid, [camera], room_of())
    points = grid.centre_of(np.argwhere(seen))
    # the far wall is 4.9 m away: only floor, ceiling and side walls return
    assert not seen[:, 7:9, 4:6].any() and len(points)


def test_a_distorted_camera_sees_by_its_pinhole_twin(grid):
    camera = camera_at("c", (2.4, 0.1, 1.2), (0, 0, 1.2))
    k = camera.intrinsics
    bent = Intrinsics(k.fx, k.fy, k.cx, k.cy, (-0.1, 0.01, 0.0, 0.0, 0.0))
    wide = camera_at("c", (2.4, 0.1, 1.2), (0, 0, 1.2))
    object.__setattr__(wide, "intrinsics", bent)
    plain, other = sights(grid, [camera, wide], room_of())
    assert other.any() and (plain ^ other).mean() < 0.1


def test_a_camera_straight_above_counts_as_a_view_but_has_no_direction():
    grid = VoxelGrid((-0.25, -0.25, 0), (1, 1, 1), 0.5)
    above = camera_at("above", (0, 1e-12, 2.4), (0, 1e-12 + 1e-6, 0.0))
    sides = [
        camera_at(f"c{n}", (np.cos(a), np.sin(a), 1.0), (0, 0, 0.3))
        for n, a in enumerate(np.radians([0, 120]))
    ]
    found = verify(grid, [above, *sides])
    assert found.counts.item() == 3 and found.apart.item() == 2
    assert verify(grid, [above]).apart.item() == 1


def test_points_inside_furniture_are_not_asked(grid, ring):
    found = verify(grid, ring, room_of((PILLAR,)))
    inside = grid.index_of((0.0, 0.1, 0.6))
    assert not found.asked[tuple(inside)] and not found.valid[tuple(inside)]
    assert found.valid_pct == pytest.approx(100 * found.valid.sum() / found.asked.sum())


def test_a_camera_inside_furniture_is_refused_in_one_line(grid):
    camera = camera_at("north", (0.0, 0.1, 0.6), (1, 0, 0.6))
    with pytest.raises(
        CameraError, match=r"camera north: at \[0.0, 0.1, 0.6\] m it is inside box 0; move it"
    ):
        verify(grid, [camera], room_of((PILLAR,)))


@pytest.mark.parametrize(
    ("views", "angle", "words"),
    [
        (4, 100.0, "4 views each 100 degrees apart do not fit on a circle of 360; at most 90 degrees"),
        (3, 121.0, "do not fit on a circle"),
        (0, 100.0, "views is 0"),
        (3, float("nan"), "angle is nan"),
        (2, 181.0, "must be from 0 to 180"),
    ],
)
def test_what_no_circle_has_room_for_is_refused(views, angle, words):
    with pytest.raises(InputError, match=words):
        Requirement(views, angle)


def test_a_requirement_that_just_fits_is_accepted():
    assert Requirement(3, 120.0).words == "3 views, each two at least 120 degrees apart"
    assert Requirement(1, 180.0).words == "1 view"


def test_no_camera_is_refused(grid):
    with pytest.raises(InputError, match="0 cameras, 1 to 255"):
        verify(grid, [])


def test_worst_places_say_who_sees_them(grid):
    """One voxel that only one camera sees, a layer that nobody sees."""
    names = ("north", "south", "east")
    cameras = [
        camera_at(n, (2.0 * np.cos(a), 2.0 * np.sin(a), 1), (0, 0, 1))
        for n, a in zip(names, np.radians([0, 120, 240]), strict=True)
    ]
    seen = np.ones((3, *grid.shape), dtype=bool)
    seen[:, :, :, 0] = False
    seen[1:, 3, 4, 5] = False
    found = judge(grid, cameras, seen, np.ones(grid.shape, dtype=bool), Requirement(1, 0.0))
    assert [p.words for p in worst_places(found)] == ["any x, any y, below 0.25 m: nobody sees it"]
    found = judge(grid, cameras, seen, np.ones(grid.shape, dtype=bool), Requirement(2, 90.0))
    places = worst_places(found, 9)
    assert places[0].apart == 0 and places[0].voxels == 256
    assert "x -1.12, y -0.88, z 1.38: only north sees it" in [p.words for p in places]
    assert worst_places(found, 1) != [] and len(worst_places(found, 1)) == 1


def test_worst_places_of_a_valid_room_are_none(grid, ring):
    seen = np.ones((len(ring), *grid.shape), dtype=bool)
    found = judge(grid, ring, seen, np.ones(grid.shape, dtype=bool), Requirement(1, 0.0))
    assert found.valid_pct == 100.0 and worst_places(found) == []
