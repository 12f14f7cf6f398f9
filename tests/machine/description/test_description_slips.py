"""Slips of published URDFs: harmless ones pass with a warning, the others are named with their place."""

import warnings

import numpy as np
import pytest

from elbowroom.errors import MachineError, MachineWarning
from elbowroom.machine import Machine

BOX = "<geometry><box size='1 1 1'/></geometry>"
TWO = "<geometry><box size='1 1 1'/><sphere radius='2'/></geometry>"
BODY = f"<link name='a'><collision>{BOX}</collision></link>"
ON_WORLD = "<joint name='j' type='fixed'><parent link='world'/><child link='a'/></joint>"
WITH_B = BODY + f"<link name='b'><collision>{BOX}</collision></link>"
JOINT = "<joint name='j' type='{type}'><parent link='a'/><child link='b'/>{more}</joint>"


def machine_of(folder, text):
    path = folder / "made.urdf"
    path.write_bytes(text if isinstance(text, bytes) else text.encode())
    return Machine.from_urdf(path)


def robot_of(*parts, body=""):
    """A robot of one link, of some elements in its collision, or of a body of its own."""
    link = f"<link name='a'><collision>{''.join(parts)}</collision></link>" if parts else ""
    return f"<robot name='r'>{body}{link}</robot>"


def joint_of(attributes, ends):
    return robot_of(body=f"{WITH_B}<joint {attributes}>{ends}</joint>")


def with_joint(more="", kind="revolute"):
    return f"<robot name='r'>{WITH_B}{JOINT.format(type=kind, more=more)}</robot>"


def with_shape(shape):
    return f"<robot name='r'>\n<link name='a'><collision><geometry>\n{shape}</geometry></collision></link></robot>"


@pytest.mark.parametrize(
    ("text", "said"),
    [
        (f"\n\n<?xml version='1.0'?>\n<robot name='r'>{BODY}</robot>", "blank lines"),
        (f"<!-- made by hand -->\n<?xml version='1.0'?>\n<robot name='r'>{BODY}</robot>", "comments stand before"),
        (f"<robot name='r'>{BODY}<drake:x/></robot>", "line 1: a prefix is not declared"),
        (f"<?xml version='0.0' ?><robot name='r'>{BODY}</robot>", "no XML of version '0.0'"),
        (f"<robot name='r'><!-- a -- b -->{BODY}</robot>", "two hyphens"),
        (f"<?xml version='1.0' encoding='utf-8'?>{robot_of(BOX)}<!-- \xfc -->".encode("latin-1"), "Latin-1"),
        (f"<robot>{BODY}</robot>", "<robot> has no name; it is called made"),
        (robot_of(TWO), "2 shapes"),
        (with_shape("<box size='1, 1, 1'/>"), "commas after them are passed over"),
        (robot_of("<origin rpy='90 0 0'/>", BOX), "are these degrees"),
        (f"<robot name='r'>{BODY}{ON_WORLD}</robot>", "hangs on link 'world', which the file does not have"),
    ],
)  # fmt: skip
def test_harmless_slips_pass_with_a_warning(tmp_path, text, said):
    with pytest.warns(MachineWarning, match=said):
        machine = machine_of(tmp_path, text)
    assert machine.links[-1].has_geometry
    assert any(said in finding.text for finding in machine.findings)


def test_a_byte_order_mark_a_default_namespace_and_no_declaration_are_nothing_to_speak_of(tmp_path):
    for text in (
        b"\xef\xbb\xbf<?xml version='1.0'?><robot name='r'>" + BODY.encode() + b"</robot>",
        f"<robot name='r' xmlns='http://www.ros.org'>{BODY}</robot>",
        f"<?xml version='1.0' encoding='utf-16'?><robot name='r'>{BODY}</robot>".encode("utf-16"),
    ):
        assert machine_of(tmp_path, text).findings == ()


def test_lines_are_counted_from_the_files_beginning(tmp_path):
    text = f"\n\n\n<?xml version='1.0'?>\n<robot name='r'>\n{BODY.replace('1 1 1', '1 1')}</robot>"
    with pytest.raises(
        MachineError, match=r"made.urdf: line 6: link a: <box size=\"1 1\">: size holds 2 numbers"
    ):
        machine_of(tmp_path, text)


@pytest.mark.parametrize(
    ("shape", "message"),
    [
        ("<box size='1 1'/>", "line 3: link a: <box.*size holds 2 numbers; expected three numbers"),
        ("<box size='1 1 1 1'/>", "holds 4 numbers"),
        ("<box/>", "size is missing"),
        ("<box size='1 1 x'/>", "'x' is no number"),
        ("<box size='0,5 1 1'/>", "'0,5' holds a comma"),
        ("<box size='1 1 nan'/>", "not finite"),
        ("<box size='1 1 1_0'/>", "is no number"),
        ("<box size='1 -1 1'/>", "a size is negative"),
        ("<box size='1 1 0'/>", "a size is 0"),
        ("<sphere radius='1 1'/>", "radius holds 2 numbers; expected one number"),
        ("<sphere/>", "radius is missing"),
        ("<cylinder radius='1'/>", "length is missing"),
        ("<cylinder radius='0' length='1'/>", "a size is 0"),
        ("<mesh/>", "has no filename"),
        ("<mesh filename='a.stl' scale='1 1'/>", "scale holds 2 numbers"),
        ("<mesh filename='a.stl' scale='1 1 1 1'/>", "scale holds 4 numbers"),
        ("<mesh filename='a.stl' scale=''/>", "scale holds 0 numbers"),
        ("<mesh filename='a.stl' scale='1 0 1'/>", "a scale of 0"),
        ("<mesh filename='a.stl' scale='1 nan 1'/>", "not finite"),
        ("<plane normal='0 0 1'/>", "no kind that is read; allowed are mesh"),
        ("", "<geometry>: is empty"),
    ],
)
def test_geometry_that_is_not_usable_is_named_with_its_place(tmp_path, shape, message):
    with pytest.raises(MachineError, match=message):
        machine_of(tmp_path, with_shape(shape))


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("<robot name='r'>\n<link><collision/></link></robot>", "line 2: a link without a name"),
        ("<robot name='r'><link name='a'><collision/></link></robot>", "link a: <collision>: holds no <geometry>"),
        (f"<robot name='r'>{BODY}{BODY}</robot>", "link 'a' is there twice, also in line 1"),
        (joint_of("name='j' type='fixed'", "<child link='b'/>"), "joint j: <parent"),
        (joint_of("name='j'", "<parent link='a'/><child link='b'/>"), "type is missing"),
        (joint_of("type='fixed'", "<parent link='a'/><child link='b'/>"), "a joint without"),
        (with_joint().replace("<parent link='a'/>", "<parent/>"), "<parent>: link is missing"),
        (with_joint("<limit lower='x' upper='1'/>"), "lower: 'x' is no number"),
        (with_joint("<limit lower='-1' upper='nan'/>"), "not finite"),
        (with_joint("<limit lower='1' upper='-1'/>"), "limits 1 to -1 must rise; are they exchanged"),
        (with_joint(), "a revolute joint needs <limit"),
        (with_joint("<axis xyz='1 0'/><limit lower='0' upper='1'/>"), "<axis xyz=\"1 0\">: xyz holds 2"),
        (with_joint("<limit lower='0' upper='1'/><limit lower='0' upper='2'/>"), "a second limit"),
        (with_joint("<limit lower='0' upper='1'/><mimic/>"), "<mimic>: joint is missing"),
        (with_joint("<limits lower='0' upper='1'/>"), "<limits.*is limit meant"),
        (f"<robot name='r'><link name='a'><colision>{BOX}</colision></link></robot>", "is collision meant"),
        (robot_of("<orgin xyz='1 0 0'/>", BOX), "is origin meant"),
        (robot_of("<origin xzy='1 0 0'/>", BOX), "xzy is no attribute"),
        (robot_of("<origin xyz='1 0 0'/><origin/>", BOX), "a second origin"),
        (f"<robot name='r'>{BODY}<group>{BODY.replace(repr('a'), repr('c'))}</group></robot>", "stands in <group>"),
        (f"<robot name='r'>{BODY}<collision>{BOX}</collision></robot>", "belongs into a <link>"),
        (f"<robot name='r'><link name='a'>{BOX}</link></robot>", "geometry belongs into <collision>"),
        (f"<robot name='r'>\n{BODY}", "not XML"),
        ("<robot name='r'/>", "the robot has no <link>"),
        (robot_of(body=BODY.replace("<coll", "<origin xyz='0 0 1'/><coll")), "<origin.*nothing reads it"),
        (robot_of(body=BODY.replace("<coll", "<pose>0 0 1 0 0 0</pose><coll")), "<pose>: stands in <link>"),
        (with_joint("<limit lower='0' upper='1'/><pose>0 0 1 0 0 0</pose>"), "<pose>: stands in <joint>"),
        (with_joint("<limit lower='0' upper='1'/><mimic joint='k' ratio='2'/>"), "ratio is no attribute of a mimic"),
        (with_shape("<mesh filename='a.stl' unit='mm'/>"), "unit is no attribute of a mesh"),
        (with_shape("<mesh filename='a.stl' Scale='.1 .1 .1'/>"), "Scale is no attribute of a mesh"),
        (b"", "is empty; expected a URDF"),
        ("<sdf/>", "this is SDF"),
        ("<mujoco/>", "this is MJCF"),
    ],
)  # fmt: skip
def test_slips_that_lose_something_are_named_with_their_place(tmp_path, text, message):
    with pytest.raises(MachineError, match=message):
        machine_of(tmp_path, text)


def test_a_sphere_without_size_marks_a_frame_and_the_picture_is_taken_for_the_body(tmp_path):
    point = "<collision><geometry><sphere radius='0'/></geometry></collision>"
    with pytest.warns(MachineWarning, match="link [bc]: .*a point without size"):
        machine = machine_of(
            tmp_path,
            f"<robot name='r'>{BODY}<link name='b'>{point}</link><link name='c'>{point}<visual>{BOX}</visual></link>"
            + JOINT.format(type="fixed", more="")
            + JOINT.format(type="fixed", more="").replace("'j'", "'k'").replace("'b'", "'c'")
            + "</robot>",
        )
    assert machine.checked_links == ("a", "c")


def test_a_pose_of_a_frame_without_a_body_and_one_that_says_nothing_pass(tmp_path):
    frame = "<link name='b'><origin xyz='1 0 0'/></link>"
    still = f"<link name='a'><origin xyz='0 0 0' rpy='0 -0 0'/><collision>{BOX}</collision></link>"
    machine = machine_of(
        tmp_path, f"<robot name='r'>{still}{frame}{JOINT.format(type='fixed', more='')}</robot>"
    )
    assert machine.checked_links == ("a",) and not machine.findings


def test_all_shapes_of_one_geometry_count(tmp_path):
    text = robot_of(TWO.replace("sphere radius='2'", "box size='4 .1 .1'"))
    with pytest.warns(MachineWarning, match="all of them are taken"):
        machine = machine_of(tmp_path, text)
    assert np.ptp(machine.links[0].vertices, axis=0) == pytest.approx([4, 1, 1])


def test_a_pose_may_be_a_quaternion(tmp_path):
    origin = "<origin xyz='1 2 3' quat_xyzw='0 0 0.70710678 0.70710678'/>"
    shape = f"{origin}<geometry><box size='2 4 6'/></geometry>"
    machine = machine_of(
        tmp_path, f"<robot name='r'><link name='a'><collision>{shape}</collision></link></robot>"
    )
    assert machine.links[0].vertices.mean(axis=0) == pytest.approx([1, 2, 3])
    assert np.ptp(machine.links[0].vertices, axis=0) == pytest.approx([4, 2, 6])


def test_a_capsule_contains_what_is_within_its_radius_of_its_line(tmp_path):
    machine = machine_of(tmp_path, with_shape("<capsule radius='0.1' length='0.5'/>"))
    import trimesh

    body = trimesh.Trimesh(machine.links[0].vertices, machine.links[0].faces)
    assert body.extents == pytest.approx([0.2, 0.2, 0.7], abs=0.003)
    turns = np.linspace(0, 2 * np.pi, 7)
    rim = np.column_stack([0.1 * np.cos(turns), 0.1 * np.sin(turns), np.full(7, 0.25)])
    to_faces = np.einsum("ij,kij->ki", body.face_normals, rim[:, None] - body.triangles[:, 0][None])
    assert to_faces.max() < 1e-9


def test_a_link_that_moves_with_a_mass_and_without_geometry_is_said(tmp_path):
    joint = '<joint name="j" type="revolute"><parent link="a"/><child link="{}"/><limit lower="-1" upper="1"/></joint>'
    body = '<link name="a"><collision><geometry><box size="1 1 1"/></geometry></collision></link>'
    for mass, said in (("3.2", True), ("0.001", False), ("much", False)):
        text = f'{body}<link name="b"><inertial><mass value="{mass}"/></inertial></link>{joint.format("b")}'
        (tmp_path / "r.urdf").write_text(f'<robot name="r">{text}</robot>')
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            found = Machine.from_urdf(tmp_path / "r.urdf").findings
        assert any("without any geometry: b 3.2 kg;" in each.text for each in found) is said


def test_a_slip_is_said_once_and_a_ring_and_an_include_are_named(tmp_path):
    path = tmp_path / "r.urdf"
    joint = (
        '<joint name="{}" type="fixed"><parent link="{}"/><child link="{}"/><origin xyz="0, 0, 1"/></joint>'
    )
    body = '<link name="{}"><collision><geometry><box size="1 1 1"/></geometry></collision></link>'
    bodies = body.format("a") + body.format("b")
    path.write_text(f'<robot name="r">{bodies}{joint.format("j", "a", "b")}</robot>')
    with pytest.warns(MachineWarning, match="commas"):
        assert len(Machine.from_urdf(path).findings) == 1
    ring = joint.format("j", "a", "b") + joint.format("k", "b", "a")
    path.write_text(f'<robot name="r">{bodies}{ring}</robot>')
    with pytest.raises(MachineError, match="in a ring"):
        Machine.from_urdf(path)
    include = '<xi:include href="x" xmlns:xi="http://www.w3.org/2001/XInclude"/>'
    path.write_text(f'<robot name="r">{include}{bodies}</robot>')
    with pytest.raises(MachineError, match="XInclude"):
        Machine.from_urdf(path)


NAMESPACE = "xmlns='http://www.ros.org'"


@pytest.mark.parametrize(
    ("link", "message"),
    [
        (f"<colision>{BOX}</colision>", "is collision meant"),
        (f"<origin xyz='0 0 9'/><collision>{BOX}</collision>", "<origin.*nothing reads it"),
        (f"<pose>0 0 1 0 0 0</pose><collision>{BOX}</collision>", "<pose>: stands in <link>"),
        (f"<collision><orgin xyz='1 0 0'/>{BOX}</collision>", "is origin meant"),
    ],
)
def test_a_namespace_of_the_whole_robot_hides_no_slip(tmp_path, link, message):
    for given in ("", NAMESPACE):
        with pytest.raises(MachineError, match=message):
            machine_of(tmp_path, f"<robot name='r' {given}><link name='a'>{link}</link></robot>")


def test_elements_of_another_namespace_than_the_robots_are_of_other_programs(tmp_path):
    other = "<p:colision xmlns:p='http://other.org'/><p:origin xmlns:p='http://other.org' xyz='1 0 0'/>"
    for given in ("", NAMESPACE):
        link = f"<link name='a'>{other}<collision>{BOX}</collision></link>"
        assert machine_of(tmp_path, f"<robot name='r' {given}>{link}</robot>").checked_links == ("a",)


@pytest.mark.parametrize(
    ("kind", "value"),
    [("SYSTEM", "'part.xml'"), ("", f"'<collision>{BOX.replace(chr(39), chr(34))}</collision>'")],
)
def test_an_entity_is_refused_and_not_passed_over(tmp_path, kind, value):
    """A link without its body, or a robot without a link, would say nothing of it."""
    (tmp_path / "part.xml").write_text(f"<link name='b'>{BOX}</link>")
    head = f"<!DOCTYPE robot [<!ENTITY part {kind} {value}>]>"
    for text in (
        f"<robot name='r'>{BODY}&part;</robot>",
        f"<robot name='r'><link name='a'>&part;</link>{BODY}</robot>",
    ):
        with pytest.raises(MachineError, match=r"line 1: .*&part; stands for other text .an XML entity"):
            machine_of(tmp_path, head + text)


def test_an_entity_of_an_attribute_is_read(tmp_path):
    head = "<!DOCTYPE robot [<!ENTITY half '0.5'>]>"
    machine = machine_of(tmp_path, head + with_shape("<box size='&half; 1 2'/>"))
    assert np.ptp(machine.links[0].vertices, axis=0) == pytest.approx([0.5, 1, 2])
