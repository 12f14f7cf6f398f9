"""Where the files that a description names are looked for, and that none of another package is taken."""

import pytest
import trimesh

from elbowroom.errors import MachineError
from elbowroom.machine import Machine
from elbowroom.machine.description import packages as at

LINK = '<link name="{0}"><collision><geometry><mesh filename="{1}"/></geometry></collision></link>'
FIXED = '<joint name="f" type="fixed"><parent link="a"/><child link="b"/></joint>'


@pytest.fixture(autouse=True)
def no_ros(monkeypatch):
    for variable in (*at.FOLDERS_OF_PACKAGES, *at.INSTALLED):
        monkeypatch.delenv(variable, raising=False)


def robot(folder, *filenames):
    folder.mkdir(parents=True, exist_ok=True)
    path = folder / "arm.urdf"
    links = "".join(LINK.format(name, file) for name, file in zip("ab", filenames, strict=False))
    path.write_text(f'<robot name="arm">{links}{FIXED if len(filenames) > 1 else ""}</robot>')
    return path


def mesh(path, edge=1.0):
    path.parent.mkdir(parents=True, exist_ok=True)
    trimesh.creation.box((edge, edge, edge)).export(path)
    return path


def manifest(folder, name):
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "package.xml").write_text(f"<package><name>{name}</name></package>")


def edge_of(machine, link=0):
    return machine.links[link].vertices[:, 0].max() * 2


def test_a_package_is_found_by_its_manifest_also_in_a_folder_of_another_name(tmp_path):
    manifest(tmp_path / "my-fork", "arm_description")
    mesh(tmp_path / "my-fork/meshes/a.stl")
    path = robot(tmp_path / "my-fork/urdf", "package://arm_description/meshes/a.stl")
    assert Machine.from_urdf(path).checked_links == ("a",)


@pytest.mark.parametrize(
    ("variable", "below"),
    [("ROS_PACKAGE_PATH", "src/robots"), ("GAZEBO_MODEL_PATH", ""), ("AMENT_PREFIX_PATH", "share")],
)
def test_packages_are_found_where_ros_keeps_them(tmp_path, monkeypatch, variable, below):
    mesh(tmp_path / "keeps" / below / "arm_description/meshes/a.stl")
    scheme = "model" if variable.startswith("GAZEBO") else "package"
    path = robot(tmp_path / "elsewhere", f"{scheme}://arm_description/meshes/a.stl")
    with pytest.raises(MachineError, match=r"no package 'arm_description'.*package_dirs"):
        Machine.from_urdf(path)
    monkeypatch.setenv(variable, f"/nowhere:{tmp_path / 'keeps'}")
    assert Machine.from_urdf(path).checked_links == ("a",)


def test_named_folders_come_before_those_above_the_urdf(tmp_path):
    mesh(tmp_path / "arm/meshes/a.stl", edge=1.0)
    mesh(tmp_path / "other/arm/meshes/a.stl", edge=2.0)
    path = robot(tmp_path / "arm/urdf", "package://arm/meshes/a.stl")
    assert edge_of(Machine.from_urdf(path)) == pytest.approx(1.0)
    assert edge_of(Machine.from_urdf(path, package_dirs=[tmp_path / "other"])) == pytest.approx(2.0)


def test_a_robot_copied_out_of_its_package_is_found_and_said(tmp_path):
    mesh(tmp_path / "copied/meshes/a.stl")
    machine = Machine.from_urdf(robot(tmp_path / "copied/urdf", "package://arm_description/meshes/a.stl"))
    (finding,) = machine.findings
    assert finding.kind == "package"
    assert finding.about == ("a",)
    assert "no folder of package 'arm_description'" in finding.text
    assert not finding.stops


@pytest.mark.parametrize("folder", ["arm_description", "share/arm"])
def test_never_another_packages_file_of_the_same_name(tmp_path, folder):
    """Neither by its manifest, nor by its name, nor by where it is installed."""
    mesh(tmp_path / folder / "meshes/a.stl")
    path = robot(tmp_path / folder / "urdf", "package://tool_description/meshes/a.stl")
    with pytest.raises(MachineError, match=r"lies in package 'arm.*not 'tool_description'"):
        Machine.from_urdf(path)


def test_a_manifest_tells_another_package_whatever_its_folder_is_called(tmp_path):
    manifest(tmp_path / "checkout", "arm_description")
    mesh(tmp_path / "checkout/meshes/a.stl")
    path = robot(tmp_path / "checkout/urdf", "package://tool_description/meshes/a.stl")
    with pytest.raises(MachineError, match="lies in package 'arm_description', not 'tool_description'"):
        Machine.from_urdf(path)


def test_one_file_does_not_stand_in_for_two_packages(tmp_path):
    mesh(tmp_path / "copied/meshes/a.stl")
    both = ("package://arm/meshes/a.stl", "package://tool/meshes/a.stl")
    with pytest.raises(MachineError, match=r"link b: .*lies in package 'arm', not 'tool'"):
        Machine.from_urdf(robot(tmp_path / "copied/urdf", *both))


def test_a_package_that_is_there_and_lacks_the_file_is_not_left_for_another(tmp_path):
    mesh(tmp_path / "robot/meshes/a.stl")
    (tmp_path / "robot/tool").mkdir()
    with pytest.raises(MachineError, match=r"is missing; no file .*tool"):
        Machine.from_urdf(robot(tmp_path / "robot/urdf", "package://tool/meshes/a.stl"))


def test_all_links_that_lost_their_mesh_are_named_at_once(tmp_path):
    path = robot(tmp_path, "package://x/a.stl", "package://x/b.stl")
    with pytest.raises(MachineError, match=r"line 1: link a: .*links b lost theirs too; .*without_body"):
        Machine.from_urdf(path)


def test_file_urls_are_read_with_percent_signs(tmp_path):
    file = mesh(tmp_path / "my meshes/ä.STL")
    for name in (
        file.as_uri(),
        f"file://{file}",
        f"file://localhost{file}",
        "my%20meshes/ä.STL",
        "my meshes\\ä.STL",
    ):
        assert Machine.from_urdf(robot(tmp_path, name)).checked_links == ("a",)


@pytest.mark.parametrize(
    ("above", "loads"), [("urdf_models", True), ("robot_description", True), ("tool_models", False)]
)
def test_a_folder_of_many_robots_is_no_other_robots_package(tmp_path, above, loads):
    mesh(tmp_path / above / "arm/meshes/a.stl")
    path = robot(tmp_path / above / "arm", "package://arm_support/meshes/a.stl")
    if loads:
        assert Machine.from_urdf(path).checked_links == ("a",)
    else:
        with pytest.raises(MachineError, match="lies in package 'tool_models'"):
            Machine.from_urdf(path)


@pytest.mark.parametrize("filename", ["package:///a.stl", "package://a.stl", "package:///meshes/b%20b.stl"])
def test_a_package_without_a_name_is_the_folder_of_the_urdf_and_it_is_said(tmp_path, filename):
    mesh(tmp_path / "a.stl")
    mesh(tmp_path / "meshes/b b.stl")
    machine = Machine.from_urdf(robot(tmp_path, filename))
    (finding,) = machine.findings
    assert machine.checked_links == ("a",) and "names no package" in finding.text


@pytest.mark.parametrize(
    ("filename", "message"),
    [
        ("package:///gone.stl", "must be a package's name"),
        ("http://example.org/a.stl", "http:// is not read"),
        ("A.STL", "but a.stl: capital letters count"),
        ("package://arm/../../a.stl", "must be a package's name and a path inside it"),
        ("package://arm", "must be a package's name"),
        ("", "has no filename"),
        ("a.step", "unknown kind"),
        ("pointer.stl", "pointer of Git LFS"),
    ],
)
def test_what_cannot_be_found_is_said(tmp_path, filename, message):
    mesh(tmp_path / "a.stl")
    (tmp_path / "a.step").write_text("x")
    (tmp_path / "pointer.stl").write_text(
        "version https://git-lfs.github.com/spec/v1\noid sha256:0\nsize 1\n"
    )
    with pytest.raises(MachineError, match=message):
        Machine.from_urdf(robot(tmp_path, filename))
