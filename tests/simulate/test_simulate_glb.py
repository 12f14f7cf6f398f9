import numpy as np
import pytest
import trimesh

from elbowroom.errors import InputError
from elbowroom.simulate import solids_of_glb
from elbowroom.simulate.glb import open_edge_count
from elbowroom.simulate.solid import Mesh

Y_UP = np.array([[1.0, 0, 0, 0], [0, 0, 1, 0], [0, -1, 0, 0], [0, 0, 0, 1]])
"""y_up_from_z_up: as Blender exports."""


def write(path, *objects):
    """Objects as (name, mesh in z up [m]) to a GLB."""
    scene = trimesh.Scene()
    for name, mesh in objects:
        scene.add_geometry(mesh.copy().apply_transform(Y_UP), node_name=name, geom_name=name)
    path.write_bytes(scene.export(file_type="glb"))
    return path


def a_box(lower=(0, 0, 0), upper=(1, 2, 3)):
    return trimesh.creation.box(bounds=np.array([lower, upper], dtype=float))


def test_objects_come_in_metres_with_z_up_under_their_names(tmp_path):
    path = write(tmp_path / "room.glb", ("table", a_box()), ("lamp", a_box((0, 0, 2), (0.2, 0.2, 2.1))))
    solids = {solid.name: solid for solid in solids_of_glb(path)}
    assert set(solids) == {"table", "lamp"}
    assert solids["table"].vertices_in_world.min(axis=0) == pytest.approx((0, 0, 0))
    assert solids["table"].vertices_in_world.max(axis=0) == pytest.approx((1, 2, 3))
    assert all(solid.is_static and open_edge_count(solid.mesh) == 0 for solid in solids.values())


def test_an_object_of_several_materials_is_one_solid(tmp_path):
    whole = a_box()
    half = [whole.submesh([np.arange(6)], append=True), whole.submesh([np.arange(6, 12)], append=True)]
    for part, shade in zip(half, (10, 250), strict=True):
        part.visual = trimesh.visual.TextureVisuals(
            material=trimesh.visual.material.PBRMaterial(baseColorFactor=[shade, shade, shade, 255])
        )
    scene = trimesh.Scene()
    scene.add_geometry(half[0], node_name="door", geom_name="door")
    path = tmp_path / "one.glb"
    path.write_bytes(scene.export(file_type="glb"))
    with pytest.raises(InputError, match="'door' is not closed"):
        solids_of_glb(path)


def test_a_black_object_is_dark_to_sensors(tmp_path):
    box = a_box()
    box.visual = trimesh.visual.TextureVisuals(
        material=trimesh.visual.material.PBRMaterial(baseColorFactor=[5, 5, 5, 255])
    )
    (solid,) = solids_of_glb(write(tmp_path / "dark.glb", ("screen", box)))
    assert solid.is_dark and solid.colour == pytest.approx((5 / 255,) * 3, abs=0.01)


@pytest.mark.parametrize(
    ("mesh", "words"),
    [
        (a_box().submesh([np.arange(11)], append=True), "'thing' is not closed, 3 of its edges"),
        (a_box(upper=(1000, 2000, 3000)), "'thing' is 3,000 m long.*millimetres.*0.001"),
        (a_box(upper=(0.01, 0.02, 0.03)), "only 0.03 m long"),
    ],
)
def test_an_object_that_cannot_be_used_is_named(tmp_path, mesh, words):
    path = write(tmp_path / "bad.glb", ("thing", mesh))
    with pytest.raises(InputError, match=words) as caught:
        solids_of_glb(path)
    assert str(path) in str(caught.value) and "\n" not in str(caught.value)


def test_a_file_that_is_no_room_is_said_to_be_none(tmp_path):
    with pytest.raises(InputError, match="no such file"):
        solids_of_glb(tmp_path / "nothing.glb")
    (tmp_path / "text.glb").write_text("not a room")
    with pytest.raises(InputError, match="not a GLB file"):
        solids_of_glb(tmp_path / "text.glb")
    whole = write(tmp_path / "whole.glb", ("box", a_box())).read_bytes()
    (tmp_path / "cut.glb").write_bytes(whole[: len(whole) // 2])
    with pytest.raises(InputError, match="damaged GLB"):
        solids_of_glb(tmp_path / "cut.glb")


def test_a_glb_without_faces_is_empty(tmp_path):
    path = tmp_path / "empty.glb"
    path.write_bytes(trimesh.Scene([trimesh.PointCloud(np.eye(3))]).export(file_type="glb"))
    with pytest.raises(InputError, match="no object with faces"):
        solids_of_glb(path)


def test_edges_that_are_passed_both_ways_are_closed_however_often():
    box = a_box()
    twice = Mesh(box.vertices, np.concatenate([box.faces, box.faces]))
    turned = Mesh(box.vertices, np.concatenate([box.faces[:1, ::-1], box.faces[1:]]))
    assert open_edge_count(twice) == 0
    assert open_edge_count(turned) == 3
