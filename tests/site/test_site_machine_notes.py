"""What a site says of its machine: folders of packages, links without a body, slips, wheels on the floor."""

import math

import pytest
import trimesh

from elbowroom.errors import MachineError, SiteError
from elbowroom.site import Site
from elbowroom.site.machine_entry import MachineEntry, _as_xacro
from elbowroom.site.notes import notes_of

BOX = '<link name="{0}"><collision><geometry><box size=".2 .2 .2"/></geometry></collision></link>'
PART = '<link name="tool"><{0}><geometry><mesh filename="{1}"/></geometry></{0}></link>'
FIXED = '<joint name="f" type="fixed"><parent link="base"/><child link="tool"/></joint>'
WHEEL = (
    '<link name="wheel"><collision><origin rpy="1.5708 0 0"/><geometry><cylinder radius=".1" length=".05"/></geometry>'
    '</collision></link><joint name="roll" type="continuous"><parent link="base"/><child link="wheel"/>'
    '<origin xyz="0 0 {0}"/><axis xyz="0 1 0"/></joint>'
)


@pytest.fixture
def site_of(folder, plain):
    def make(body, joints=None, **machine):
        (folder.path / "robot.urdf").write_text(f'<robot name="r">{body}</robot>')
        plain["machine"] = {"urdf": "robot.urdf", **machine}
        plain["joints"] = joints or {}
        plain["max_frame_age_ms"] = 100
        return Site.load(folder.write(plain))

    return make


def test_meshes_of_packages_elsewhere_are_found_by_the_sites_word(site_of, folder):
    meshes = folder.path / "share/tool_description/meshes"
    meshes.mkdir(parents=True)
    trimesh.creation.box((0.1, 0.2, 0.3)).export(meshes / "tool.stl")
    body = BOX.format("base") + PART.format("collision", "package://tool_description/meshes/tool.stl") + FIXED
    (folder.path / "share").rename(folder.path / "elsewhere")
    with pytest.raises(MachineError, match=r"machine: .*link tool.*machine.package_dirs of the site"):
        site_of(body).machine()
    assert site_of(body, package_dirs=["elsewhere"]).machine().checked_links == ("base", "tool")


def test_links_without_a_body_stand_in_the_notes(site_of):
    body = BOX.format("base") + PART.format("visual", "package://x/tool.stl") + FIXED
    site = site_of(body, without_body=["tool"])
    assert notes_of(site)[0].startswith("links that move without a body, by the site's word: tool")


def test_slips_of_a_description_are_notes_and_no_warnings(site_of):
    site = site_of(BOX.format("base") + "<drake:x/>")
    assert "a prefix is not declared" in notes_of(site)[0]


def test_many_slips_are_told_once(site_of):
    points = '<collision><geometry><sphere radius="0"/></geometry></collision>\n' * 20
    notes = notes_of(site_of(BOX.format("base").replace("</link>", f"{points}</link>")))
    assert "and 12 slips more in the description of the machine" in notes
    assert len(notes) < 12


def test_wheels_that_touch_the_floor_are_named_where_they_move(site_of):
    joints = {"roll": {"max_speed_deg_s": 90, "braking_time_s": 0.2}}
    base = BOX.format("base")
    notes = notes_of(site_of(base + WHEEL.format(0.1), joints))
    assert any("wheels that touch the floor at rest: wheel" in note for note in notes)
    for height, moves, more in (
        (0.1, {}, {}),
        (0.5, joints, {}),
        (0.1, joints, {"unchecked_links": ["wheel"]}),
    ):
        notes = notes_of(site_of(base + WHEEL.format(height), moves, **more))
        assert not any("floor" in note for note in notes)


def test_the_tolerance_of_limits_is_the_sites(site_of):
    given = site_of(BOX.format("base"), limit_tolerance_deg=3, limit_tolerance_mm=1).machine().tolerance
    assert given[:2] == pytest.approx((math.radians(3), 0.001)) and not given.own


def test_arguments_of_xacro_are_the_sites(site_of):
    pytest.importorskip("xacro")
    body = BOX.format("base").replace(".2 .2 .2", "$(arg long) .2 .2")
    machine = site_of(body, xacro_arguments={"long": 2}).machine()
    assert machine.links[0].vertices[:, 0].max() == 1.0


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (2, "2"),
        (1234567, "1234567"),
        (-999999999.0, "-999999999"),
        (0.1234567891, "0.1234567891"),
        (True, "true"),
    ],
)
def test_a_number_reaches_xacro_with_all_its_digits(value, text):
    entry = MachineEntry(urdf="r.urdf", xacro_arguments={"n": value})
    assert _as_xacro(entry.xacro_arguments["n"]) == text


def test_a_follower_among_the_joints_is_said_to_follow(site_of):
    body = BOX.format("base") + WHEEL.format(0.5)
    body += (
        WHEEL.format(0.5)
        .replace("wheel", "idler")
        .replace("roll", "idle")
        .replace("</joint>", '<mimic joint="roll"/></joint>')
    )
    speed = {"max_speed_deg_s": 90, "braking_time_s": 0.2}
    site = site_of(body, {"idle": speed})
    with pytest.raises(SiteError, match=r"joints\.idle: follows roll \(mimic\)"):
        site.motions(site.machine())
