"""Where the scale model's cameras stand, and what its free travel is lost to."""

import json

import numpy as np
import pytest

from elbowroom.cli import run
from elbowroom.simulate.machine_solids import link_solids

pytest.importorskip("coal", reason="coal is not installed; exact mesh distance is left out")
from elbowroom.evaluate.thesis import scale_budget, scale_cameras, seen_ways
from elbowroom.evaluate.thesis.best_fours import best_fours, scores, shortfalls
from elbowroom.evaluate.thesis.scale_budget import CAUSES, Group, budget_row, budget_table, groups
from elbowroom.evaluate.thesis.scale_model import POSES, model_machine, model_pose
from elbowroom.evaluate.thesis.seen_ways import Shown, shown

MET_MM = np.array([40.0, 20.0, 4.0, 0.0])
"""How long before the contact the three voxels of a way are met, and the contact."""


def way(*reach):
    """Candidate n sees so many voxels of a way, and disputes none."""
    seen = np.array([np.arange(3) < count for count in reach])
    return Shown(MET_MM, seen, seen, np.zeros_like(seen))


def test_a_way_is_short_by_where_the_first_voxel_is_that_is_not_free():
    ways = [way(0, 0, 1, 3, 2)]
    hidden, blocked = shortfalls(ways, [0, 1, 2])
    assert hidden[:, 0].tolist() == [20.0, 20.0, 20.0, 0.0, 4.0]
    assert blocked[:, 0].tolist() == hidden[:, 0].tolist()


def test_three_who_see_through_overrule_a_dispute_and_two_do_not():
    seen = np.ones((4, 1), dtype=bool)
    disputed = np.zeros((4, 1), dtype=bool)
    disputed[0, 0] = True
    for through, short in ((3, 0.0), (2, 9.0)):
        see = seen.copy()
        see[through:, 0] = False
        _, blocked = shortfalls([Shown(np.array([9.0, 0.0]), see, see, disputed)], [0, 1, 2])
        assert blocked[3, 0] == short


def test_the_best_four_are_those_that_have_most_ways_in_view():
    ways = [way(*(3 if n == which else 0 for n in range(7))) for which in (1, 3, 4, 6)]
    score, four = best_fours(ways, 7)[0]
    assert sorted(four) == [1, 3, 4, 6]
    assert score > 4 and score == scores(*shortfalls(ways, [1, 3, 4]))[6]


@pytest.fixture
def two_poses(monkeypatch):
    monkeypatch.setattr(scale_cameras, "POSES", 2)
    scale_cameras._in_the_way.cache_clear()
    yield
    scale_cameras._in_the_way.cache_clear()


def test_candidates_keep_clear_of_the_machine(two_poses):
    places = scale_cameras.on_rings((0.7, 2.0), range(0, 360, 40), (0.12, 0.45))
    assert 0 < len(places) < 2 * 9 * 2
    links = link_solids(model_machine(), model_pose(0)[0])
    near = np.concatenate([link.vertices_in_world for link in links])
    gaps = np.linalg.norm(near[None] - places[:, None], axis=2).min(axis=1)
    assert (gaps > scale_cameras.CLEAR_M).all()


def test_candidates_see_a_way_in_the_order_in_which_it_is_met(monkeypatch):
    monkeypatch.setattr(seen_ways, "VOXEL_M", 0.008)
    ways = shown(3, np.array([[0.763, -0.356, 0.1]]), 1)
    assert ways
    for found in ways:
        assert (np.diff(found.short_mm) <= 0).all() and found.short_mm[-1] == 0
        assert found.in_view.shape == found.through.shape == (1, len(found.short_mm) - 1)


def test_the_search_asks_closer_places_about_the_best_of_the_first(two_poses, tmp_path, monkeypatch, capsys):
    asked = []

    def seen(pose, places, draws):
        asked.append((pose, len(places), draws))
        return [way(*(3 if n % 4 == pose else 0 for n in range(len(places))))]

    monkeypatch.setattr(scale_cameras, "shown", seen)
    out = tmp_path / "out.json"
    argv = ["evaluate", "scale-cameras", "--poses", "2", "--step", "20", "--jobs", "1", "--json", str(out)]
    assert run(argv) == 0
    rows = json.loads(out.read_text())["rows"]
    assert [row["search"] for row in rows] == sorted((row["search"] for row in rows), reverse=True)
    assert [(pose, draws) for pose, _, draws in asked] == [(0, 1), (1, 1), (0, 2), (1, 2)]
    assert rows[0]["ways_in_view"] == rows[0]["ways"] == 2 and len(rows[0]["places_m"]) == 4
    captured = capsys.readouterr()
    assert "about the best" in captured.out and "2 of 2 poses" in captured.err


def test_other_poses_come_last_and_are_judged_with_the_smallest_voxels():
    asked = groups(3, (0.004, 0.002))
    assert [(group.voxel_size_m, group.first, group.judged) for group in asked] == [
        (0.004, 0, True),
        (0.002, 0, True),
        (0.002, POSES, False),
    ]


def test_the_budget_is_of_ways_in_view():
    hidden = [1.0, 30.0, 3.0, 3.0, 3.0]
    row = budget_row(Group(0.004, 0, 2), [[1.0, 2.0, 3.0, 4.0, 5.0], [3.0, 2.0, 5.0, 6.0, 9.0], hidden])
    assert (row["motions"], row["in_view"]) == (3, 2)
    assert row["short_mm"]["noise"] == [7.0, 9.0] and list(row["short_mm"]) == list(CAUSES)
    none = budget_row(Group(0.004, POSES, 1), [hidden])
    assert none["in_view"] == 0
    assert budget_table([row, none]).lines[1][:3] == ["4 mm, other poses", "0 of 1", "- / -"]


def test_each_cause_costs_something_and_the_command_says_what(tmp_path, monkeypatch, capsys):
    found = scale_budget.shortfalls(1, 0.008)
    assert np.array(found).shape[1] == len(CAUSES)
    for _, _, pixels, margin, _ in found:
        assert pixels <= margin + 1e-6
    monkeypatch.setattr(scale_budget, "shortfalls", lambda pose, edge: found)
    out = tmp_path / "out.json"
    argv = ["evaluate", "scale-budget", "--poses", "1", "--voxel-size", "0.04", "--jobs", "1"]
    assert run([*argv, "--json", str(out)]) == 0
    rows = json.loads(out.read_text())["rows"]
    assert [(row["voxel_size_m"], row["judged"]) for row in rows] == [(0.008, True), (0.008, False)]
    assert "other poses" in capsys.readouterr().out
