import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from elbowroom.geometry import VoxelGrid, parallel
from elbowroom.simulate import Moment, Solid, true_occupancy
from elbowroom.simulate.kernels import touch as kernels
from elbowroom.simulate.shapes import box, capsule, cylinder, ellipsoid, join
from elbowroom.simulate.truth import SHRINK_M
from reference import simulate_truth as naive

EDGE = 0.1
SHAPE = (6, 5, 7)
GRID = VoxelGrid((-0.3, -0.25, -0.35), SHAPE, EDGE)


def placed(mesh, turn=(0.0, 0.0, 0.0), at=(0.0, 0.0, 0.0), **kinds):
    world_from_solid = np.eye(4)
    world_from_solid[:3, :3] = Rotation.from_euler("xyz", turn).as_matrix()
    world_from_solid[:3, 3] = at
    return Solid("solid", mesh, world_from_solid, **kinds)


def occupied(*solids, grid=GRID):
    return true_occupancy(grid, Moment(0.0, solids, {})).occupied


def triangles_of(solid):
    return solid.vertices_in_world[solid.mesh.faces]


triangles = st.lists(st.integers(-24, 24), min_size=9, max_size=9).map(
    # multiples of a quarter of an edge: faces, edges and corners on the voxels' own are common
    lambda numbers: np.array(numbers, dtype=float).reshape(1, 3, 3) * EDGE / 4 + (0, 0.05, 0.05)
)


@settings(max_examples=60)
@given(triangles)
def test_triangle_touches_the_boxes_that_clipping_leaves_it_in(triangle):
    found = np.zeros(SHAPE, dtype=bool)
    kernels.touch_surface(triangle, GRID.lower_m, EDGE, SHRINK_M, found)
    assert (found == naive.touched(triangle, GRID.lower_m, EDGE, SHAPE)).all()


@settings(max_examples=60)
@given(triangles)
def test_boxes_below_no_shrinking_are_grown_and_what_is_marked_keeps_its_mark(triangle):
    found = np.zeros(SHAPE, dtype=np.uint16)
    found[::2] = 7
    kernels.touch_surface(triangle, GRID.lower_m, EDGE, -0.3137 * EDGE, found, 300)
    touched = naive.touched(triangle, GRID.lower_m, EDGE, SHAPE, -0.3137 * EDGE)
    assert (found[::2] == 7).all()
    assert (found[1::2] == 300 * touched[1::2]).all()


MESHES = {
    "overlapping parts": join(
        [ellipsoid((-0.1, 0, 0), (0.3, 0.3, 0.3)), capsule((0.1, 0, 0), (0.1, 0, 0.1), 0.25)]
    ),
    "bar": join([cylinder((-0.5, -0.02, 0.01), (0.5, 0.01, 0.03), 0.07)]),
    "block": join([box((-0.21, -0.11, -0.26), (0.17, 0.13, 0.19))]),
}


@pytest.mark.parametrize("mesh", MESHES.values(), ids=MESHES)
@pytest.mark.parametrize("turn", [(0, 0, 0), (0.3, -0.7, 1.9)])
def test_voxel_is_occupied_if_touched_or_inside(mesh, turn):
    solid = placed(mesh, turn, (0.02, -0.01, 0.03))
    surface = naive.touched(triangles_of(solid), GRID.lower_m, EDGE, SHAPE)
    centres = GRID.centre_of(np.argwhere(~surface))
    expected = surface.copy()
    expected[~surface] = [naive.winding(triangles_of(solid), centre) != 0 for centre in centres]
    assert expected.sum() > surface.sum() or mesh is MESHES["bar"]
    assert (occupied(solid) == expected).all()


def test_floor_that_ends_at_zero_touches_no_voxel_above_it():
    for edge in (0.05, 0.02, 0.03):
        grid = VoxelGrid((-1, -1, 0), (20, 20, 10), edge)
        assert not occupied(placed(join([box((-9, -9, -0.2), (9, 9, 0))])), grid=grid).any()
        raised = occupied(placed(join([box((-9, -9, -0.2), (9, 9, 1e-6))])), grid=grid)
        assert raised[:, :, 0].all()
        assert not raised[:, :, 1:].any()


def test_box_that_fills_voxels_exactly_occupies_just_these():
    grid = VoxelGrid((0, 0, 0), (50, 50, 50), 0.02)
    found = occupied(placed(join([box((0.2, 0.3, 0.1), (0.4, 0.36, 0.9))])), grid=grid)
    expected = np.zeros(grid.shape, dtype=bool)
    expected[10:20, 15:18, 5:45] = True
    assert (found == expected).all()


def test_solid_that_holds_the_whole_grid_occupies_all_of_it():
    assert occupied(placed(join([ellipsoid((0.1, 0, 0), (5, 5, 5))]))).all()


def test_solid_beside_the_grid_occupies_nothing():
    for at in ((3, 0, 0), (0, -3, 0), (0, 0, 3), (0, 0, -3)):
        assert not occupied(placed(join([ellipsoid((0, 0, 0), (1, 1, 1))]), at=at)).any()


def test_shell_with_an_inner_surface_is_hollow():
    outer_vertices, outer_faces = box((-0.28, -0.24, -0.34), (0.28, 0.24, 0.34))
    inner_vertices, inner_faces = box((-0.15, -0.15, -0.2), (0.15, 0.15, 0.2))
    hollow = join([(outer_vertices, outer_faces), (inner_vertices, inner_faces[:, ::-1])])
    found = occupied(placed(hollow))
    i, j, k = GRID.index_of((0.0, 0.0, 0.0))
    assert not found[i, j, k]
    assert found[0, j, k]


def test_random_points_inside_solids_lie_in_occupied_voxels(room, grid):
    rng = np.random.default_rng(4)
    truth = true_occupancy(grid, room.at(5.0))
    tested = {True: 0, False: 0}
    for solid in room.at(5.0).solids:
        corners, volume = solid.vertices_in_world, truth.machine if solid.is_machine else truth.occupied
        lower, upper = (
            np.maximum(corners.min(axis=0), grid.lower_m),
            np.minimum(corners.max(axis=0), grid.upper_m),
        )
        if (lower >= upper).any():
            continue
        for point in rng.uniform(lower, upper, size=(60, 3)):
            if naive.winding(triangles_of(solid), point) != 0:
                tested[solid.is_machine] += 1
                assert volume[tuple(grid.index_of(point))], (solid.name, point)
    assert tested[True] > 50
    assert tested[False] > 200


def test_random_points_on_surfaces_lie_in_occupied_voxels(room, grid):
    rng = np.random.default_rng(5)
    moment = room.at(5.0)
    truth = true_occupancy(grid, moment)
    for solid in moment.solids:
        weights = rng.dirichlet((1, 1, 1), size=len(solid.mesh.faces))
        points = np.einsum("ij,ijk->ik", weights, triangles_of(solid))
        # a point on a boundary of voxels belongs to neither side
        off = np.abs((points - grid.lower_m) / grid.voxel_size_m % 1 - 0.5).max(axis=1) < 0.499
        index = grid.index_of(points[off & grid.contains(points)])
        assert (truth.machine if solid.is_machine else truth.occupied)[tuple(index.T)].all(), solid.name


def test_machine_is_kept_apart_and_threads_leave_the_same_voxels(room, grid):
    with parallel.threads(1):
        alone = true_occupancy(grid, room.at(3.0))
    with parallel.threads(2):
        both = true_occupancy(grid, room.at(3.0))
    assert (alone.occupied == both.occupied).all()
    assert (alone.machine == both.machine).all()
    assert alone.machine.any()
    without = Moment(3.0, tuple(s for s in room.at(3.0).solids if not s.is_machine), {})
    assert (true_occupancy(grid, without).occupied == alone.occupied).all()
    assert not true_occupancy(grid, without).machine.any()
