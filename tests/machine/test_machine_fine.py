"""A machine of many triangles: what is made of fewer contains it, and explains no more than it does."""

import numpy as np
import pytest
import trimesh

from elbowroom.errors import MachineError
from elbowroom.geometry import DepthCamera, Intrinsics, VoxelGrid, bits
from elbowroom.machine import Link, Machine, body_samples, body_words, default_growth, explain_frames, shape
from elbowroom.machine.kernels import samples as kernels
from elbowroom.machine.rasterise import drawn_mesh, mesh_of, rasterise
from elbowroom.motion import Motion, check_motions
from elbowroom.reconstruct import FreeSpace

URDF = """<robot name="fine"><link name="foot"/>
<link name="body"><collision><geometry><mesh filename="body.stl"/></geometry></collision></link>
<joint name="turn" type="revolute"><parent link="foot"/><child link="body"/><axis xyz="0 0 1"/>
<limit lower="-3" upper="3" effort="1" velocity="1"/></joint></robot>"""
VOXEL_M = 0.05
GRID = VoxelGrid.covering((-0.6, -0.6, -0.4), (0.6, 0.6, 0.4), VOXEL_M)
JOINTS = {"turn": 0.3}


@pytest.fixture(scope="module")
def machine(tmp_path_factory):
    """20,480 triangles: a long body with ripples, away from the axis."""
    folder = tmp_path_factory.mktemp("fine")
    ball = trimesh.creation.icosphere(subdivisions=5, radius=1.0)
    ripples = 1 + 0.03 * np.sin(9 * ball.vertices).sum(axis=1)
    vertices = ball.vertices * ripples[:, None] * (0.22, 0.08, 0.1) + (0.2, 0.0, 0.0)
    trimesh.Trimesh(vertices, ball.faces).export(folder / "body.stl")
    (folder / "fine.urdf").write_text(URDF)
    return Machine.from_urdf(folder / "fine.urdf")


@pytest.fixture(scope="module")
def as_it_is(machine):
    """The same, drawn and swept as it is."""
    links = tuple(Link(link.name, link.vertices, link.faces) for link in machine.links)
    same = Machine(machine.name, links, machine.joints, machine.tree)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(shape, "FINE_TRIANGLES", 10**9)
        assert not same.shape.is_fine
    assert machine.shape.is_fine and len(drawn_mesh(same, 0.002)[0].faces) == 20_480
    return same


def test_it_is_made_of_fewer_and_its_links_stay(machine):
    mesh, bound = drawn_mesh(machine, 0.002)
    assert bound == 0.002 and len(mesh.faces) < 0.2 * len(mesh_of(machine).faces)
    assert len(machine.links[1].faces) == 20_480
    assert mesh.closed[1]


def test_samples_cover_the_surface_as_it_was(machine):
    for size in (VOXEL_M, 0.02):
        samples = body_samples(machine, size)
        assert 0 < samples.bound_m <= samples.cover_m / 8
        corners = machine.links[1].vertices
        away = _nearest(samples.points, corners)
        assert away.max() <= samples.cover_m - samples.bound_m
        from_fine = trimesh.proximity.closest_point(
            trimesh.Trimesh(corners, machine.links[1].faces), samples.points[::200].astype(float)
        )[1]
        assert from_fine.max() <= samples.bound_m + 1e-6


def _nearest(samples, points):
    from scipy.spatial import cKDTree

    return cKDTree(samples).query(points)[0]


def test_the_body_covers_all_voxels_that_it_touches_and_none_far_away(machine):
    words = body_words(machine, JOINTS, GRID)
    body = bits.unpack(words, GRID)
    placed = machine.world_from_links(JOINTS)["body"]
    link = machine.links[1]
    points = link.vertices @ placed[:3, :3].T + placed[:3, 3]
    touched = np.zeros(GRID.shape, dtype=bool)
    kernels.mark_surface(points[link.faces], GRID.lower_m, VOXEL_M, touched)
    assert not (touched & ~body).any()
    mesh = trimesh.Trimesh(points, link.faces)
    far = np.argwhere(body)[::7]
    centres = GRID.lower_m + (far + 0.5) * VOXEL_M
    # a voxel's nearest point is at least half its diagonal nearer than its centre
    away = trimesh.proximity.closest_point(mesh, centres)[1] * ~mesh.contains(centres)
    assert away.max() <= default_growth(GRID) + np.sqrt(3) / 2 * VOXEL_M


def test_it_goes_no_farther_than_it_does_as_it_is(machine, as_it_is):
    for place in range(0, 24, 3):
        blocked = np.zeros(GRID.shape, dtype=bool)
        blocked[place % 24, (5 * place) % 24, 5:11] = True
        space = FreeSpace.from_occupied(GRID, blocked).without(as_it_is, JOINTS)
        motions = [Motion("turn", way, 0.5) for way in (1, -1)]
        fine = check_motions(space, machine, JOINTS, motions)
        exact = check_motions(space, as_it_is, JOINTS, motions)
        for ours, theirs in zip(fine, exact, strict=True):
            # the first block is found to within a sixteenth of a voxel, 0.4 m from the axis
            assert ours.free_travel <= theirs.free_travel + VOXEL_M / 16 / 0.4
            assert ours.free_travel >= theirs.free_travel - VOXEL_M / 4


def test_it_explains_no_more_than_it_does_as_it_is_and_all_of_itself(machine, as_it_is):
    pose = np.array([[1.0, 0, 0, 0], [0, 0, 1, -1.5], [0, -1, 0, 0], [0, 0, 0, 1]])
    camera = DepthCamera("south", 160, 120, pose, Intrinsics(110, 110, 79.5, 59.5))
    depth = rasterise(machine, camera, JOINTS)
    seen = np.isfinite(depth)
    for offset in (0.0, -0.004, 0.012, -0.012, 0.03):
        image = np.where(seen, depth + offset, 2.5).astype(np.float32)
        ours = explain_frames(machine, [camera], [image], [JOINTS]).model_depth["south"] > 0
        theirs = explain_frames(as_it_is, [camera], [image], [JOINTS]).model_depth["south"] > 0
        if abs(offset) < 0.005:
            assert ours[seen].mean() > 0.99
        assert (ours & ~theirs).sum() <= 0.01 * seen.sum()


def test_a_tolerance_too_small_for_fewer_triangles_is_kept(machine):
    assert drawn_mesh(machine, 0.2 * 0.0)[1] == 0.0
    assert len(drawn_mesh(machine, 0.0)[0].faces) == 20_480


def test_links_too_large_for_the_voxels_are_refused_before_anything_is_taken(tmp_path):
    for size in ("30 30 30", "400 300 250"):
        (tmp_path / "large.urdf").write_text(
            f'<robot name="large"><link name="boom"><collision><geometry><box size="{size}"/></geometry></collision>'
            "</link></robot>"
        )
        try:
            large = Machine.from_urdf(tmp_path / "large.urdf")
        except MachineError:
            continue
        with pytest.raises(MachineError, match=r"link boom: .*larger voxels.*millimetres"):
            body_samples(large, 0.05)
