from dataclasses import replace

import numpy as np
import pytest
import trimesh
from hypothesis import given, settings
from hypothesis import strategies as st

from elbowroom.errors import MachineError, MachineWarning, PoseWarning
from elbowroom.machine import Machine
from elbowroom.machine.joint_state import JointTolerance
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
        ({**AT_REST, "follow": 0.5}, "follow: 0.5 m, but it follows grip, which puts it at"),
        ({**AT_REST, "follow": float("nan")}, "follow: position is not finite"),
        ({**AT_REST, "grip": [0.0, 0.1], "follow": [0.0, 0.1, 0.2]}, "is out of its limits|unlike lengths"),
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


def test_whole_joint_states_are_taken_with_followers_and_joints_of_other_machines(arm):
    state = {**AT_REST, "follow": -0.03, "wrist_of_another": 3.0}
    placed = arm.world_from_links(state)
    assert set(arm.checked(state)) == set(arm.joint_names)
    assert all(np.array_equal(placed[name], at) for name, at in arm.world_from_links(AT_REST).items())
    with pytest.raises(MachineError, match="no joint 'wrist_of_another'; joints are slide, elbow, grip"):
        arm.require_joints(state)


@pytest.mark.parametrize("way", [-1, 1])
def test_a_position_beyond_a_limit_by_little_is_taken_as_it_is(arm, way):
    over = np.radians(0.9)
    assert arm.checked({**AT_REST, "elbow": way * (2 + over)})["elbow"] == way * (2 + over)
    with pytest.raises(MachineError, match="out of its limits"):
        arm.checked({**AT_REST, "elbow": way * (2 + np.radians(1.1))})
    strict = replace(arm, tolerance=JointTolerance(rad=0.0, m=0.0))
    with pytest.raises(MachineError, match="out of its limits"):
        strict.checked({**AT_REST, "elbow": way * (2 + over)})


def two_fingers(folder, follower, leader=(0, 0.3), mimic='<mimic joint="j" multiplier="1" offset="0.02"/>'):
    limit = '<limit lower="{}" upper="{}"/>'
    second = joint("prismatic", limit.format(*follower), child="c", more=mimic).replace(
        '"j" type', '"k" type'
    )
    first = joint("prismatic", limit.format(*leader))
    return Machine.from_urdf(urdf(folder, BOX + '<link name="b"/><link name="c"/>' + first + second))


@settings(max_examples=30, deadline=None)
@given(st.floats(-1, 1), st.floats(0.1, 1), st.sampled_from([-2.0, -1.0, 0.5, 1.0]), st.floats(-0.2, 0.2))
def test_a_leader_ends_where_the_first_of_its_followers_ends(
    tmp_path_factory, lower, span, multiplier, offset
):
    mimic = f'<mimic joint="j" multiplier="{multiplier}" offset="{offset}"/>'
    machine = two_fingers(tmp_path_factory.mktemp("fingers"), (lower, lower + span), (-0.6, 0.7), mimic)
    leader = machine.joint("j")
    ends = multiplier * np.array([leader.lower, leader.upper]) + offset
    within = (ends >= lower - 1e-9).all() and (ends <= lower + span + 1e-9).all()
    # limits that no position of the leader meets cannot be meant, and are said
    assert within or any("leave no travel" in finding.text for finding in machine.findings)
    assert -0.6 <= leader.lower < leader.upper <= 0.7


def test_a_follower_that_ends_first_cuts_its_leader(tmp_path):
    machine = two_fingers(tmp_path, (0, 0.1))
    assert (machine.joint("j").lower, machine.joint("j").upper) == pytest.approx((0, 0.08))


@pytest.mark.parametrize(
    ("lower", "upper", "kept"), [("-inf", "inf", (-np.inf, np.inf)), ("0", "1e16", (0, np.inf))]
)
def test_limits_too_wide_to_be_any_are_none_and_said(tmp_path, lower, upper, kept):
    limit = f'<limit lower="{lower}" upper="{upper}"/>'
    for kind in ("revolute", "prismatic"):
        machine = Machine.from_urdf(urdf(tmp_path, BOX + '<link name="b"/>' + joint(kind, limit)))
        assert (machine.joint("j").lower, machine.joint("j").upper) == kept
        assert "taken for none" in machine.findings[0].text


def test_a_joint_whose_limits_are_both_zero_cannot_move_and_is_said(tmp_path):
    for limit in ('<limit lower="0" upper="0"/>', '<limit effort="1" velocity="1"/>'):
        machine = Machine.from_urdf(urdf(tmp_path, BOX + '<link name="b"/>' + joint(limit=limit)))
        assert "cannot move" in machine.findings[0].text


def stl_link(folder, size, scale="", name="a", kind="stl"):
    trimesh.creation.box(size).export(folder / f"{name}.{kind}")
    return mesh_link(f"{name}.{kind}", name=name).replace("/></geo", f"{scale}/></geo")


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


def test_a_mesh_scaled_twice_is_said(tmp_path):
    with pytest.warns(MachineWarning, match="0.3 mm long; is its mesh scaled twice"):
        Machine.from_urdf(urdf(tmp_path, stl_link(tmp_path, (0.3, 0.1, 0.1), ' scale="0.001 0.001 0.001"')))


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
            "KHR_draco_mesh_compression, which is not read",
            '{"extensionsRequired": ["KHR_draco_mesh_compression"]}',
        ),
        ("bends by a skin", '{"skins": [{"joints": [0]}]}'),
        ("no glTF", "{"),
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


def test_checked_joints_come_in_the_order_of_their_names_and_take_rounding(arm):
    checked = arm.checked({"grip": 0.0, "elbow": 2.0 + 1e-9, "slide": -0.5})
    assert list(checked) == list(arm.joint_names)


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
