"""Meshes and solids of a URDF: files, units, scales, packages, pictures without a body."""

import warnings

import numpy as np
import pytest
import trimesh

from elbowroom.errors import MachineError, MachineWarning
from elbowroom.machine import Machine
from elbowroom.machine.mesh_file import read_mesh
from reference import machine_twins as naive
from reference.small_urdf import BOX, joint, mesh_link, stl_link, urdf

SHIFTED = np.array([[0, -1, 0, 1.0], [1, 0, 0, 2], [0, 0, 1, 0.5], [0, 0, 0, 1]])


@pytest.fixture(scope="module")
def arm(tmp_path_factory):
    path = tmp_path_factory.mktemp("arm") / "arm.urdf"
    path.write_text(naive.ARM)
    return Machine.from_urdf(path, world_from_base=SHIFTED, unchecked_links=("foot",))


def test_round_solids_lie_within_their_polyhedra(arm):
    upper = trimesh.Trimesh(arm.links[2].vertices, arm.links[2].faces)
    assert np.pi * 0.08**2 * 0.6 < upper.volume < 1.01 * np.pi * 0.08**2 * 0.6
    ball = list(trimesh.Trimesh(arm.links[3].vertices, arm.links[3].faces).split())[-1]
    to_faces = np.einsum("ij,ij->i", ball.face_normals, ball.triangles[:, 0] - (0.5, 0, 0))
    assert to_faces.min() >= 0.09 - 1e-9
    assert np.linalg.norm(ball.vertices - (0.5, 0, 0), axis=1).max() <= 0.0915


def test_a_mesh_in_millimetres_and_a_link_too_long_are_refused(tmp_path):
    with pytest.raises(MachineError, match=r'link a: .*300 m long.*scale="0.001 0.001 0.001" makes it 0.3 m'):
        Machine.from_urdf(urdf(tmp_path, stl_link(tmp_path, (300, 100, 60))))
    crane = BOX.replace("1 1 1", "30 6 6")
    with pytest.raises(MachineError, match=r"link a: .*30 m long, at most 20 m"):
        Machine.from_urdf(urdf(tmp_path, crane))
    assert Machine.from_urdf(urdf(tmp_path, crane), largest_link_m=40).checked_links == ("a",)


def test_a_small_part_in_millimetres_is_out_of_proportion(tmp_path):
    """A finger of 12 mm is 12 m long, no longer than a link may be."""
    base = BOX.replace("1 1 1", "0.3 0.3 0.3")
    at = '<origin xyz="0.4 0 0"/>'
    with pytest.raises(MachineError, match=r"link b: .*12 m long, the next one 0.3 m.*millimetres"):
        Machine.from_urdf(urdf(tmp_path, base + stl_link(tmp_path, (12, 3, 3), name="b") + joint(more=at)))
    rail = '<limit lower="0" upper="11"/>'
    long = Machine.from_urdf(
        urdf(
            tmp_path, base + stl_link(tmp_path, (12, 0.3, 0.3), name="b") + joint("prismatic", rail, more=at)
        )
    )
    assert long.checked_links == ("a", "b")


def test_a_mesh_in_another_unit_is_refused_with_the_units_that_it_may_have(tmp_path):
    said = r"50 m long.*centimetres: 0.01 0.5 m, inches: 0.0254 1.27 m"
    with pytest.raises(MachineError, match=said):
        Machine.from_urdf(urdf(tmp_path, stl_link(tmp_path, (50, 20, 20))))


@pytest.mark.parametrize("kind", ["stl", "ply", "obj"])
def test_a_mesh_with_a_corner_that_is_no_number_is_refused_and_not_read_without_it(tmp_path, kind):
    box = trimesh.creation.box((0.3, 0.1, 0.1))
    corners = box.vertices.copy()
    corners[0, 0] = np.nan
    trimesh.Trimesh(corners, box.faces, process=False, validate=False).export(tmp_path / f"a.{kind}")
    with pytest.raises(MachineError, match=r"link a: .*no finite number"):
        Machine.from_urdf(urdf(tmp_path, mesh_link(f"a.{kind}")))


def test_a_scale_that_differs_much_between_axes_is_said(tmp_path):
    with pytest.warns(MachineWarning, match="differs by a factor of 1000 between the axes"):
        Machine.from_urdf(urdf(tmp_path, stl_link(tmp_path, (0.3, 0.1, 0.1), ' scale="1 1 0.001"')))


def test_a_mesh_scaled_twice_is_said(tmp_path):
    with pytest.warns(MachineWarning, match="0.3 mm long; is its mesh scaled twice"):
        Machine.from_urdf(urdf(tmp_path, stl_link(tmp_path, (0.3, 0.1, 0.1), ' scale="0.001 0.001 0.001"')))


@pytest.mark.parametrize(
    ("edge", "scale", "said"),
    [
        (1.0, 0.0012, True),
        (0.4, 0.01, True),
        (8.0, 0.001, False),
        (1000.0, 0.001, False),
        (0.005, 1.0, False),
    ],
)
@pytest.mark.parametrize("beside", ["", "<collision><geometry><box size='.3 .3 .3'/></geometry></collision>"])
def test_a_moving_mesh_that_fits_the_machine_before_its_scale_and_not_after_it_is_said(
    tmp_path, edge, scale, said, beside
):
    """A beam of a metre became 1.2 mm; a screw of 8 mm, drawn in millimetres, is what it says."""
    small = stl_link(tmp_path, (edge, 0.1 * edge, 0.1 * edge), f' scale="{scale} {scale} {scale}"', name="b")
    small = small.replace("</link>", f"{beside}</link>")
    body = BOX.replace("1 1 1", "0.6 0.3 0.3") + small + joint(more='<origin xyz="0 0 1.1"/>')
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        found = Machine.from_urdf(urdf(tmp_path, body)).findings
    assert any("link b: <mesh" in each.text and "scaled twice" in each.text for each in found) is said


@pytest.mark.parametrize("scale", ["-1 1 1", "1 -2 1", "-1 -1 -1", "-1 -1 1", "2"])
def test_a_mirrored_mesh_keeps_its_surface_turned_outward(tmp_path, scale):
    link = Machine.from_urdf(urdf(tmp_path, stl_link(tmp_path, (1, 2, 3), f' scale="{scale}"'))).links[0]
    assert trimesh.Trimesh(link.vertices, link.faces).volume > 0


def test_scenes_of_glb_files_are_read_where_their_nodes_put_them(tmp_path):
    scene = trimesh.Scene()
    for n in range(2):
        scene.add_geometry(
            trimesh.creation.box((1, 1, 1)),
            transform=trimesh.transformations.translation_matrix((0, 0, 4 * n)),
        )
    for kind in ("glb", "gltf"):
        if kind == "glb":
            scene.export(tmp_path / "a.glb")
        else:
            for name, content in scene.export(file_type="gltf").items():
                (tmp_path / name.replace("model", "a")).write_bytes(content)
        link = Machine.from_urdf(urdf(tmp_path, mesh_link(f"a.{kind}"))).links[0]
        assert np.ptp(link.vertices, axis=0) == pytest.approx([1, 1, 5])


def test_packed_and_bent_gltf_is_refused_by_name(tmp_path):
    for said, document in (
        (
            "packed .KHR_draco_mesh_compression.; export it without",
            '{"asset": {"version": "2.0"}, "extensionsRequired": ["KHR_draco_mesh_compression"]}',
        ),
        ("bends by a skin", '{"asset": {"version": "2.0"}, "skins": [{"joints": [0]}]}'),
        ("damaged glTF", "{"),
    ):
        (tmp_path / "a.gltf").write_text(document)
        with pytest.raises(MachineError, match=said):
            Machine.from_urdf(urdf(tmp_path, mesh_link("a.gltf")))


@pytest.mark.parametrize("suffix", ["STL", "Obj", "PLY", "DAE"])
def test_suffixes_may_be_in_capital_letters(tmp_path, suffix):
    if suffix == "DAE":
        pytest.importorskip("collada")
    content = trimesh.creation.box((1, 2, 3)).export(file_type=suffix.lower())
    path = tmp_path / f"a.{suffix}"
    path.write_bytes(content if isinstance(content, bytes) else content.encode())
    link = Machine.from_urdf(urdf(tmp_path, mesh_link(path.name))).links[0]
    assert np.ptp(link.vertices, axis=0) == pytest.approx([1, 2, 3], abs=1e-5)


def test_a_stl_in_letters_and_one_that_only_says_so_are_read(tmp_path):
    box = trimesh.creation.box((1, 2, 3))
    (tmp_path / "a.stl").write_text(trimesh.exchange.stl.export_stl_ascii(box))
    binary = trimesh.exchange.stl.export_stl(box)
    (tmp_path / "b.stl").write_bytes(b"solid of a binary file".ljust(80) + binary[80:])
    for name in ("a.stl", "b.stl"):
        link = Machine.from_urdf(urdf(tmp_path, mesh_link(name))).links[0]
        assert np.ptp(link.vertices, axis=0) == pytest.approx([1, 2, 3])


@pytest.mark.parametrize("suffix", ["stl", "obj", "ply", "glb"])
def test_meshes_are_read_and_scaled(tmp_path, suffix):
    trimesh.creation.box((1, 2, 3)).export(tmp_path / f"a.{suffix}")
    path = urdf(tmp_path, mesh_link(f"a.{suffix}").replace("/></geo", ' scale="1 0.5 0.1"/></geo'))
    link = Machine.from_urdf(path).links[0]
    assert np.allclose(np.ptp(link.vertices, axis=0), (1, 1, 0.3), atol=1e-6)


def test_packages_are_found_above_the_urdf_in_named_folders_and_without_their_first_folders(tmp_path):
    box = trimesh.creation.box((1, 1, 1))
    for folder in ("robot/meshes", "elsewhere/tool/meshes", "robot/urdf"):
        (tmp_path / folder).mkdir(parents=True)
    box.export(tmp_path / "robot/meshes/a.stl")
    box.export(tmp_path / "elsewhere/tool/meshes/b.stl")
    for name in ("package://robot/meshes/a.stl", "package://far/away/robot/meshes/a.stl", "../meshes/a.stl"):
        assert Machine.from_urdf(urdf(tmp_path / "robot/urdf", mesh_link(name))).checked_links == ("a",)
    beside = urdf(tmp_path / "robot/urdf", mesh_link("package://tool/meshes/b.stl"))
    with pytest.raises(MachineError, match="missing"):
        Machine.from_urdf(beside)
    assert Machine.from_urdf(beside, package_dirs=[tmp_path / "elsewhere"]).checked_links == ("a",)


def test_a_visual_mesh_that_is_absent_does_not_matter_where_there_is_a_body(tmp_path):
    body = mesh_link("package://x/y/z.dae", "visual").replace("</link>", "") + BOX.split(">", 1)[1]
    assert Machine.from_urdf(urdf(tmp_path, body)).checked_links == ("a",)


def test_a_link_that_has_a_picture_and_no_body_is_refused_or_moves_without_one_by_somebodys_word(tmp_path):
    path = urdf(tmp_path, BOX + mesh_link("package://x/y/z.dae", "visual", "b") + joint())
    with pytest.raises(MachineError, match=r"line 1: link b: .*is missing; .*without_body"):
        Machine.from_urdf(path)
    machine = Machine.from_urdf(path, without_body=("b",))
    assert machine.checked_links == ("a",)
    assert machine.bodiless_links == ("b",)
    with pytest.raises(MachineError, match="link without body 'c' does not exist; links are a, b"):
        Machine.from_urdf(path, without_body=("c",))


@pytest.mark.parametrize("change", ["cut", "more", "no count"])
def test_a_binary_stl_of_another_length_than_it_says_is_named(tmp_path, change):
    whole = trimesh.creation.box((0.1, 0.1, 0.1)).export(file_type="stl")
    content = {
        "cut": whole[:-60],
        "more": whole + bytes(37),
        "no count": whole[:80] + bytes(4) + whole[84:],
    }[change]
    (tmp_path / "a.stl").write_bytes(content)
    with pytest.raises(MachineError, match=r"says that it has (12|0) triangles, and its .* bytes hold"):
        read_mesh(tmp_path / "a.stl")
