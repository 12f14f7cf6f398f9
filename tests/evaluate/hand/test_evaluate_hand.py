"""A hand at arms whose collision geometry is larger than they are."""

import numpy as np
import pytest
import trimesh

from elbowroom.evaluate.hand.arms import ARMS, Arm
from elbowroom.evaluate.hand.hand import DUE, RADIUS_M, hand_rows, hand_summary

JOINTS = {"turn": 0.4, "lift": -0.3, "bend": 0.7}


@pytest.mark.parametrize("name", ARMS)
def test_the_distance_of_an_arm_is_that_of_its_boxes(tmp_path, name):
    arm = Arm.in_folder(name, tmp_path, "auto")
    placed = arm.machine.world_from_links(JOINTS)
    boxes = []
    for link, real in arm.real.items():
        for edges, middle in real:
            box = trimesh.creation.box(edges)
            box.apply_transform(placed[link] @ trimesh.transformations.translation_matrix(middle))
            boxes.append(box)
    for point in np.random.default_rng(0).uniform((-0.5, -0.5, 0.5), (1.2, 1.2, 1.5), (20, 3)):
        signed = max(float(trimesh.proximity.signed_distance(box, [point])[0]) for box in boxes)
        assert arm.distance(JOINTS, point) == pytest.approx(max(0.0, -signed), abs=1e-6)
        if arm.distance(JOINTS, point) == 0:
            assert arm.is_in_excess(JOINTS, point)


@pytest.mark.parametrize("name", ARMS)
def test_both_ways_of_explaining_are_of_one_arm(tmp_path, name):
    by_visual, by_collision = (Arm.in_folder(name, tmp_path, words) for words in ("auto", "collision"))
    seen = [link.name for link in by_visual.machine.links if link.seen is not None]
    assert {"upper", "lower"} & set(seen) and all(link.seen is None for link in by_collision.machine.links)
    for one, other in zip(by_visual.machine.links, by_collision.machine.links, strict=True):
        assert np.array_equal(one.vertices, other.vertices)


def test_rows_of_small_images_sum_up():
    rows = list(hand_rows(["bent"], scenes=1, cameras=4, size="qqvga"))
    summary = {row["explain_with"]: row for row in hand_summary(rows)}
    assert set(summary) == {"auto", "collision"}
    for row in summary.values():
        assert row["arms"] == 1
        assert row["motions"] == sum(row[level] for level in ("stop", "decelerate", "inform", "clear"))
    assert summary["auto"]["motions"] == summary["collision"]["motions"]
    assert {due.key for due in DUE} <= set(summary["auto"])
    assert RADIUS_M == 0.05
