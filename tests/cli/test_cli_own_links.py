"""Pairs that need not be compared, from a file or an SRDF, and two machines of one site, by the commands."""

import json

import numpy as np
import pytest
import yaml

from elbowroom.cli import run
from elbowroom.errors import MachineError
from elbowroom.machine.own_links import OwnLinks
from elbowroom.simulate import wall_cameras
from elbowroom.site import Site
from elbowroom.sources import moments

ARM = """<robot name="arm">
  <link name="base"><collision><geometry><box size="0.2 0.2 0.2"/></geometry></collision></link>
  <link name="upper"><collision>
    <origin xyz="0.3 0 0"/><geometry><box size="0.6 0.08 0.08"/></geometry></collision></link>
  <link name="tool"><collision>
    <origin xyz="0.1 0 0"/><geometry><box size="0.2 0.06 0.06"/></geometry></collision></link>
  <joint name="turn" type="revolute"><parent link="base"/><child link="upper"/><origin xyz="0 0 0.2"/>
    <axis xyz="0 0 1"/><limit lower="-3" upper="3" velocity="1" effort="1"/></joint>
  <joint name="tilt" type="revolute"><parent link="upper"/><child link="tool"/><origin xyz="0.62 0 0"/>
    <axis xyz="0 1 0"/><limit lower="-1.5" upper="1.5" velocity="1" effort="1"/></joint>
</robot>
"""
SRDF = """<robot name="arm">
  <disable_collisions link1="base" link2="upper" reason="Adjacent"/>
  <disable_collisions link1="tool" link2="base" reason="Never"/>
</robot>
"""
SPEED = {"max_speed_deg_s": 30, "braking_time_s": 0.4}
ROOM = {
    "name": "cell",
    "grid": {"origin_m": [-1.5, -1.5, 0], "upper_m": [1.5, 1.5, 1.5], "voxel_size_m": 0.1},
    "simulated": {"cameras": 6, "resolution": "64x48"},
}


def site(folder, name, **keys):
    (folder / "arm.urdf").write_text(ARM)
    path = folder / f"{name}.yaml"
    path.write_text(yaml.safe_dump(ROOM | keys))
    return path


def machine_of_one(**keys):
    return {
        "machine": {"urdf": "arm.urdf", "world_from_base": stands(0.0)} | keys,
        "joints": {"turn": dict(SPEED), "tilt": dict(SPEED)},
    }


def stands(x, y=0.0, turned=1.0):
    pose = np.diag([turned, turned, 1.0, 1.0])
    pose[:3, 3] = x, y, 0.3
    return pose.tolist()


def test_pairs_that_own_links_finds_are_what_the_site_that_names_them_leaves_out(tmp_path, capsys):
    path, found = site(tmp_path, "bare", **machine_of_one()), tmp_path / "own.yaml"
    argv = [
        "site",
        "own-links",
        str(path),
        "--out",
        str(found),
        "--poses",
        "300",
        "--json",
        str(tmp_path / "o.json"),
    ]
    assert run(argv) == 0
    (row,) = json.loads((tmp_path / "o.json").read_text())["rows"]
    assert {frozenset(pair) for pair in row["adjacent"]} == {
        frozenset(("base", "upper")),
        frozenset(("upper", "tool")),
    }
    assert {frozenset(pair) for pair in row["never"]} == {frozenset(("base", "tool"))}
    named = Site.load(site(tmp_path, "named", **machine_of_one(own_links="own.yaml"))).machine()
    assert isinstance(named.own_links, OwnLinks) and named.own_links != Site.load(path).machine().own_links
    # what is there is not overwritten unless asked
    assert run(argv) == 2 and "is there already" in capsys.readouterr().err
    assert run([*argv, "--force"]) == 0


def test_an_srdf_is_read_and_said_in_every_summary(tmp_path, capsys):
    (tmp_path / "arm.srdf").write_text(SRDF)
    path = site(tmp_path, "srdf", **machine_of_one(srdf="arm.srdf"))
    assert run(["site", "check", str(path)]) == 0
    assert "by arm.srdf: 2 (1 adjacent, 1 never)" in capsys.readouterr().out
    assert any("arm.srdf" in line for line in Site.load(path).machine().allowances)


def test_an_entity_in_an_srdf_is_refused_and_not_passed_over(tmp_path):
    pair = "<disable_collisions link1='a' link2='b'/>"
    text = f'<!DOCTYPE robot [<!ENTITY more "{pair}">]>\n<robot name="r">{pair}\n&more;</robot>'
    (tmp_path / "arm.srdf").write_text(text)
    with pytest.raises(MachineError, match=r"arm.srdf: line 3: &more; stands for other text .an XML entity"):
        OwnLinks.from_srdf(tmp_path / "arm.srdf")


@pytest.fixture(scope="module")
def pair(tmp_path_factory):
    """Two arms that face each other across half a metre, and two moments of them."""
    folder = tmp_path_factory.mktemp("pair")
    arms = [("left", stands(-0.6)), ("right", stands(0.6, 0.5, -1.0))]
    return site(
        folder,
        "pair",
        machines=[
            {"name": name, "urdf": "arm.urdf", "joint_prefix": f"{name}_", "world_from_base": pose}
            for name, pose in arms
        ],
        joints={f"{name}_{joint}": dict(SPEED) for name, _ in arms for joint in ("turn", "tilt")},
    )


def test_two_machines_of_a_site_are_run_and_each_ends_the_others_way(pair, tmp_path):
    out = tmp_path / "out.json"
    assert run(["monitor", str(pair), "--seconds", "0", "--json", str(out)]) == 0
    rows = [row for row in json.loads(out.read_text())["rows"] if row["kind"] == "verdict"]
    assert {row["joint"] for row in rows} == {
        "left_turn",
        "left_tilt",
        "right_turn",
        "right_tilt",
    }


def test_two_machines_of_a_recording_have_joints_of_their_own(pair, tmp_path):
    content = yaml.safe_load(pair.read_text())
    cameras = [
        {
            "name": camera.name,
            "width": camera.width,
            "height": camera.height,
            "fx": camera.intrinsics.fx,
            "fy": camera.intrinsics.fy,
            "cx": camera.intrinsics.cx,
            "cy": camera.intrinsics.cy,
            "world_from_camera": camera.world_from_camera.tolist(),
        }
        for camera in wall_cameras(6, (2.4, 0.4), width=64, height=48)
    ]
    del content["simulated"]
    walls = {"lower_m": [-2.5, -2.5, 0.0], "upper_m": [2.5, 2.5, 2.9]}
    content |= {"cameras": cameras, "room": {"walls": walls}}
    content["recording"] = {"layout": "folder", "folder": "recording"}
    path = tmp_path / "recorded.yaml"
    (tmp_path / "arm.urdf").write_text(ARM)
    path.write_text(yaml.safe_dump(content))
    posed = "left_turn=0.5,left_tilt=0,right_turn=-0.2,right_tilt=0.1"
    assert run(["simulate", str(path), "--moments", "1", "--joints", posed]) == 0
    (moment,) = moments(Site.load(path))
    assert dict(moment.joints) == pytest.approx(
        {"left_turn": 0.5, "left_tilt": 0.0, "right_turn": -0.2, "right_tilt": 0.1}
    )
    out = tmp_path / "check.json"
    # the left arm turns on into the right one, which stands in its way
    argv = ["check", str(path), "--joint", "right_turn", "--direction", "+", "--json", str(out)]
    assert run(argv) == 0
    (row,) = json.loads(out.read_text())["rows"]
    assert row["cause"] == "machine" and row["other_link"].startswith("left/")


def test_the_file_of_several_machines_is_named_where_the_command_says(pair, tmp_path, capsys):
    found = pair.parent / "all.yaml"
    assert run(["site", "own-links", str(pair), "--out", str(found), "--poses", "100"]) == 0
    assert capsys.readouterr().out.rstrip().endswith("own_links, beside machines")
    content = yaml.safe_load(pair.read_text()) | {"own_links": "all.yaml"}
    content["allowed_contacts"] = [["left/tool", "right/tool"]]
    named = pair.with_name("named.yaml")
    named.write_text(yaml.safe_dump(content))
    machine = Site.load(named).machine()
    assert machine.own_links.has("left/base", "left/upper")
    assert machine.own_links.pairs == OwnLinks.from_yaml(found).pairs
    assert machine.allowed_contacts == (("left/tool", "right/tool"),)
    # with pairs of one machine's own file as well
    (pair.parent / "arm.srdf").write_text(SRDF)
    content["machines"][0]["srdf"] = "arm.srdf"
    named.write_text(yaml.safe_dump(content))
    both = Site.load(named).machine().own_links
    assert both.source == "arm.srdf, all.yaml" and both.has("right/tool", "left/tool")
    (pair.parent / "all.yaml").write_text("machine: x\nnever:\n  - [left/tool, post]\n")
    with pytest.raises(MachineError, match="link 'post' does not exist"):
        Site.load(named).machine()
    # a single machine has them in its own entry
    alone = site(tmp_path, "alone", **machine_of_one(), allowed_contacts=[["tool", "base"]])
    assert run(["site", "check", str(alone)]) == 2
    assert "here it belongs into machine" in capsys.readouterr().err


def test_a_part_is_among_the_pairs_that_the_command_finds_and_the_site_names(tmp_path):
    carries = {
        "carries": [
            {"name": "plate", "link": "tool", "box_m": [0.1, 0.1, 0.1], "link_from_part": stands(0.3)}
        ]
    }
    path, found = site(tmp_path, "bare", **machine_of_one(**carries)), tmp_path / "own.yaml"
    assert run(["site", "own-links", str(path), "--out", str(found), "--poses", "100"]) == 0
    assert "plate" in found.read_text()
    named = Site.load(site(tmp_path, "named", **machine_of_one(own_links="own.yaml", **carries))).machine()
    assert named.own_links.has("plate", "base")
    # taken off, it takes its pairs with it
    assert not named.without_part("plate").own_links.has("plate", "base")
