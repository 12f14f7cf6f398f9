import numpy as np
import pytest
import trimesh
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy import ndimage

from elbowroom.errors import MachineError
from elbowroom.machine import Link, Machine, body_samples, ceiling_c_arm
from elbowroom.machine.kernels import samples as kernels
from elbowroom.machine.samples import CLUSTER_SIZE, interior_points, surface_points
from reference import machine_twins as naive

corner = st.tuples(*[st.floats(-0.5, 0.5)] * 3)


@pytest.fixture(scope="module")
def arm(tmp_path_factory):
    path = tmp_path_factory.mktemp("arm") / "arm.urdf"
    path.write_text(naive.ARM)
    return Machine.from_urdf(path, unchecked_links=("foot",))


def on_triangle(corners, rng, count):
    """Random points of a triangle, its corners and points of its edges among them."""
    weights = rng.dirichlet((0.5, 0.5, 0.5), count)
    weights = np.concatenate([weights, np.eye(3), (np.eye(3) + np.roll(np.eye(3), 1, axis=0)) / 2])
    return weights @ corners


@settings(max_examples=40)
@given(st.lists(st.tuples(corner, corner, corner), min_size=1, max_size=3), st.floats(0.03, 0.2))
def test_every_point_of_any_triangles_lies_within_cover_of_a_sample_on_them(triangles, cover_m):
    triangles = np.array(triangles)
    samples = surface_points(triangles, cover_m)
    rng = np.random.default_rng(0)
    for corners in triangles:
        points = on_triangle(corners, rng, 60)
        away = np.linalg.norm(points[:, None] - samples, axis=-1).min(axis=1)
        assert away.max() <= cover_m + 1e-12
    for sample in samples[:20]:
        assert min(naive.distance_to_triangle(sample, corners) for corners in triangles) < 1e-9


@pytest.mark.parametrize(
    "corners", [[[0, 0, 0]] * 3, [[0, 0, 0], [1, 0, 0], [2, 0, 0]], [[0, 0, 0], [1, 0, 0], [1, 1e-9, 0]]]
)
def test_triangles_without_area_are_covered_too(corners):
    triangle = np.array([corners], dtype=float)
    samples = surface_points(triangle, 0.1)
    points = on_triangle(triangle[0], np.random.default_rng(0), 50)
    assert np.linalg.norm(points[:, None] - samples, axis=-1).min(axis=1).max() <= 0.1 + 1e-12


def test_a_large_flat_surface_takes_few_samples():
    square = np.array([[[0, 0, 0], [1, 0, 0], [1, 1, 0]], [[0, 0, 0], [1, 1, 0], [0, 1, 0]]], dtype=float)
    # a square lattice covers a plane with 1 / (2 r^2) points for each unit of area
    assert len(surface_points(square, 0.02)) < 1.8 / (2 * 0.02**2)


def test_samples_of_the_c_arm_cover_it():
    machine, rng = ceiling_c_arm(), np.random.default_rng(1)
    samples = body_samples(machine, 0.1)
    for row, link in enumerate(machine.links):
        points = samples.points[samples.point_link == row].astype(float)
        if link.name not in machine.checked_links:
            assert len(points) == 0
            continue
        chosen = rng.choice(len(link.faces), 100)
        there = np.einsum("nk,nkj->nj", rng.dirichlet((1, 1, 1), 100), link.triangles[chosen])
        assert np.linalg.norm(there[:, None] - points, axis=-1).min(axis=1).max() <= samples.cover_m


def test_clusters_share_out_the_points_and_lie_in_their_spheres(arm):
    samples = body_samples(arm, 0.03)
    assert samples.cluster_start[0] == 0
    assert np.array_equal(samples.cluster_start[1:], samples.cluster_stop[:-1])
    assert samples.cluster_stop[-1] == len(samples.points)
    for c in range(len(samples.cluster_link)):
        run = slice(samples.cluster_start[c], samples.cluster_stop[c])
        assert 1 <= run.stop - run.start <= CLUSTER_SIZE
        assert (samples.point_link[run] == samples.cluster_link[c]).all()
        away = np.linalg.norm(samples.points[run] - samples.cluster_centre[c], axis=1)
        assert away.max() <= samples.cluster_radius[c] + 1e-7


def test_samples_are_made_once_and_cannot_be_changed(arm):
    samples = body_samples(arm, 0.03)
    assert body_samples(arm, 0.03) is samples
    assert body_samples(arm, 0.03, unchecked=True) is not samples
    with pytest.raises(ValueError, match="read-only"):
        samples.points[0] = 0


def holds_a_sample(points, centre, rotation, edge):
    return (np.abs((points - centre) @ rotation) <= edge / 2).all(axis=1).any()


@settings(max_examples=25)
@given(st.integers(0, 2**32 - 1))
def test_a_turned_voxel_inside_a_solid_holds_an_interior_sample(seed):
    rng = np.random.default_rng(seed)
    edge, radius = 0.1, 0.3
    points = interior_points(BALL, edge)
    rotation = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    direction = rng.normal(size=3)
    reach = 0.98 * radius - edge * np.sqrt(3) / 2
    centre = direction / np.linalg.norm(direction) * reach * rng.uniform() ** (1 / 3)
    assert holds_a_sample(points, centre, rotation, edge)


ball_mesh = trimesh.creation.icosphere(subdivisions=3, radius=0.3)
BALL = Link("ball", ball_mesh.vertices, ball_mesh.faces)


def test_interior_samples_lie_in_the_solid_or_within_a_quarter_voxel_of_its_surface():
    points = interior_points(BALL, 0.1)
    assert np.linalg.norm(points, axis=1).max() <= 0.3 + 0.025


def test_a_box_whose_sides_do_not_quite_meet_is_filled_and_one_without_a_lid_is_not():
    box = trimesh.creation.box((0.6, 0.6, 0.6))
    corners = box.triangles
    middle = corners.mean(axis=1, keepdims=True)
    slit = (middle + 0.99 * (corners - middle)).reshape(-1, 3)
    faces = np.arange(36).reshape(-1, 3)
    points = interior_points(Link("slit", slit, faces), 0.1)
    assert holds_a_sample(points, np.zeros(3), np.eye(3), 0.1)
    open_faces = faces[box.face_normals[:, 2] < 0.5]
    points = interior_points(Link("open", corners.reshape(-1, 3), open_faces), 0.1)
    assert not holds_a_sample(points, np.zeros(3), np.eye(3), 0.1)


@settings(max_examples=15)
@given(st.integers(0, 2**32 - 1))
def test_surface_cells_are_those_that_the_cut_triangle_reaches(seed):
    rng = np.random.default_rng(seed)
    triangles = rng.uniform(0.1, 4.9, (2, 3, 3))
    marked = np.zeros((5, 5, 5), dtype=bool)
    kernels.mark_surface(triangles, np.zeros(3), 1.0, marked)
    for cell in np.ndindex(5, 5, 5):
        lower = np.array(cell, dtype=float)
        assert marked[cell] == any(naive.touches_box(t, lower, lower + 1) for t in triangles)


def test_sizes_that_no_voxel_has_are_refused(arm):
    for size in (0.0, -1.0, float("nan")):
        with pytest.raises(MachineError, match="voxel_size_m"):
            body_samples(arm, size)
    with pytest.raises(MachineError, match="use larger voxels"):
        interior_points(BALL, 1e-4)


@settings(max_examples=15)
@given(st.integers(0, 2**32 - 1), st.tuples(*[st.integers(1, 9)] * 3), st.floats(0, 0.6))
def test_cells_are_outside_if_the_first_one_reaches_them(seed, shape, share):
    cells = (np.random.default_rng(seed).random(shape) < share).astype(np.uint8)
    cells[0, 0, 0] = kernels.OPEN
    parts, _ = ndimage.label(cells == kernels.OPEN)
    expected = np.where(parts == parts[0, 0, 0], kernels.OUTSIDE, cells)
    kernels.flood(cells)
    assert (cells == expected).all()


def test_a_comb_of_many_runs_is_flooded_too():
    cells = np.ones((3, 3, 9001), dtype=np.uint8)
    cells[:, :, ::2], cells[0, 0] = kernels.OPEN, kernels.OPEN
    kernels.flood(cells)
    assert (cells[:, :, ::2] == kernels.OUTSIDE).all() and (cells[1:, 1:, 1::2] == kernels.SURFACE).all()
