"""Collada, Wavefront, PLY, STL: one box, from every format the same; units and axes as the file declares them."""

import struct

import numpy as np
import pytest
import trimesh

from elbowroom.errors import InputError
from elbowroom.files.mesh.polygons import triangles_of
from elbowroom.files.mesh.read import read_mesh
from reference.gltf_files import a_box

CORNERS, FACES = a_box((0, 0, 0), (1, 2, 3))
QUADS = [[*FACES[n][:3], FACES[n + 1][2]] for n in range(0, 12, 2)]

DAE = """<?xml version="1.0"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1"><asset>{asset}</asset>
<library_geometries><geometry id="g" name="g"><mesh><source id="p">
<float_array id="a" count="24">{corners}</float_array>
<technique_common><accessor source="#a" count="8" stride="3"/></technique_common></source>
<vertices id="v"><input semantic="POSITION" source="#p"/></vertices>{faces}</mesh></geometry></library_geometries>
<library_nodes><node id="stored" name="inner"><instance_geometry url="#g"/></node></library_nodes>
<library_visual_scenes><visual_scene id="s"><node id="n" name="box">{node}</node></visual_scene></library_visual_scenes>
<scene><instance_visual_scene url="#s"/></scene></COLLADA>"""
TRIANGLES = (
    '<triangles count="12"><input semantic="VERTEX" source="#v" offset="0"/><p>'
    + " ".join(map(str, FACES.ravel()))
    + "</p></triangles>"
)
POLYLIST = (
    '<polylist count="6"><input semantic="NORMAL" source="#p" offset="0"/><input semantic="VERTEX" source="#v" '
    'offset="1"/><vcount>4 4 4 4 4 4</vcount><p>'
    + " ".join(f"0 {n}" for quad in QUADS for n in quad)
    + "</p></polylist>"
)

HOLED = "<polygons><input semantic='VERTEX' source='#v' offset='0'/><ph><p>0 1 2</p></ph></polygons>"


def dae(path, asset="", faces=TRIANGLES, node='<instance_geometry url="#g"/>', corners=CORNERS):
    path.write_text(
        DAE.format(asset=asset, faces=faces, node=node, corners=" ".join(f"{x:g}" for x in corners.ravel()))
    )
    return path


def volume(thing):
    a, b, c = np.moveaxis(thing.vertices[thing.faces], 1, 0)
    return np.einsum("ij,ij->", a, np.cross(b, c)) / 6


@pytest.mark.parametrize("faces", [TRIANGLES, POLYLIST])
@pytest.mark.parametrize(
    "node",
    [
        '<instance_geometry url="#g"/>',
        '<instance_node url="#stored"/>',
        '<node id="x"><scale>-1 1 1</scale><node><scale>-1 1 1</scale><instance_geometry url="#g"/></node></node>',
        '<translate>1 0 0</translate><matrix>1 0 0 -1 0 1 0 0 0 0 1 0 0 0 0 1</matrix><instance_geometry url="#g"/>',
        '<rotate>0 0 1 90</rotate><rotate>0 0 1 -90</rotate><instance_geometry url="#g"/>',
    ],
)
def test_a_collada_box_is_where_its_nodes_put_it(tmp_path, faces, node):
    (box,) = read_mesh(dae(tmp_path / "a.dae", faces=faces, node=node)).objects
    np.testing.assert_allclose(box.vertices.min(axis=0), 0, atol=1e-12)
    np.testing.assert_allclose(box.vertices.max(axis=0), (1, 2, 3), atol=1e-12)
    assert volume(box) == pytest.approx(6)


def test_a_mirrored_collada_node_has_its_faces_turned(tmp_path):
    node = '<scale>1 1 -1</scale><instance_geometry url="#g"/>'
    (box,) = read_mesh(dae(tmp_path / "a.dae", node=node)).objects
    assert box.vertices.min(axis=0)[2] == -3 and volume(box) == pytest.approx(6)


@pytest.mark.parametrize(
    ("asset", "unit_m", "up"),
    [
        ("", 1.0, "y"),
        ('<unit name="cm" meter="0.01"/><up_axis>Z_UP</up_axis>', 0.01, "z"),
        ('<unit meter="0.0254"/><up_axis>X_UP</up_axis>', 0.0254, "x"),
    ],
)
def test_collada_says_its_unit_and_its_axis(tmp_path, asset, unit_m, up):
    file = read_mesh(dae(tmp_path / "a.dae", asset))
    assert (file.unit_m, file.up) == (unit_m, up)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"node": '<instance_controller url="#skin"/>'}, "'box' is posed by bones or morphs .#skin."),
        ({"node": '<instance_geometry url="other.dae#g"/>'}, "'box': lies in another file"),
        ({"node": '<instance_geometry url="#gone"/>'}, "'box': #gone is not in the file"),
        ({"node": '<skew>1 0 0 0 1 0 0</skew><instance_geometry url="#g"/>'}, "'box': is placed by <skew>"),
        ({"faces": HOLED}, "holes"),
        ({"asset": '<unit meter="0"/>'}, "damaged Collada"),
    ],
)  # fmt: skip
def test_collada_that_cannot_be_read_is_refused_by_name(tmp_path, change, words):
    with pytest.raises(InputError, match=words):
        read_mesh(dae(tmp_path / "a.dae", **change))


def test_wavefront_objects_keep_their_names_whatever_their_materials(tmp_path):
    lines = [f"v {x} {y} {z}" for x, y, z in CORNERS]
    for name, material in (("left", "red"), ("right", "blue")):
        lines.append(f"o {name}")
        for n, quad in enumerate(QUADS):
            lines += [f"usemtl {material}{n % 2}", "f " + " ".join(f"{k + 1}/1/1" for k in quad)]
    lines += ["o third", "f " + " ".join(str(k - 8) for k in FACES[0])]
    path = tmp_path / "two.obj"
    path.write_text("\n".join(lines))
    left, right, third = read_mesh(path).objects
    assert (left.name, right.name, third.name) == ("left", "right", "third")
    assert volume(left) == pytest.approx(6) and len(right.faces) == 12 and len(third.faces) == 1
    path.write_text("v 0 0 0\nf 1 2 3")
    with pytest.raises(InputError, match="line 2: 'f 1 2 3' cannot be read"):
        read_mesh(path)


@pytest.mark.parametrize("kind", ["ascii", "binary_little_endian", "binary_big_endian"])
def test_ply_of_doubles_and_quads(tmp_path, kind):
    head = (
        f"ply\nformat {kind} 1.0\nelement vertex 8\n" + "".join(f"property double {a}\n" for a in "xyz")
        + "element face 7\nproperty list uchar int vertex_indices\nend_header\n"
    )  # fmt: skip
    faces = [*QUADS[:5], *FACES[10:]]
    order = ">" if "big" in kind else "<"
    if kind == "ascii":
        rows = [" ".join(map(str, row)) for row in CORNERS.tolist()]
        body = "\n".join([*rows, *(f"{len(f)} " + " ".join(map(str, f)) for f in faces)]).encode()
    else:
        body = CORNERS.astype(order + "f8").tobytes()
        body += b"".join(struct.pack(f"{order}B{len(f)}i", len(f), *map(int, f)) for f in faces)
    path = tmp_path / "box.ply"
    path.write_bytes(head.encode() + body)
    (box,) = read_mesh(path).objects
    assert volume(box) == pytest.approx(6)
    path.write_bytes((head.encode() + body)[:-9])
    with pytest.raises(InputError, match="damaged PLY"):
        read_mesh(path)


@pytest.mark.parametrize("ending", ["ply", "stl", "obj", "off"])
def test_what_trimesh_writes(tmp_path, ending):
    path = tmp_path / f"ball.{ending}"
    ball = trimesh.creation.icosphere(subdivisions=2, radius=0.7)
    ball.export(path)
    (read,) = read_mesh(path).objects
    assert read.name == "ball" and volume(read) == pytest.approx(ball.volume, rel=1e-5)


def test_a_dented_polygon_covers_itself_alone():
    outline = np.array([(0, 0, 0), (4, 0, 0), (4, 1, 0), (1, 1, 0), (1, 3, 0), (0, 3, 0)], float)
    for start in range(6):
        for turn in (1, -1):
            polygon = np.roll(np.arange(6), start)[::turn].tolist()
            for axes in ([0, 1, 2], [2, 0, 1], [1, 2, 0]):
                places = outline[:, axes]
                a, b, c = np.moveaxis(places[triangles_of(places, [polygon])], 1, 0)
                area = np.cross(b - a, c - a) / 2
                assert np.linalg.norm(area, axis=1).sum() == pytest.approx(6.0)
                assert np.linalg.norm(area.sum(axis=0)) == pytest.approx(6.0)


def test_an_unknown_kind_names_those_that_are_known(tmp_path):
    (tmp_path / "room.blend").write_bytes(b"")
    with pytest.raises(InputError, match=r"'\.blend' cannot be read, those of \.glb"):
        read_mesh(tmp_path / "room.blend")
