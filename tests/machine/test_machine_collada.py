"""Collada meshes: against trimesh's reader, by their units, and what cannot be read is refused with its line."""

import numpy as np
import pytest
import trimesh

from elbowroom.errors import MachineError
from elbowroom.machine import Machine
from elbowroom.machine.collada import read_collada
from elbowroom.machine.mesh_file import read_mesh

CORNERS = "0 0 0 1 0 0 1 1 0 0 1 0 0.5 0.5 2"
PYRAMID = (
    '<triangles count="6"><input semantic="VERTEX" source="#v" offset="0"/>'
    "<p>0 3 1 3 2 1 0 1 4 1 2 4 2 3 4 3 0 4</p></triangles>"
)
SCENE = '<node><instance_geometry url="#g"/></node>'


def collada(primitives=PYRAMID, nodes=SCENE, unit="1", up="Z_UP", corners=CORNERS, more=""):
    count = len(corners.split())
    return f"""<?xml version="1.0"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
<asset><unit name="u" meter="{unit}"/><up_axis>{up}</up_axis></asset>
<library_geometries><geometry id="g"><mesh>
<source id="p"><float_array id="pa" count="{count}">{corners}</float_array>
<technique_common><accessor source="#pa" count="{count // 3}" stride="3">
<param name="X"/><param name="Y"/><param name="Z"/></accessor></technique_common></source>
<vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
{primitives}</mesh></geometry></library_geometries>{more}
<library_visual_scenes><visual_scene id="s">{nodes}</visual_scene></library_visual_scenes>
<scene><instance_visual_scene url="#s"/></scene></COLLADA>"""


def read(folder, text):
    path = folder / "a.dae"
    path.write_text(text)
    return read_collada(path)


def solid(scene):
    return trimesh.Trimesh(scene.vertices, scene.faces)


NODES = """<node><matrix>0 -1 0 1  1 0 0 2  0 0 1 3  0 0 0 1</matrix><rotate>0 0 1 30</rotate><scale>2 1 1</scale>
<node><translate>0 0 5</translate><instance_geometry url="#g"/></node><instance_geometry url="#g"/></node>"""


def test_scenes_are_read_as_trimesh_reads_them(tmp_path):
    pytest.importorskip("collada")
    ours = solid(read(tmp_path, collada(nodes=NODES)))
    peer = trimesh.load(tmp_path / "a.dae", force="mesh")
    assert ours.volume == pytest.approx(peer.volume)
    assert ours.bounds == pytest.approx(peer.bounds)
    assert len(ours.faces) == len(peer.faces) == 12


@pytest.mark.parametrize("unit", ["0.001", "0.0254", "1", "2"])
def test_the_unit_is_obeyed(tmp_path, unit):
    assert np.ptp(read(tmp_path, collada(unit=unit)).vertices, axis=0) == pytest.approx(
        np.array([1, 1, 2]) * float(unit)
    )


def test_the_up_axis_is_read_as_other_readers_of_urdfs_do_and_said(tmp_path):
    (tmp_path / "a.dae").write_text(collada(up="Y_UP"))
    shape = '<collision><geometry><mesh filename="a.dae"/></geometry></collision>'
    (tmp_path / "r.urdf").write_text(f'<robot name="r"><link name="a">{shape}</link></robot>')
    machine = Machine.from_urdf(tmp_path / "r.urdf")
    assert np.ptp(machine.links[0].vertices, axis=0) == pytest.approx([1, 1, 2])
    assert "a.dae says Y_UP; axes are taken as they stand" in machine.findings[0].text
    assert read_mesh(tmp_path / "a.dae").note == "a.dae says Y_UP"


INPUT = '<input semantic="VERTEX" source="#v" offset="0"/><input semantic="NORMAL" source="#n" offset="1"/>'
KINDS = {
    "polylist": f'<polylist count="2">{INPUT}<vcount>4 3</vcount><p>0 0 3 0 2 0 1 0 0 0 1 0 4 0</p></polylist>',
    "polygons": f'<polygons count="2">{INPUT}<p>0 0 3 0 2 0 1 0</p><p>0 0 1 0 4 0</p></polygons>',
    "trifans": f'<trifans count="2">{INPUT}<p>0 0 3 0 2 0 1 0</p><p>0 0 1 0 4 0</p></trifans>',
    "tristrips": f'<tristrips count="2">{INPUT}<p>0 0 3 0 1 0 2 0</p><p>0 0 1 0 4 0</p></tristrips>',
    "triangles": f'<triangles count="3">{INPUT}<p>0 0 3 0 2 0 0 0 2 0 1 0 0 0 1 0 4 0</p></triangles>',
}


@pytest.mark.parametrize("kind", KINDS)
def test_all_kinds_of_polygons_are_the_same_surface(tmp_path, kind):
    found = solid(read(tmp_path, collada(KINDS[kind])))
    assert found.area == pytest.approx(1 + np.hypot(2, 0.5) / 2)
    assert found.bounds == pytest.approx(np.array([[0, 0, 0], [1, 1, 2]]))
    assert found.area_faces.argmax() is not None
    assert (found.face_normals[np.isclose(found.triangles[:, :, 2].max(axis=1), 0)][:, 2] < 0).all()


def test_a_mirrored_node_keeps_its_surface_turned_outward(tmp_path):
    mirrored = solid(read(tmp_path, collada(nodes=SCENE.replace("<inst", "<scale>-1 1 1</scale><inst"))))
    assert mirrored.volume == pytest.approx(solid(read(tmp_path, collada())).volume)


def test_nodes_of_a_library_are_put_where_they_are_called(tmp_path):
    part = '<node id="part"><translate>7 0 0</translate><instance_geometry url="#g"/></node>'
    more = f"<library_nodes>{part}</library_nodes>"
    nodes = '<node><translate>0 0 1</translate><instance_node url="#part"/></node>'
    assert read(tmp_path, collada(nodes=nodes, more=more)).vertices.min(axis=0) == pytest.approx([7, 0, 1])


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("no xml", "not XML"),
        (
            "<!DOCTYPE C [<!ENTITY more '0 0 4'>]>\n"
            + collada(corners="0 &more; 0").partition("?>")[2].lstrip(),
            "line 5: &more; stands for",
        ),
        ("<svg/>", "outermost element is not <COLLADA>"),
        (collada(unit="0"), "a unit of 0 m"),
        (collada(unit="x"), "line 3: <unit>: could not convert"),
        (collada(nodes='<node><instance_geometry url="#x"/></node>'), "names nothing in this file"),
        (collada(nodes='<node><instance_geometry url="other.dae#g"/></node>'), "names nothing in this file"),
        (collada(nodes='<node><instance_controller url="#c"/></node>'), "a skin or morph, which is not read"),
        (collada(nodes='<node id="n"><instance_node url="#n"/></node>'), "nodes lead in a ring"),
        (collada(nodes="<node><matrix>1 2 3</matrix></node>"), "holds 3 numbers, expected 16"),
        (collada(nodes='<node><skew>1</skew><instance_geometry url="#g"/></node>'), "<skew>: is not read"),
        (collada(PYRAMID.replace("3 0 4<", "3 0 9<")), "names corner 9, of 5"),
        (collada(PYRAMID.replace("3 0 4<", "3 0<")), "do not fit"),
        (collada(PYRAMID.replace("#v", "#w")), "leads to no positions"),
        (collada(KINDS["polylist"].replace("4 3<", "4 4<")), "vcount and p do not fit"),
        (
            collada(KINDS["polygons"].replace("<p>", "<ph><p>", 1).replace("</p>", "</p></ph>", 1)),
            "polygons with holes",
        ),
        (collada(corners=CORNERS.replace("0.5", "0,5")), "could not convert"),
    ],
)
def test_what_cannot_be_read_is_refused_and_never_dropped(tmp_path, text, message):
    with pytest.raises(MachineError, match=message):
        read(tmp_path, text)


def test_a_file_without_triangles_is_refused(tmp_path):
    (tmp_path / "a.dae").write_text(collada("<lines count='1'><p>0 1</p></lines>"))
    with pytest.raises(MachineError, match="no triangles"):
        read_mesh(tmp_path / "a.dae")
