"""A URDF as a whole: what is refused, what is noticed, and other readers beside this one."""

import numpy as np
import pytest

from elbowroom.errors import MachineError, MachineWarning, PoseWarning
from elbowroom.machine import Machine
from reference import machine_twins as naive
from reference.small_urdf import BOX, joint, mesh_link, urdf

SHIFTED = np.array([[0, -1, 0, 1.0], [1, 0, 0, 2], [0, 0, 1, 0.5], [0, 0, 0, 1]])


@pytest.fixture(scope="module")
def arm(tmp_path_factory):
    path = tmp_path_factory.mktemp("arm") / "arm.urdf"
    path.write_text(naive.ARM)
    return Machine.from_urdf(path, world_from_base=SHIFTED, unchecked_links=("foot",))


def test_origins_and_limits_in_other_units_are_noticed(tmp_path):
    far = '<origin xyz="0 0 340"/>'
    shape = BOX.replace("<geo", f"{far}<geo")
    with pytest.raises(MachineError, match=r"link a: .*lies 33\d.* m from its link's own frame"):
        Machine.from_urdf(urdf(tmp_path, shape))
    arm = BOX + BOX.replace('"a"', '"b"') + BOX.replace('"a"', '"c"') + joint()
    second = joint(child="c", more=far).replace('"j"', '"k"').replace('"a"', '"b"')
    with pytest.raises(
        MachineError, match="joint k: lies 340 m from the frame of b; is its origin in millimetres"
    ):
        Machine.from_urdf(urdf(tmp_path, arm + second))
    for kind, limit, unit in (("revolute", 170, "degrees"), ("prismatic", 400, "millimetres")):
        wide = f'<limit lower="0" upper="{limit}"/>'
        with pytest.warns(MachineWarning, match=f"are they in {unit}"):
            Machine.from_urdf(urdf(tmp_path, BOX + '<link name="b"/>' + joint(kind, wide)))


def test_links_and_bodies_agree_with_another_reader(tmp_path):
    yourdfpy = pytest.importorskip("yourdfpy")
    path = tmp_path / "arm.urdf"
    path.write_text(naive.ARM)
    robot = yourdfpy.URDF.load(str(path), load_meshes=False, build_scene_graph=False).robot
    machine = Machine.from_urdf(path)
    assert set(machine.link_names) == {link.name for link in robot.links}
    assert {link.name for link in machine.links if link.has_geometry} == {
        link.name for link in robot.links if link.collisions or link.visuals
    }
    by_name = {joint.name: joint for joint in robot.joints}
    for own in machine.joints:
        assert np.allclose(
            own.parent_from_joint, np.eye(4) if by_name[own.name].origin is None else by_name[own.name].origin
        )


@pytest.mark.parametrize(
    ("content", "message"),
    [
        ("not XML at all", "not XML"),
        ("<sdf/>", "outermost element is <sdf>"),
        ('<robot name="r"><link name="a"/></robot>', "no link has a mesh"),
        ("<robot/>", "the robot has no <link>"),
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
            "must rise",
        ),
        (BOX + '<link name="b"/>' + joint(axis="0 0 0"), "axis"),
        (BOX + '<link name="b"/>' + joint(more='<mimic joint="k"/>'), "mimics 'k', which leads nowhere"),
        (BOX.replace("1 1 1", "1 0 1"), "above 0"),
        (
            mesh_link("package://robot/meshes/a.stl"),
            "link a: .*: mesh 'package://robot/meshes/a.stl' is missing",
        ),
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
