"""Mesh files of a machine: read as the room's are, and what would lose a part is refused or said."""

import numpy as np
import pytest
import trimesh

from elbowroom.errors import MachineError, MachineWarning
from elbowroom.files.mesh import read as room
from elbowroom.geometry.solids import is_closed
from elbowroom.machine import Machine
from elbowroom.machine.mesh_file import read_mesh
from reference.gltf_files import Gltf, a_box
from reference.small_urdf import mesh_link, urdf

CORNERS, FACES = a_box((0, 0, 0), (1, 2, 3))


def wavefront(path, at, word):
    """Boxes at some places, an object each; `word` writes a corner from its number and how many there are."""
    lines = []
    for n, place in enumerate(at):
        lines += [f"o part{n}", *(f"v {x} {y} {z}" for x, y, z in CORNERS + place)]
        lines += ["f " + " ".join(word(8 * n + k, 8 * n + 8) for k in face) for face in FACES]
    path.write_text("\n".join(lines))
    return path


def surface(read):
    """Triangles in an order of their own."""
    return sorted(sorted(t) for t in np.round(read.vertices[read.faces], 6).tolist())


@pytest.mark.parametrize("count", [1, 2, 3])
def test_corners_of_wavefront_counted_from_the_last_one_are_those_counted_from_the_first(tmp_path, count):
    at = [(4 * n, 0, n) for n in range(count)]
    ahead = read_mesh(wavefront(tmp_path / "a.obj", at, lambda k, _: str(k + 1)))
    back = read_mesh(wavefront(tmp_path / "b.obj", at, lambda k, so_far: str(k - so_far)))
    assert surface(back) == surface(ahead)
    assert len(back.vertices) == 8 * count and np.ptp(back.vertices[:, 0]) == 4 * count - 3
    assert is_closed(back.vertices, back.faces)


def test_faces_of_wavefront_may_come_before_their_corners_and_not_without_them(tmp_path):
    lines = wavefront(tmp_path / "a.obj", [(0, 0, 0)], lambda k, _: str(k + 1)).read_text().splitlines()
    lines.sort(key=lambda line: line[0])
    (tmp_path / "b.obj").write_text("\n".join(lines))
    assert surface(read_mesh(tmp_path / "b.obj")) == surface(read_mesh(tmp_path / "a.obj"))
    (tmp_path / "c.obj").write_text("\n".join(line for line in lines if line != "v 1.0 2.0 3.0"))
    with pytest.raises(
        MachineError, match=r"mesh .*c.obj: line \d+: 'f .*' cannot be read \(vertex 8 of 7\)"
    ):
        read_mesh(tmp_path / "c.obj")


def sparse(g):
    at = {"bufferView": g.view(np.array([7], "<u2")), "componentType": 5123}
    put = {"bufferView": g.view(np.array([[5, 5, 5]], "<f4"))}
    return {"POSITION": g.accessor(CORNERS, sparse={"count": 1, "indices": at, "values": put})}, {}


def morph(g):
    return {}, {"targets": [{"POSITION": g.accessor(np.eye(8)[7][:, None] * (4, 3, 2))}]}


def normalised(g):
    g.content["extensionsRequired"] = g.content["extensionsUsed"] = ["KHR_mesh_quantization"]
    corners = np.round(CORNERS / 5 * 32767)
    corners[7] = 32767
    return {"POSITION": g.accessor(corners, "h", normalized=True)}, {}


@pytest.mark.parametrize("kind", [sparse, morph, normalised])
def test_corners_of_gltf_are_where_the_format_puts_them(tmp_path, kind):
    g = Gltf()
    attributes, more = kind(g)
    g.mesh(CORNERS, FACES, attributes=attributes, **more)
    if kind is morph:
        g.content["meshes"][0]["weights"] = [1.0]
    g.content["nodes"].append({"mesh": 0, "scale": [5, 5, 5]} if kind is normalised else {"mesh": 0})
    read = read_mesh(g.write(tmp_path / "a.glb", [0]))
    assert read.vertices.max(axis=0) == pytest.approx([5, 5, 5], abs=1e-3)


def test_a_fan_of_gltf_beside_triangles_is_read(tmp_path):
    g = Gltf()
    g.mesh(CORNERS, FACES)
    fan = g.accessor([(9, 0, 0), (10, 0, 0), (10, 1, 0), (9, 1, 0)])
    g.content["meshes"][0]["primitives"].append({"attributes": {"POSITION": fan}, "mode": 6})
    g.content["nodes"].append({"mesh": 0})
    read = read_mesh(g.write(tmp_path / "a.glb", [0]))
    assert len(read.faces) == 14 and read.vertices[:, 0].max() == 10


PLY = """ply
format ascii 1.0
element vertex 4
property float x
property float y
property float z
element tristrips 1
property list int int vertex_indices
end_header
0 0 0
1 0 0
0 1 0
1 1 0
4 0 1 2 3
"""


def test_strips_of_ply_are_read_and_one_that_is_cut_short_is_refused(tmp_path):
    (tmp_path / "a.ply").write_text(PLY)
    assert len(read_mesh(tmp_path / "a.ply").faces) == 2
    (tmp_path / "a.ply").write_text(PLY[:-3])
    with pytest.raises(MachineError, match=r"mesh .*a.ply: damaged PLY .*cut short"):
        read_mesh(tmp_path / "a.ply")


def letters(names=("a", "b")):
    solids = []
    for n, name in enumerate(names):
        box = trimesh.creation.box(
            (1, 1, 1), transform=trimesh.transformations.translation_matrix((2 * n, 0, 0))
        )
        lines = trimesh.exchange.stl.export_stl_ascii(box).strip().splitlines()
        solids.append("\n".join([f"solid {name}", *lines[1:-1], f"endsolid {name}"]))
    return "\n".join(solids) + "\n"


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (lambda text: text, False),
        (lambda text: text.upper().replace("\n", "\r\n"), False),
        (lambda text: text.replace("solid a", "solid facet of solid"), False),
        (lambda text: text.replace("endsolid a\n", ""), False),
        (lambda text: text.replace("endsolid b\n", ""), True),
    ],
)
def test_all_solids_of_an_stl_in_letters_are_read_whether_or_not_they_end(tmp_path, change, said):
    (tmp_path / "a.stl").write_bytes(change(letters()).encode())
    read = read_mesh(tmp_path / "a.stl")
    assert len(read.faces) == 24 and len(read.vertices) == 16 and np.ptp(read.vertices[:, 0]) == 3
    assert len(room.read_mesh(tmp_path / "a.stl").objects) == 2
    assert read.notes == (("its last endsolid is missing: was it cut off?",) if said else ())


def test_marks_of_an_editor_and_facets_on_the_line_of_their_solid_are_none_of_its_name(tmp_path):
    (tmp_path / "a.stl").write_bytes(b"\xef\xbb\xbf" + letters(("a facet", "b")).encode())
    assert len(read_mesh(tmp_path / "a.stl").faces) == 24
    (tmp_path / "a.stl").write_text(" ".join(letters(("a",)).split()))
    assert len(read_mesh(tmp_path / "a.stl").faces) == 12


def test_a_last_solid_that_does_not_end_is_said_of_the_machine(tmp_path):
    (tmp_path / "a.stl").write_text(letters().replace("endsolid b\n", ""))
    with pytest.warns(MachineWarning, match=r"link a: <mesh .*a.stl.*its last endsolid is missing"):
        assert len(Machine.from_urdf(urdf(tmp_path, mesh_link("a.stl"))).links[0].faces) == 24


@pytest.mark.parametrize("share", [0.1, 0.37, 0.5, 0.93])
def test_an_stl_in_letters_that_ends_within_a_triangle_is_refused(tmp_path, share):
    text = letters()
    cut = text[: text.index("endloop", int(share * len(text)))]
    (tmp_path / "a.stl").write_text(cut)
    with pytest.raises(MachineError, match=r"begins \d+ triangles, of which \d+ are whole"):
        read_mesh(tmp_path / "a.stl")


def test_normals_of_an_stl_do_not_matter_and_corners_that_are_no_numbers_are_one_quiet_line(
    tmp_path, caplog, capfd
):
    text = letters()
    normals = "\n".join(
        "facet normal nan -nan(ind) inf" if line.strip().startswith("facet") else line
        for line in text.splitlines()
    )
    (tmp_path / "a.stl").write_text(normals)
    assert len(read_mesh(tmp_path / "a.stl").faces) == 24
    for bad, said in (("nan", "triangles with a corner that is no finite number"), ("0,5", "cannot be read")):
        (tmp_path / "a.stl").write_text(text.replace("vertex 0.5", f"vertex {bad}"))
        with pytest.raises(MachineError, match=said) as caught:
            read_mesh(tmp_path / "a.stl")
        assert "\n" not in str(caught.value)
    assert not caplog.records and capfd.readouterr() == ("", "")
