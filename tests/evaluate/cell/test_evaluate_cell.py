"""An arm in its cell: poses that touch nothing, truth of its own links as well, and what the summary counts."""

from itertools import islice

import numpy as np
import pytest
from trimesh.triangles import closest_point

from elbowroom.errors import InputError
from elbowroom.evaluate.cell.cell import cell_of
from elbowroom.evaluate.cell.rows import cell_rows, cell_summary
from elbowroom.evaluate.cell.scenes import cell_scenes
from elbowroom.evaluate.rooms.exact import ExactTravel
from elbowroom.motion import Motion
from elbowroom.site.site import NEW_SITE, SIMULATED_ROOM
from reference.table_cell import table_cell


@pytest.fixture(scope="module")
def cell():
    return cell_of(None, 0.08)


def test_poses_and_people_touch_nothing_and_work_is_over_the_table(cell):
    seen = list(islice(cell_scenes(cell, 5, ("random", "work")), 2))
    assert [drawn.kind for drawn in seen] == ["random", "work"]
    for drawn in seen:
        people = [solid for solid in drawn.moment.solids if solid.name.startswith("person")]
        machine = [solid for solid in drawn.moment.solids if solid.is_machine]
        nearest = min(
            np.linalg.norm(one.vertices_in_world[:, None] - other.vertices_in_world[None, ::7], axis=2).min()
            for one in people
            for other in machine
        )
        assert people and nearest > 0.005
    (again,) = islice(cell_scenes(cell, 5, ("random", "work")), 1)
    assert again.moment.joints == seen[0].moment.joints
    # the flange looks down, give or take what poses at work are drawn with
    pose = cell.machine.world_from_links(seen[1].moment.joints)["ee_link"]
    assert pose[2, 0] < -0.8


def test_links_meet_where_their_meshes_do(cell):
    machine = cell.machine
    joints = dict.fromkeys(machine.joint_names, 0.0) | {"shoulder_lift_joint": -1.5}
    truth = ExactTravel(machine, [])
    fold = Motion("elbow_joint", 1, 0.5, reach=3.1)
    pairs = [("wrist_1_link", "upper_arm_link"), ("forearm_link", "shoulder_link"), ("base_link", "world")]
    contact = truth.until_own_contact(joints, fold, [pair for pair in pairs if "world" not in pair])
    assert contact.touches and {contact.link, contact.solid} <= {name for pair in pairs for name in pair}

    def gap(travel):
        placed = machine.world_from_links({**joints, "elbow_joint": travel})
        one, other = (machine.links[machine.link_names.index(name)] for name in (contact.link, contact.solid))
        corners = other.triangles @ placed[other.name][:3, :3].T + placed[other.name][:3, 3]
        points = one.vertices @ placed[one.name][:3, :3].T + placed[one.name][:3, 3]
        centre = corners.mean(axis=(0, 1))
        some = points[np.argsort(np.linalg.norm(points - centre, axis=1))[:40]]
        return min(
            float(np.linalg.norm(closest_point(corners, np.tile(p, (len(corners), 1))) - p, axis=1).min())
            for p in some
        )

    assert gap(contact.travel) < 0.02 < gap(contact.travel - 0.3)
    # of links that a joint does not move against each other nothing is asked
    assert not truth.until_own_contact(joints, Motion("wrist_3_joint", 1, 0.5), pairs[:2]).touches


def test_rows_are_counted_by_joints_poses_and_cause():
    rows = list(cell_rows(poses=2, voxel_size_m=0.08))
    assert len(rows) == 2 * 12 * 2 and {row["contact"] for row in rows} == {"declared", "none"}
    summary = cell_summary(rows)
    for each in summary:
        causes = sum(value for key, value in each.items() if key.startswith("stopped_by"))
        assert causes == each["stop_where_clear"] <= each["truly_clear"] <= each["motions"]
    both = {
        each["contact"]: each
        for each in summary
        if (each["joints"], each["kind_of_pose"]) == ("shoulder and elbow", "all")
    }
    assert both["declared"]["stop_where_clear"] <= both["none"]["stop_where_clear"]
    assert all(each["milder_level"] == 0 for each in summary)


def test_any_cell_can_be_measured_in_random_poses(tmp_path):
    rows = list(cell_rows(table_cell(tmp_path), poses=1, kinds=("random",), noise=False))
    (summary,) = cell_summary(rows)
    assert summary["joints"] == "all" and summary["motions"] == 12 and summary["contact"] == "none"


@pytest.mark.parametrize(("path", "words"), [(SIMULATED_ROOM, "room: missing"), (NEW_SITE, "room: missing")])
def test_what_is_no_cell_is_one_line(path, words):
    with pytest.raises(InputError, match=words):
        next(cell_rows(path))
