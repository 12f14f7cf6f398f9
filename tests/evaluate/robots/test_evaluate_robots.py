"""What is counted of published robots: loads, refused with a place, parts that are lost, files that nobody can read."""

import pytest
import trimesh

from elbowroom.errors import InputError
from elbowroom.evaluate.robots.plain_reader import plain
from elbowroom.evaluate.robots.robots import robot_rows, summary_rows

BOX = '<link name="{0}"><collision><geometry><box size="1 1 1"/></geometry></collision></link>'
MESH = '<link name="b"><visual><geometry><mesh filename="meshes/b.stl"/></geometry></visual></link>'
TURNS = '<joint name="j" type="continuous"><parent link="a"/><child link="b"/></joint>'


@pytest.fixture
def package(tmp_path):
    """A package as it is unpacked, with its manifest."""
    files = {
        "arm.urdf": f'<robot name="r">{BOX.format("a")}{MESH}{TURNS}</robot>',
        "slip.urdf": f'<robot name="r">{BOX.format("a").replace("1 1 1", "1 1")}{BOX.format("b")}{TURNS}</robot>',
        "thing.urdf": f'<robot name="r">{BOX.format("a")}</robot>',
        "no_mesh.urdf": f'<robot name="r">{BOX.format("a")}{MESH.replace("b.stl", "c.stl")}{TURNS}</robot>',
        "part.urdf": f'<robot name="r">{BOX.format("a")}{TURNS}</robot>',
        "frames.urdf": '<robot name="r"><link name="a"/></robot>',
        "garbage.urdf": "robot",
        "macros.xacro": '<robot xmlns:xacro="http://www.ros.org/wiki/xacro"><xacro:macro name="m" params=""/></robot>',
    }
    (tmp_path / "arms/meshes").mkdir(parents=True)
    trimesh.creation.box((1, 1, 1)).export(tmp_path / "arms/meshes/b.stl")
    about = tmp_path / "arms-1.2.dist-info"
    about.mkdir()
    about.joinpath("METADATA").write_text("Metadata-Version: 2.1\nName: arms\nVersion: 1.2\n")
    about.joinpath("RECORD").write_text("".join(f"arms/{name},sha256=x,1\n" for name in files))
    for name, content in files.items():
        (tmp_path / "arms" / name).write_text(content)
    return tmp_path


def test_files_are_counted_by_what_came_of_them_and_by_what_they_lack(package):
    rows = {row["file"]: row for row in robot_rows([package])}
    assert {row["package"] for row in rows.values()} == {"arms"}
    assert {row["version"] for row in rows.values()} == {"1.2"}
    lacks = {name: row["lacks"] for name, row in rows.items() if row["lacks"]}
    assert lacks == {
        "arms/no_mesh.urdf": "names a mesh that its package lacks, meshes/c.stl",
        "arms/part.urdf": "names links that stand in another file",
        "arms/frames.urdf": "has no geometry",
        "arms/garbage.urdf": "is not XML",
    }
    assert rows["arms/arm.urdf"]["outcome"] == "loads"
    assert rows["arms/arm.urdf"]["with_body"] == 2
    assert rows["arms/slip.urdf"]["text"].startswith("arms/slip.urdf: line 1: link a: <box")
    assert not any(str(package) in row["text"] for row in rows.values())
    summary = {row["format"]: row for row in summary_rows(list(rows.values()))}["urdf"]
    assert (summary["files"], summary["loads"], summary["refused"], summary["crashes"]) == (7, 2, 5, 0)
    assert (summary["whole"], summary["machines"], summary["loads_of_machines_pct"]) == (3, 2, 50.0)
    assert summary["lost_unsaid"] == 0


def test_a_link_that_another_reader_finds_a_body_for_is_lost_where_ours_has_none(package, monkeypatch):
    from elbowroom.evaluate.robots import robots

    def blind(path, root):
        return plain(path, root)._replace(with_geometry=frozenset({"a", "b", "c"}))

    monkeypatch.setattr(robots, "plain", blind)
    (row,) = robot_rows(
        [package], leave_out=["slip", "thing", "no_mesh", "part", "frames", "garbage", "macros"]
    )
    assert row["lost"] == ["c"]


def test_the_plain_reader_passes_what_published_files_slip_in(package):
    path = package / "slips.urdf"
    path.write_text(
        f'\n<!-- x -->\n<?xml version="1.0"?><robot name="r">{BOX.format("a")}<drake:x drake:y="1"/></robot>'
    )
    assert plain(path, package).with_geometry == {"a"}
    path.write_text(
        '<robot name="r"><link name="a"><visual><geometry><sphere radius="0"/></geometry></visual></link></robot>'
    )
    assert plain(path, package).with_geometry == frozenset()


def test_folders_without_robots_are_refused(tmp_path):
    with pytest.raises(InputError, match="no URDF and no xacro file below"):
        list(robot_rows([tmp_path]))
    with pytest.raises(InputError, match="no such folder"):
        list(robot_rows([tmp_path / "none"]))
