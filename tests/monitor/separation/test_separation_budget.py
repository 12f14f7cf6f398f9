"""Margins of a pass and the budget of a site: every term is said, and the sums are those of their terms."""

from dataclasses import replace

import numpy as np
import pytest

from elbowroom.errors import InputError, SiteError
from elbowroom.monitor.separation.budget import GROUPS, Budget, least_margins
from elbowroom.monitor.separation.figures import detection_capability, figures_of, stopping_distance
from elbowroom.monitor.separation.margins import Margins
from elbowroom.monitor.separation.measuring import measured_budget
from elbowroom.monitor.separation.reaction import Reaction
from elbowroom.monitor.start.start import started
from elbowroom.motion.distances import Distances, LinkDistances, Nearest
from elbowroom.site import Site
from elbowroom.sources import open_room
from elbowroom.view.screen.words import margins_text
from reference.small_room import SMALL_ROOM

MEASURED = Reaction(66.0, 12.0, 50.0, 2.0)


@pytest.fixture(scope="module")
def small(tmp_path_factory):
    path = tmp_path_factory.mktemp("room") / "site.yaml"

    def room(more=""):
        path.write_text(SMALL_ROOM + more)
        return open_room(Site.load(path))

    return room


@pytest.fixture(scope="module")
def figures(small):
    return figures_of(small())


def margins(figures, seen_m, unseen_m, measured_ms=100.0):
    near = Nearest(seen_m, "c_arc", (0, 0, 1)), Nearest(unseen_m, "c_arc", (0, 0, 1))
    distances = Distances(5.0, 0.01, (LinkDistances("c_arc", *near),))
    return Margins(distances, figures, None, measured_ms)


def sum_of(budget, group):
    own = [term for term in budget.terms() if term.group == group]
    assert own[-1].is_sum and not any(term.is_sum for term in own[:-1])
    return own[-1], sum(term.value for term in own[:-1])


@pytest.mark.parametrize("group", GROUPS)
def test_every_sum_is_that_of_the_terms_above_it_and_each_says_where_it_comes_from(figures, group):
    budget = Budget(figures, MEASURED, 10, {})
    last, added = sum_of(budget, group)
    assert last.value == pytest.approx(added)
    assert all(term.source for term in budget.terms() if not term.is_sum)


def test_the_sums_are_the_separation_distances(figures):
    budget = Budget(figures, MEASURED, 10, {})
    assert budget.reaction_s == pytest.approx(0.130)
    link, separation = budget.worst_link, figures.separation
    assert sum_of(budget, "person")[0].value == pytest.approx(separation.from_person_m(link, 0.130))
    assert sum_of(budget, "walking")[0].value == pytest.approx(separation.fixed_m(0.130, 1.6))


def test_what_the_site_says_is_taken_and_named(small):
    figures = figures_of(
        small(
            "separation: {walking_m_s: 1.2, reaching_m_s: 2.5, intrusion_mm: 120, person_uncertainty_mm: 30,"
            " machine_uncertainty_mm: 5, command_ms: 40, reaction_ms: 300, look_m: 0.7}\n"
        )
    )
    separation = figures.separation
    assert (separation.walking_m_s, separation.reaching_m_s, separation.intrusion_m) == (1.2, 2.5, 0.12)
    assert (separation.person_m, separation.machine_m, figures.look_m) == (0.03, 0.005, 0.7)
    budget = Budget(figures, MEASURED, 10, {})
    # what somebody vouches for holds while less is measured; the command comes on top of either
    assert budget.reaction_s == pytest.approx(0.340) and sum_of(budget, "reaction")[1] == pytest.approx(340)
    assert figures.reaction_s(500.0) == pytest.approx(0.540) and figures.reaction_s(None) == pytest.approx(
        0.340
    )
    sources = {term.source for term in budget.terms()}
    for key in (
        "walking_m_s",
        "intrusion_mm",
        "person_uncertainty_mm",
        "machine_uncertainty_mm",
        "command_ms",
    ):
        assert any(f"separation.{key}" in source for source in sources), key


def test_keys_that_nobody_means_are_refused(small):
    for wrong in ("walking_m_s: 1600", "command_s: 1", "reaction_ms: 0.3", "look_m: 700"):
        with pytest.raises(SiteError, match="separation"):
            small(f"separation: {{{wrong}}}\n")


def test_without_a_reaction_time_no_distance_is_said(figures):
    budget = Budget(figures, None, 10, {})
    assert budget.reaction_s is None
    assert {term.group for term in budget.terms()} == {"reaction"}
    assert budget.rows()[-1]["reaction_time_ms"] is None
    unknown = margins(figures, 1.0, 1.0, None)
    assert unknown.least_standing_m is None and unknown.row()["person_margin_m"] is None


def test_margins_are_distances_less_what_has_to_lie_between(figures):
    one = margins(figures, 2.0, 1.5)
    separation = figures.separation
    assert one.least_standing_m == pytest.approx(1.5 - separation.from_standing_m("c_arc", 0.1))
    assert one.least_person_m == pytest.approx(1.5 - separation.from_person_m("c_arc", 0.1))
    # a person is not taken to step out of what was seen, but what was seen may stand
    other = margins(figures, 0.5, 1.5)
    assert other.least_person_m == one.least_person_m and other.least_standing_m < one.least_standing_m
    assert least_margins([one, other]) == {
        "standing": other.least_standing_m,
        "person": one.least_person_m,
    }
    assert least_margins([margins(figures, 1, 1, None)]) == {}


def test_the_screen_says_distances_and_margins_in_one_line(figures):
    line = margins_text(margins(figures, 0.12, 0.0412))
    assert line.startswith("nearest seen 120 mm (c_arc), unseen 41 mm (c_arc); left before what stands -")
    assert "T_r 100 ms" in line and "\n" not in line
    far = Margins(Distances(0.3, 0.01, (LinkDistances("a", Nearest(0.3, "a"), Nearest(0.1, "a", (0, 0, 0), True)),)),
                  figures, None, None)  # fmt: skip
    assert margins_text(far) == "nearest seen none within 300 mm, unseen 100 mm (a, outside the grid)"


def test_it_is_looked_as_far_as_a_point_moves_while_one_joint_brakes(small, figures):
    room = small()
    machine, motions = room.machine_and_motions()
    far = stopping_distance(machine, motions, room.grid.voxel_size_m)
    assert figures.look_m == far and 0.0375 <= far < max(figures.separation.stopping_m.values())


def test_what_is_noticed_anywhere_is_as_large_as_the_farthest_pixels(small):
    room = small()
    diagonal = np.sqrt(3) * room.grid.voxel_size_m
    assert detection_capability(room.grid, ()) == pytest.approx(diagonal)
    assert detection_capability(room.grid, room.cameras) > diagonal


def test_a_run_measures_the_room_and_every_pass_has_margins(small):
    loop = started(small(), lambda step: None)
    budget = measured_budget(loop, 0.5)
    assert budget.passes >= 2 and budget.worst.pass_ms > 0 and budget.worst.output_ms > 0
    assert budget.worst.period_ms > 0 and set(budget.margins) == {"standing", "person"}
    assert all(np.isfinite(margin) for margin in budget.margins.values())
    with pytest.raises(InputError, match="no motion"):
        measured_budget(replace(loop, separating=None), 0.1)


def test_a_row_says_distances_margins_and_where(figures):
    row = margins(figures, 0.5, 1.5, 80.0).row()
    assert row["nearest_seen"]["link"] == "c_arc" and row["nearest_unseen"]["distance_m"] == 1.5
    assert row["worst_reaction_ms"] == 80.0 and row["links"][0]["seen_m"] == 0.5
    assert row["links"][0]["seen_person_margin_m"] < row["links"][0]["standing_margin_m"]
