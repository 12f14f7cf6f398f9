"""Files that xacro has not expanded yet: expanded where the package is there, and else named as such."""

import numpy as np
import pytest
import trimesh

from elbowroom import extras
from elbowroom.errors import MachineError
from elbowroom.machine import Machine

BOX = "<collision><geometry><box size='1 1 1'/></geometry></collision>"
ROBOT = "<robot name='r' xmlns:xacro='http://www.ros.org/wiki/xacro'>{}</robot>"
SIGNS = {
    "conditional": f"<xacro:if value='1'><link name='a'>{BOX}</link></xacro:if>",
    "macro": f"<xacro:macro name='m' params='n'><link name='${{n}}'>{BOX}</link></xacro:macro><xacro:m n='a'/>",
    "property": "<xacro:property name='l' value='1'/><link name='a'>"
    + BOX.replace("1 1 1", "${l} 1 1")
    + "</link>",
    "argument": "<xacro:arg name='l' default='1'/><link name='a'>"
    + BOX.replace("1 1 1", "$(arg l) 1 1")
    + "</link>",
}


@pytest.fixture
def without_xacro(monkeypatch):
    def missing(name):
        raise ImportError(f"no {name}")

    monkeypatch.setattr(extras, "import_module", missing)


def written(folder, content, name="r.urdf.xacro"):
    path = folder / name
    path.write_text(ROBOT.format(content))
    return path


@pytest.mark.parametrize("sign", SIGNS)
def test_xacro_is_expanded(tmp_path, sign):
    pytest.importorskip("xacro")
    machine = Machine.from_urdf(written(tmp_path, SIGNS[sign]))
    assert machine.checked_links == ("a",)


@pytest.mark.parametrize("name", ["r.urdf.xacro", "r.urdf"])
@pytest.mark.parametrize("sign", SIGNS)
def test_without_the_package_it_is_said_what_to_do(tmp_path, without_xacro, sign, name):
    with pytest.raises(MachineError, match=r"line 1: .*xacro.*expand it first.*pip install .*xacro"):
        Machine.from_urdf(written(tmp_path, SIGNS[sign], name))


@pytest.mark.parametrize(
    "content",
    [
        f"<include filename='a.xacro'/><link name='a'>{BOX}</link>",
        f"<link name='a' xacro:x='1'>{BOX}</link>",
        f"<link name='a'>{BOX.replace('1 1 1', '$(find x) 1 1')}</link>",
    ],
)
def test_every_sign_of_the_language_is_known(tmp_path, without_xacro, content):
    with pytest.raises(MachineError, match=r"xacro, which is not expanded yet|expression of xacro"):
        Machine.from_urdf(written(tmp_path, content))


def test_a_prefix_that_was_never_declared_is_xacro_all_the_same(tmp_path, without_xacro):
    path = tmp_path / "r.urdf"
    path.write_text(f"<robot name='r'><link name='a'>{BOX}</link><xacro:m/></robot>")
    with pytest.raises(MachineError, match="line 1: <xacro:m>: is xacro"):
        Machine.from_urdf(path)


def test_an_expanded_file_that_still_declares_the_prefix_is_a_urdf(tmp_path, without_xacro):
    plugin = "<gazebo><plugin filename='$(find x)/y.so'/></gazebo>"
    assert Machine.from_urdf(written(tmp_path, f"<link name='a'>{BOX}</link>{plugin}")).checked_links == (
        "a",
    )


def test_arguments_reach_the_file_and_packages_are_found_as_meshes_are(tmp_path):
    pytest.importorskip("xacro")
    folder = tmp_path / "share" / "small_description" / "meshes"
    folder.mkdir(parents=True)
    trimesh.creation.box((1, 1, 1)).export(folder / "a.stl")
    path = written(
        tmp_path,
        "<xacro:arg name='long' default='1'/><link name='a'><collision><geometry>"
        "<mesh filename='file://$(find small_description)/meshes/a.stl' scale='$(arg long) 1 1'/>"
        "</geometry></collision></link>",
    )
    with pytest.raises(MachineError, match=r"\$\(find small_description\): no package 'small_description'"):
        Machine.from_urdf(path)
    for long in ("1", "2"):
        machine = Machine.from_urdf(path, package_dirs=[tmp_path / "share"], xacro_arguments={"long": long})
        assert np.ptp(machine.links[0].vertices, axis=0) == pytest.approx([float(long), 1, 1])


def test_what_xacro_refuses_is_one_line(tmp_path):
    pytest.importorskip("xacro")
    with pytest.raises(
        MachineError, match="Undefined substitution argument l; give l in xacro_arguments"
    ) as caught:
        Machine.from_urdf(
            written(tmp_path, "<link name='a'>" + BOX.replace("1 1 1", "$(arg l) 1 1") + "</link>")
        )
    assert "\n" not in str(caught.value)
    with pytest.raises(MachineError, match="xacro cannot expand it"):
        Machine.from_urdf(written(tmp_path, "<xacro:unknown/>"))


def test_arguments_for_a_file_without_xacro_are_refused(tmp_path):
    with pytest.raises(MachineError, match="nothing in the file is xacro"):
        Machine.from_urdf(written(tmp_path, f"<link name='a'>{BOX}</link>"), xacro_arguments={"l": "1"})


def test_places_in_an_expanded_file_are_said_to_be_such(tmp_path):
    pytest.importorskip("xacro")
    with pytest.raises(MachineError, match=r"r.urdf.xacro: expanded, line \d+: link a: <box size=\"2 1\">"):
        Machine.from_urdf(
            written(
                tmp_path,
                f"<xacro:property name='l' value='2'/><link name='a'>{BOX}</link>".replace("1 1 1", "${l} 1"),
            )
        )


def test_an_argument_that_the_file_does_not_have_is_refused_with_those_that_it_has(tmp_path):
    """A tool that is asked for by a misspelt argument would be left off without a word."""
    part = f"<link name='tool'>{BOX}</link><joint name='j' type='fixed'><parent link='a'/><child link='tool'/></joint>"
    path = written(
        tmp_path,
        "<xacro:arg name='with_tool' default='false'/>"
        f"<link name='a'>{BOX}</link><xacro:if value='$(arg with_tool)'>{part}</xacro:if>",
    )
    assert Machine.from_urdf(path, xacro_arguments={"with_tool": "true"}).checked_links == ("a", "tool")
    with pytest.raises(MachineError, match="the file has no argument tool; arguments are with_tool"):
        Machine.from_urdf(path, xacro_arguments={"tool": "true"})


def test_a_file_that_only_defines_macros_is_named_as_such(tmp_path):
    macro = f"<xacro:macro name='arm' params='prefix'><link name='${{prefix}}a'>{BOX}</link></xacro:macro>"
    with pytest.raises(
        MachineError, match=r"only defines macros \(arm\) and calls none: the robot has no <link>"
    ):
        Machine.from_urdf(written(tmp_path, macro))
    called = Machine.from_urdf(written(tmp_path, macro + "<xacro:arm prefix='l_'/>"))
    assert called.checked_links == ("l_a",)


TOOL = (
    f"<xacro:macro name='{{}}' params='parent'><link name='t'>{BOX}</link><joint name='j' type='fixed'>"
    "<parent link='${{parent}}'/><child link='t'/></joint></xacro:macro>"
)


@pytest.mark.parametrize("included", [False, True])
def test_a_macro_that_is_called_without_the_prefix_is_named_and_not_left_off(tmp_path, included):
    """As xacro called them once; what is not called is left standing, and no reader of URDFs knows it."""
    pytest.importorskip("xacro")
    written(tmp_path, TOOL.format("tool"), "tool.xacro")
    begin = "<xacro:include filename='tool.xacro'/>" if included else TOOL.format("tool")
    body = f"{begin}<link name='a'>{BOX}</link>"
    called = written(tmp_path, body + "<xacro:tool parent='a'/>")
    assert Machine.from_urdf(called).checked_links == ("a", "t")
    with pytest.raises(MachineError, match=r'<tool parent="a">: bears the name of a macro .*<xacro:tool>'):
        Machine.from_urdf(written(tmp_path, body + "<tool parent='a'/>"))


def test_what_a_sensor_has_may_bear_the_name_of_a_macro(tmp_path):
    pytest.importorskip("xacro")
    sensor = "<sensor name='s'><parent link='a'/><camera><image width='4' height='4'/></camera></sensor>"
    body = f"{TOOL.format('camera')}<link name='a'>{BOX}</link>"
    assert Machine.from_urdf(written(tmp_path, body + sensor)).checked_links == ("a",)


def test_xacro_puts_what_an_entity_of_its_file_stands_for_in_its_place(tmp_path):
    pytest.importorskip("xacro")
    link = f"<xacro:property name='l' value='1'/><link name='a'>{BOX}</link>&more;"
    path = written(tmp_path, link)
    more = (
        f"<link name='b'>{BOX}</link><joint name='j' type='fixed'><parent link='a'/><child link='b'/></joint>"
    )
    for said, has in ((f'"{more}"', True), ("SYSTEM 'more.xml'", False)):
        path.write_text(f"<!DOCTYPE robot [<!ENTITY more {said}>]>" + ROBOT.format(link))
        if has:
            assert Machine.from_urdf(path).checked_links == ("a", "b")
        else:
            with pytest.raises(MachineError, match=r"&more; stands for other text"):
                Machine.from_urdf(path)


@pytest.mark.parametrize("name", ["box", "inertia", "link"])
def test_a_macro_may_have_the_name_of_an_element_of_a_urdf(tmp_path, name):
    pytest.importorskip("xacro")
    machine = Machine.from_urdf(written(tmp_path, f"{TOOL.format(name)}<link name='a'>{BOX}</link>"))
    assert machine.checked_links == ("a",)
