"""Solids, corners that are one, and closed surfaces are what trimesh makes and says of them, to the last bit."""

from pathlib import Path

import numpy as np
import pytest
import trimesh
from hypothesis import given, settings
from hypothesis import strategies as st

from elbowroom.geometry import solids
from elbowroom.geometry.transforms import turn_of_rpy
from elbowroom.machine.mesh_file import read_mesh
from elbowroom.simulate import shapes

lengths = st.floats(0.001, 5.0)
places = st.tuples(*[st.floats(-3, 3)] * 3)
angles = st.floats(-7, 7) | st.sampled_from([0.0, np.pi / 2, -np.pi / 2, np.pi])


def is_same(made: solids.Triangles, mesh: trimesh.Trimesh) -> bool:
    return np.array_equal(made[0], mesh.vertices) and np.array_equal(made[1], mesh.faces)


def closed_by_trimesh(vertices, faces) -> bool:
    mesh = trimesh.Trimesh(vertices, faces, process=True)
    if not (mesh.is_watertight and mesh.is_winding_consistent):
        return False
    return all(shell.volume > 0 for shell in mesh.split(only_watertight=False))


@given(st.tuples(lengths, lengths, lengths))
def test_boxes(size):
    assert is_same(solids.box(size), trimesh.creation.box(extents=size))


@given(lengths, lengths, st.integers(3, 60))
def test_prisms(radius, length, sides):
    assert is_same(
        solids.prism(radius, length, sides), trimesh.creation.cylinder(radius, height=length, sections=sides)
    )


@given(places, places, lengths)
def test_bars_between_two_points(start, end, radius):
    if np.linalg.norm(np.subtract(end, start)) > 1e-3:
        bar = trimesh.creation.cylinder(radius=radius, segment=np.array([start, end]), sections=16)
        assert is_same(shapes.cylinder(start, end, radius), bar)


@given(angles, angles, angles)
def test_turns_of_roll_pitch_and_yaw(roll, pitch, yaw):
    matrix = trimesh.transformations.compose_matrix(angles=np.array([roll, pitch, yaw]))
    assert np.array_equal(turn_of_rpy(roll, pitch, yaw), matrix[:3, :3])


SURFACES = {
    "a box": solids.box((1, 2, 3)),
    "a prism": solids.prism(0.5, 1.0, 12),
    "two boxes that touch": trimesh.util.concatenate(
        [trimesh.creation.box(extents=(1, 1, 1), transform=np.eye(4))] * 2
    ),
    "a sphere": trimesh.creation.icosphere(subdivisions=1),
}


@pytest.mark.parametrize("name", SURFACES)
@settings(max_examples=25)
@given(data=st.data())
def test_a_surface_is_closed_where_trimesh_says_so(name, data):
    surface = SURFACES[name]
    vertices, faces = (
        surface if isinstance(surface, tuple) else (np.array(surface.vertices), np.array(surface.faces))
    )
    change = data.draw(st.sampled_from(["none", "hole", "turned", "inside out", "apart"]))
    row = data.draw(st.integers(0, len(faces) - 1))
    if change == "hole":
        faces = np.delete(faces, row, axis=0)
    elif change == "turned":
        faces = faces.copy()
        faces[row] = faces[row][::-1]
    elif change == "inside out":
        faces = faces[:, ::-1]
    elif change == "apart":  # each triangle has corners of its own, at the same places
        vertices, faces = vertices[faces.ravel()], np.arange(faces.size).reshape(-1, 3)
    said = solids.is_closed(vertices, faces)
    assert said == closed_by_trimesh(vertices, faces)
    if name != "two boxes that touch":
        assert said == (change in ("none", "apart"))


@pytest.mark.parametrize("far", [1e11, 1e30, -1e300])
def test_corners_that_are_out_of_this_world_are_kept_as_they_are(far):
    places, number = solids.merged(np.array([[far, 0, 0], [0, 0, 1.0], [far, 0, 0]]))
    assert places.tolist() == [[far, 0, 0], [0, 0, 1]] and number.tolist() == [0, 1, 0]


def test_nothing_is_not_closed():
    assert not solids.is_closed(np.zeros((0, 3)), np.zeros((0, 3), dtype=np.int64))


@settings(max_examples=25)
@given(st.integers(0, 2**32 - 1), st.sampled_from([1.0, 1e-3, 1e-9]))
def test_corners_of_a_binary_stl_are_one_as_trimesh_takes_them(tmp_path_factory, seed, scale):
    rng = np.random.default_rng(seed)
    corners = rng.integers(-3, 4, (40, 3, 3)) * scale + rng.choice([0, 1e-9], (40, 3, 3))
    mesh = trimesh.Trimesh(corners.reshape(-1, 3), np.arange(120).reshape(-1, 3), process=False)
    path = Path(tmp_path_factory.mktemp("stl")) / "made.stl"
    mesh.export(path)
    read, other = read_mesh(path), trimesh.load(path, force="mesh")
    assert np.array_equal(read.vertices, other.vertices) and np.array_equal(read.faces, other.faces)
