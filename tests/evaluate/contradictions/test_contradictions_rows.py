"""Random sites are described wrongly in twenty ways, and the wrong cameras are counted as named or not."""

import numpy as np
import pytest

from elbowroom.evaluate.contradictions import rows
from elbowroom.evaluate.contradictions.rooms import FEWEST, MARGIN, MOST, random_site
from elbowroom.evaluate.contradictions.wrongs import KINDS
from elbowroom.reconstruct.contradiction.findings import contradictions

SMALL = 5
"""A site of three cameras."""


@pytest.mark.parametrize("number", range(4))
def test_a_number_says_all_of_a_site(number):
    one, other = random_site(SMALL), random_site(SMALL)
    for a, b in zip(one.cameras, other.cameras, strict=True):
        np.testing.assert_array_equal(a.world_from_camera, b.world_from_camera)
    for a, b in zip(one.snapshot.frames, other.snapshot.frames, strict=True):
        np.testing.assert_array_equal(a.depth_m, b.depth_m)
    assert FEWEST <= len(random_site(number + 3).cameras) <= MOST


@pytest.mark.parametrize("name", KINDS)
def test_each_way_changes_the_cameras_that_it_names_and_no_others(name):
    site = random_site(SMALL)
    wrong = KINDS[name](np.random.default_rng(0), site)
    for said, right in zip(wrong.cameras, site.cameras, strict=True):
        changed = said.intrinsics != right.intrinsics or not np.allclose(
            said.world_from_camera, right.world_from_camera, atol=1e-6
        )
        assert changed == (right.name in wrong.named)
    assert len(KINDS) == 20


def test_right_sites_are_left_alone():
    site = random_site(SMALL)
    assert contradictions(site.cameras, site.snapshot.frames, MARGIN) == ()


def test_rows_count_what_is_named_and_what_stops(monkeypatch, tmp_path):
    few = {name: KINDS[name] for name in ("inverse, all", "two exchanged")}
    monkeypatch.setattr(rows, "KINDS", few)
    monkeypatch.setattr(rows, "random_site", lambda number: random_site(SMALL))
    monkeypatch.setattr(rows, "_theatres", lambda: iter(()))
    *ways, everything, right = rows.contradiction_rows(lambda _: None, sites=1, right=1, examples=tmp_path)
    assert [row["what"] for row in ways] == list(few)
    assert all(row["named"] == row["stopped"] == row["sites"] == 1 and not row["missed"] for row in ways)
    assert everything["named_pct"] == 100.0
    assert right["sites"] == 1 and right["stopped"] == 0 and right["warned_pct"] == 0.0
    for row in (*ways, everything, right):
        assert all(due.met(row) for due in rows.DUE[row["kind"]])


@pytest.mark.parametrize(("name", "number", "said"), [("pose of another", 11, "it has the pose of")])
def test_beyond_the_limit_it_stops_whatever_else_would_explain_it(name, number, said):
    # its surfaces lie apart by a factor, too: that alone is a warning
    site = random_site(number)
    wrong = KINDS[name](np.random.default_rng([21, number]), site)
    found = contradictions(wrong.cameras, site.snapshot.frames, MARGIN)
    assert {about for finding in found for about in finding.about} == wrong.named
    assert any(finding.stops and said in finding.text for finding in found)
