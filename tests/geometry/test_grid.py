import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from elbowroom.errors import GridError
from elbowroom.geometry import VoxelGrid

coordinates = st.floats(-10, 10)
points = st.tuples(coordinates, coordinates, coordinates)
sizes = st.floats(0.01, 0.5)
grids = st.builds(
    VoxelGrid, points, st.tuples(st.integers(1, 40), st.integers(1, 40), st.integers(1, 40)), sizes
)


@given(grid=grids, data=st.data())
def test_a_voxels_centre_lies_in_that_voxel(grid, data):
    index = [data.draw(st.integers(0, n - 1)) for n in grid.shape]
    assert grid.index_of(grid.centre_of(index)).tolist() == index
    assert grid.contains(grid.centre_of(index))


@given(grid=grids, point=points)
def test_a_point_is_in_the_grid_exactly_if_it_lies_between_its_corners(grid, point):
    offset = (np.array(point) - grid.lower_m) / grid.voxel_size_m
    between = ((offset >= 0) & (offset < np.array(grid.shape))).all()
    assert bool(grid.contains(point)) == bool(between)


@given(lower=points, extent=st.tuples(st.floats(0.02, 5), st.floats(0.02, 5), st.floats(0.02, 5)), size=sizes)
def test_covering_covers_and_wastes_less_than_a_voxel(lower, extent, size):
    upper = np.array(lower) + np.array(extent)
    grid = VoxelGrid.covering(lower, upper, size)
    assert (grid.upper_m >= upper - 1e-6).all()
    assert (grid.upper_m - upper < size + 1e-6).all()


def test_covering_a_whole_number_of_voxels_adds_none():
    assert VoxelGrid.covering((-2, -2, 0), (2, 2, 2.5), 0.05).shape == (80, 80, 50)
    assert VoxelGrid.covering((-2, -2, 0), (2, 2, 2.5), 0.02).shape == (200, 200, 125)


def test_index_order_is_x_y_z():
    grid = VoxelGrid((-2, -1, 0), (40, 20, 10), 0.1)
    assert grid.index_of((1.05, 0.05, 0.55)).tolist() == [30, 10, 5]
    np.testing.assert_allclose(grid.upper_m, (2, 1, 1))
    assert grid.size == 8000


@pytest.mark.parametrize(
    ("origin", "shape", "size", "message"),
    [
        ((0, 0), (1, 1, 1), 0.1, "origin_m"),
        ((0, 0, float("nan")), (1, 1, 1), 0.1, "origin_m is"),
        ((0, 0, 0), (0, 1, 1), 0.1, "at least 1"),
        ((0, 0, 0), (1.5, 1, 1), 0.1, "whole numbers"),
        ((0, 0, 0), (1, 1, 1), 0.0, "voxel_size_m is 0"),
        ((0, 0, 0), (1, 1, 1), float("nan"), "voxel_size_m is nan"),
        ((0, 0, 0), (1_000_000, 1_000_000, 1_000_000), 0.1, "more than 2,000,000,000"),
    ],
)
def test_unusable_grids_are_refused(origin, shape, size, message):
    with pytest.raises(GridError, match=message):
        VoxelGrid(origin, shape, size)


@pytest.mark.parametrize(
    ("upper", "size", "message"),
    [
        ((1, 1, 0), 0.1, "empty"),
        ((1, 1, -1), 0.1, "empty"),
        ((1, 1, 1), -0.1, "voxel_size_m"),
        ((1e9, 1, 1), 1e-9, "too many voxels"),
        ((float("inf"), 1, 1), 0.1, "finite"),
    ],
)
def test_empty_and_endless_boxes_are_refused(upper, size, message):
    with pytest.raises(GridError, match=message):
        VoxelGrid.covering((0, 0, 0), upper, size)


def test_points_that_are_nowhere_have_no_index():
    with pytest.raises(GridError, match="finite"):
        VoxelGrid((0, 0, 0), (1, 1, 1), 1.0).index_of((0, float("nan"), 0))
