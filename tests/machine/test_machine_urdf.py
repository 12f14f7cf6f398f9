import numpy as np
import pytest
import trimesh
from hypothesis import given, settings
from hypothesis import strategies as st

from elbowroom.errors import MachineError, PoseWarning
from elbowroom.machine import Machine
from reference import machine_twins as naive

AT_REST = {"slide": 0.0, "elbow": 0.0, "grip": 0.02}
SHIFTED = np.array([[0, -1, 0, 1.0], [1, 0, 0, 2], [0, 0, 1, 0.5], [0, 0, 0, 1]])


@pytest.fixture(scope="module")
def arm(tmp_path_factory):
    path = tmp_path_factory.mktemp("arm") / "arm.urdf"
    path.write_text(naive.ARM)
    return Machine.from_urdf(path, world_from_base=SHIFTED, unchecked_links=("foot",))


def urdf(folder, body, name="made.urdf"):
    path = folder / name
    path.write_text(f'<robot name="made">{body}</robot>')
    return path


BOX = '<link name="a"><collision><geometry><box size="1 1 1"/></geometry></collision></link>'


def mesh_link(filename, kind="collision", name="a"):
    return f'<link name="{name}"><{kind}><geometry><mesh filename="{filename}"/></geometry></{kind}></link>'


def joint(kind="revolute", limit='<limit lower="-1" upper="1"/>', axis="0 0 1", child="b", more=""):
    return (
        f'<joint name="j" type="{kind}"><parent link="a"/><child link="{child}"/><axis xyz="{axis}"/>{limit}'
        f"{more}</joint>"
    )


@pytest.mark.parametrize(("lower", "upper", "nearest"), [(-1, 1, 0), (0.5, 2, 0.5), (-3, -0.25, -0.25)])
def test_nearest_to_zero_keeps_to_the_limits(tmp_path, lower, upper, nearest):
    limit = f'<limit lower="{lower}" upper="{upper}"/>'
    made = Machine.from_urdf(urdf(tmp_path, BOX + '<link name="b"/>' + joint(limit=limit)))
    assert made.nearest_to_zero() == {"j": nearest}
    made.checked(made.nearest_to_zero())


def test_names_follow_the_tree_and_followers_are_not_commanded(arm):
    assert arm.link_names == ("foot", "flange", "upper", "fore", "left", "right")
    assert arm.joint_names == ("slide", "elbow", "grip")
    assert [j.name for j in arm.joints] == ["slide", "elbow", "grip", "follow"]
    assert arm.checked_links == ("upper", "fore", "left", "right")
    assert arm.joint("slide").unit == "m"
    assert arm.joint("elbow").unit == "rad"
    assert np.allclose(arm.joint("slide").axis_in_joint, (1, 0, 0))


def test_moved_links_are_those_downstream_with_those_of_followers(arm):
    assert arm.moved_links("slide") == ("flange", "upper", "fore", "left", "right")
    assert arm.moved_links("grip") == ("left", "right")


@settings(max_examples=20, deadline=None)
@given(st.floats(-0.5, 0.5), st.floats(-2, 2), st.floats(0, 0.04))
def test_links_are_where_the_matrix_exponential_puts_them(arm, slide, elbow, grip):
    joints = {"slide": slide, "elbow": elbow, "grip": grip}
    expected = naive.world_from_links(arm, joints)
    for name, placed in arm.world_from_links(joints).items():
        assert np.allclose(placed, expected[name], atol=1e-12)


def test_many_configurations_are_each_as_alone(arm):
    slides = np.linspace(-0.5, 0.5, 7)
    many = arm.world_from_links({"slide": slides, "elbow": 0.3, "grip": 0.01})
    for n, slide in enumerate(slides):
        alone = arm.world_from_links({"slide": slide, "elbow": 0.3, "grip": 0.01})
        assert all(np.array_equal(many[name][n], alone[name]) for name in arm.link_names)
    assert many["fore"].shape == (7, 4, 4)


def test_round_solids_lie_within_their_polyhedra(arm):
    upper = trimesh.Trimesh(arm.links[2].vertices, arm.links[2].faces)
    assert np.pi * 0.08**2 * 0.6 < upper.volume < 1.01 * np.pi * 0.08**2 * 0.6
    ball = list(trimesh.Trimesh(arm.links[3].vertices, arm.links[3].faces).split())[-1]
    to_faces = np.einsum("ij,ij->i", ball.face_normals, ball.triangles[:, 0] - (0.5, 0, 0))
    assert to_faces.min() >= 0.09 - 1e-9
    assert np.linalg.norm(ball.vertices - (0.5, 0, 0), axis=1).max() <= 0.0915


@pytest.mark.parametrize(
    ("joints", "message"),
    [
        ({"slide": 0.0, "elbow": 0.0}, "'grip' has no position"),
        ({**AT_REST, "wrist": 0.0}, "no joint 'wrist'; joints are slide, elbow, grip"),
        ({**AT_REST, "follow": 0.0}, "no joint 'follow'"),
        ({**AT_REST, "slide": float("nan")}, "slide: position is not finite"),
        ({**AT_REST, "slide": 0.7}, r"slide: 0.7 m is out of its limits, -0.5 to 0.5 m"),
        ({**AT_REST, "elbow": -3}, r"elbow: -3 rad is out of its limits, -2 to 2 rad"),
        ({**AT_REST, "elbow": [0.0, 2.5]}, r"elbow: 2.5 rad is out"),
        ({**AT_REST, "elbow": "left"}, "elbow: 'left' is not a number"),
        ({**AT_REST, "elbow": [0.0, 1.0], "slide": [0.0, 0.1, 0.2]}, "unlike lengths"),
    ],
)
def test_impossible_joints_are_named(arm, joints, message):
    with pytest.raises(MachineError, match=message):
        arm.world_from_links(joints)


def test_checked_joints_come_in_the_order_of_their_names_and_take_rounding(arm):
    checked = arm.checked({"grip": 0.0, "elbow": 2.0 + 1e-9, "slide": -0.5})
    assert list(checked) == list(arm.joint_names)


@pytest.mark.parametrize(
    ("content", "message"),
    [
        ("not XML at all", "not XML"),
        ("<sdf/>", "outermost element is <sdf>"),
        ('<robot name="r"><link name="a"/></robot>', "no link has a mesh"),
        ("<robot/>", "not a complete URDF"),
    ],
)
def test_files_that_are_no_machine_are_refused(tmp_path, content, message):
    path = tmp_path / "bad.urdf"
    path.write_text(content)
    with pytest.raises(MachineError, match=message):
        Machine.from_urdf(path)


@pytest.mark.parametrize(
    ("body", "message"),
    [
        (BOX + BOX, "link 'a' is there twice"),
        (BOX + '<link name="b"/>', "one tree; without a parent are: a, b"),
        (BOX + joint(child="c"), "names link 'c'"),
        (BOX + '<link name="b"/>' + joint("screw"), "'screw'; allowed are fixed, prismatic"),
        (BOX + '<link name="b"/>' + joint(limit=""), "needs <limit"),
        (
            BOX + '<link name="b"/>' + joint(limit='<limit lower="1" upper="-1"/>'),
            "must be finite and rising",
        ),
        (BOX + '<link name="b"/>' + joint(axis="0 0 0"), "axis"),
        (BOX + '<link name="b"/>' + joint(more='<mimic joint="k"/>'), "mimics 'k', which leads nowhere"),
        (BOX.replace("1 1 1", "1 0 1"), "above 0"),
        (mesh_link("package://robot/meshes/a.stl"), "link a: mesh 'package://robot/meshes/a.stl' is missing"),
        (mesh_link("bent.stl"), "cannot be read|no triangles"),
        (mesh_link("a.step"), "unknown kind"),
    ],
)
def test_what_a_urdf_may_not_say_is_named(tmp_path, body, message):
    (tmp_path / "bent.stl").write_bytes(b"solid nothing\nendsolid\n")
    (tmp_path / "a.step").write_bytes(b"")
    with pytest.raises(MachineError, match=message):
        Machine.from_urdf(urdf(tmp_path, body))


def test_a_missing_file_an_unknown_unchecked_link_and_a_bent_base_are_refused(tmp_path):
    with pytest.raises(MachineError, match="no such file"):
        Machine.from_urdf(tmp_path / "none.urdf")
    path = urdf(tmp_path, BOX)
    with pytest.raises(MachineError, match="unchecked link 'rail' does not exist; links are a"):
        Machine.from_urdf(path, unchecked_links=("rail",))
    with pytest.raises(MachineError, match="not rigid"):
        Machine.from_urdf(path, world_from_base=np.diag([1.1, 1, 1, 1]))
    with pytest.warns(PoseWarning):
        Machine.from_urdf(path, world_from_base=np.diag([1.0001, 1, 1, 1]))


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


def test_a_visual_mesh_that_is_absent_does_not_matter(tmp_path):
    body = mesh_link("package://x/y/z.dae", "visual").replace("</link>", "") + BOX.split(">", 1)[1]
    assert Machine.from_urdf(urdf(tmp_path, body)).checked_links == ("a",)
    only_visual = BOX + mesh_link("package://x/y/z.dae", "visual", "b") + joint()
    assert Machine.from_urdf(urdf(tmp_path, only_visual)).checked_links == ("a",)


def test_a_six_axis_arm_agrees_with_pinocchio(data_folder):
    pin = pytest.importorskip("pinocchio")
    path = data_folder("robots") / "ur5_urdf/urdf/ur5_robot.urdf"
    machine = Machine.from_urdf(path)
    assert len(machine.joint_names) == 6
    assert len(machine.checked_links) == 8
    model = pin.buildModelFromUrdf(str(path))
    data = model.createData()
    positions = np.random.default_rng(7).uniform(-3, 3, (20, 6))
    placed = machine.world_from_link_array(positions)
    assert tuple(model.names[1:]) == machine.joint_names
    for row, position in zip(placed, positions, strict=True):
        pin.framesForwardKinematics(model, data, position)
        for name, here in zip(machine.link_names, row, strict=True):
            assert np.abs(data.oMf[model.getFrameId(name)].homogeneous - here).max() < 1e-9


def test_an_arm_with_a_gripper_is_read_without_its_visual_meshes(data_folder):
    machine = Machine.from_urdf(data_folder("robots") / "panda_urdf/urdf/panda.urdf")
    assert machine.joint_names[-1] == "panda_finger_joint1"
    assert machine.moved_links("panda_finger_joint1") == ("panda_leftfinger", "panda_rightfinger")
