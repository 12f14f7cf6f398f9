import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from elbowroom.errors import InputError
from elbowroom.view.picture.viewpoint import FROM, looking, standard

BOX = np.array([[-1.0, -2.0, 0.0], [3.0, 1.0, 2.5]])
metres = st.floats(-5, 5)
points = st.tuples(metres, metres, metres)


@settings(max_examples=60)
@given(eye=points, target=points, point=points)
def test_the_ray_of_a_points_pixel_goes_through_the_point(eye, target, point) -> None:
    if np.linalg.norm(np.subtract(eye, target)) < 0.1:
        return
    view = looking(eye, target, (120, 80))
    (column, row, depth), *_ = view.project(np.array([point]))
    if not (0 <= column < 120 and 0 <= row < 80 and depth > 0.05):
        return
    origins, ways = view.rays(slice(0, 80), 1)
    ray = int(row) * 120 + int(column)
    along = (np.array(point) - origins[ray]) @ ways[ray]
    missed = np.linalg.norm(origins[ray] + along * ways[ray] - point)
    assert missed <= depth * 0.75 / view.scale * np.sqrt(2) + 1e-9  # within its pixel


@pytest.mark.parametrize("name", FROM)
@pytest.mark.parametrize("size", [(300, 200), (200, 300), (640, 100)])
def test_a_standard_view_holds_all_of_the_box_and_fills_the_picture(name, size) -> None:
    view = standard(name, BOX, size)
    corners = np.stack(np.meshgrid(*BOX.T, indexing="ij"), axis=-1).reshape(8, 3)
    seen = view.project(corners)
    assert (seen[:, 2] > 0).all()
    assert (seen[:, :2] >= 0).all() and (seen[:, :2] <= size).all()
    assert (np.ptp(seen[:, :2], axis=0) / size).max() > 0.75


@pytest.mark.parametrize("name", ["top", "front", "side"])
def test_views_to_scale_show_a_metre_as_long_wherever_it_is(name) -> None:
    view = standard(name, BOX, (300, 200))
    right = view.world_from_view[:3, 0]
    for start in BOX:
        ends = view.project(np.stack([start, start + right]))
        assert np.linalg.norm(ends[1, :2] - ends[0, :2]) == pytest.approx(view.scale)


@pytest.mark.parametrize("size", [(10, 200), (300, 5000)])
def test_sizes_that_no_picture_has_are_refused(size) -> None:
    with pytest.raises(InputError, match="size"):
        standard("top", BOX, size)


def test_a_view_from_nowhere_is_refused() -> None:
    with pytest.raises(InputError, match="differ"):
        looking((1, 1, 1), (1, 1, 1), (100, 100))
    with pytest.raises(InputError, match="degrees"):
        looking((1, 1, 1), (0, 1, 1), (100, 100), 179)
    with pytest.raises(InputError, match="unknown"):
        standard("behind", BOX, (100, 100))
