import numpy as np
import pytest
import trimesh
from hypothesis import given, settings
from hypothesis import strategies as st

from elbowroom.errors import MachineError
from elbowroom.geometry import VoxelGrid, bits, parallel
from elbowroom.machine import Machine, body_samples, body_words, default_growth
from elbowroom.machine import body as body_module
from elbowroom.machine.samples import surface_points
from reference import machine_twins as naive

AT_REST = {"slide": 0.1, "elbow": 0.4, "grip": 0.02}
joints = st.fixed_dictionaries(
    {"slide": st.floats(-0.5, 0.5), "elbow": st.floats(-2, 2), "grip": st.floats(0, 0.04)}
)


@pytest.fixture(scope="module")
def arm(tmp_path_factory):
    path = tmp_path_factory.mktemp("arm") / "arm.urdf"
    path.write_text(naive.ARM)
    return Machine.from_urdf(path, unchecked_links=("foot",))


def grid_about(voxel_size_m, lower=(-0.8, -0.7, -0.2), upper=(1.0, 0.7, 1.4)):
    return VoxelGrid.covering(lower, upper, voxel_size_m)


def covered(machine, where, grid, **more):
    return bits.unpack(body_words(machine, where, grid, **more), grid)


@pytest.mark.parametrize("growth", [0.25, 0.4, 0.5, 0.6, 0.8, 1.0, 1.3])
@pytest.mark.parametrize("upper", [(1.0, 0.7, 1.4), (0.35, 0.05, 0.6)])
def test_body_is_the_voxels_near_samples_one_by_one(arm, growth, upper):
    grid = grid_about(0.11, upper=upper)
    samples = body_samples(arm, 0.11, unchecked=True)
    placed = arm.world_from_link_array(arm.positions(AT_REST)[None])[0]
    # half a micrometre is kept back for rounding
    expected = naive.body(samples, placed, grid, growth * 0.11 - 1e-6)
    assert np.array_equal(covered(arm, AT_REST, grid, growth_m=growth * 0.11), expected)


@settings(max_examples=8)
@given(joints, st.floats(0.3, 1.2), st.floats(0.08, 0.16))
def test_body_is_the_voxels_near_samples_for_any_growth_and_voxel(arm, where, growth, edge):
    grid = grid_about(edge, upper=(0.5, 0.3, 0.9))
    samples = body_samples(arm, edge, unchecked=True)
    placed = arm.world_from_link_array(arm.positions(where)[None])[0]
    found = covered(arm, where, grid, growth_m=growth * edge)
    # give or take what is kept back for rounding
    assert not (naive.body(samples, placed, grid, growth * edge - 2e-6) & ~found).any()
    assert not (found & ~naive.body(samples, placed, grid, growth * edge)).any()


@settings(max_examples=6)
@given(joints, st.sampled_from([0.25, 0.5]))
def test_a_voxel_that_the_mesh_touches_is_covered(arm, where, growth):
    grid = grid_about(0.1)
    body = covered(arm, where, grid, growth_m=growth * 0.1)
    for triangle in naive.triangles_in_world(arm, where)[::3]:
        low = np.maximum(grid.index_of(triangle.min(axis=0)), 0)
        high = np.minimum(grid.index_of(triangle.max(axis=0)), np.array(grid.shape) - 1)
        for index in np.ndindex(*np.maximum(high - low + 1, 0)):
            voxel = tuple(low + index)
            lower = grid.lower_m + np.array(voxel) * 0.1
            # a hair smaller: touching the open voxel is what counts
            if naive.touches_box(triangle, lower + 1e-9, lower + 0.1 - 1e-9):
                assert body[voxel]


@settings(max_examples=4)
@given(joints, st.sampled_from([0.25, 0.5, 0.9]))
def test_a_voxel_farther_than_the_growth_from_the_body_is_never_covered(arm, where, growth):
    grid = grid_about(0.1)
    body = covered(arm, where, grid, growth_m=growth * 0.1)
    triangles = naive.triangles_in_world(arm, where)
    fine = 0.008
    surface = surface_points(triangles, fine)
    inside = np.zeros(grid.shape, dtype=bool)
    placed = arm.world_from_links(where)
    for link in arm.links:
        if link.has_geometry:
            link_from_world = np.linalg.inv(placed[link.name])
            centres = grid.centre_of(np.argwhere(body)) @ link_from_world[:3, :3].T + link_from_world[:3, 3]
            for shell in trimesh.Trimesh(link.vertices, link.faces).split():
                inside[body] |= shell.contains(centres)
    for voxel in np.argwhere(body & ~inside):
        lower = grid.lower_m + voxel * 0.1
        away = np.maximum(np.maximum(lower - surface, surface - lower - 0.1), 0)
        assert np.sqrt((away**2).sum(axis=1).min()) <= growth * 0.1 + fine


def test_a_solid_is_covered_to_its_middle(arm):
    grid = grid_about(0.02)
    body = covered(arm, AT_REST, grid)
    placed = arm.world_from_links(AT_REST)
    for name, point in (("foot", (0, 0, 0)), ("upper", (0, 0, 0.3)), ("fore", (0.5, 0, 0))):
        middle = placed[name] @ [*point, 1.0]
        assert body[tuple(grid.index_of(middle[:3]))]


def test_threads_leave_the_same_bits(arm, monkeypatch):
    monkeypatch.setattr(body_module, "POINTS_PER_THREAD", 100)
    grid = grid_about(0.04)
    with parallel.threads(1):
        one = body_words(arm, AT_REST, grid)
    with parallel.threads(3):
        many = body_words(arm, AT_REST, grid)
    assert np.array_equal(one, many)
    assert one.any()


def test_unchecked_links_are_body_too_and_what_is_outside_the_grid_is_left_out(arm):
    grid = VoxelGrid.covering((-0.3, -0.3, -0.1), (0.3, 0.3, 0.02), 0.04)
    assert covered(arm, AT_REST, grid)[grid.shape[0] // 2, grid.shape[1] // 2, 0]
    away = VoxelGrid.covering((5, 5, 5), (6, 6, 6), 0.05)
    assert not body_words(arm, AT_REST, away).any()
    assert not (body_words(arm, AT_REST, grid) & ~bits.inside(grid)).any()


def test_growth_and_joints_that_cannot_be_are_refused(arm):
    grid = grid_about(0.1)
    assert default_growth(grid) == 0.05
    for growth in (0.01, float("nan"), float("inf")):
        with pytest.raises(MachineError, match=r"at least 0.025 m"):
            body_words(arm, AT_REST, grid, growth_m=growth)
    with pytest.raises(MachineError, match="one position for each joint"):
        body_words(arm, {**AT_REST, "slide": [0.0, 0.1]}, grid)
    with pytest.raises(MachineError, match="out of its limits"):
        body_words(arm, {**AT_REST, "slide": 3.0}, grid)
