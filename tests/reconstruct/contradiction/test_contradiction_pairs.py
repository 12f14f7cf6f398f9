"""What cameras say of each other's points, beside the same counted point by point."""

from dataclasses import replace

import numpy as np
import pytest

from elbowroom.geometry import Intrinsics
from elbowroom.reconstruct.contradiction.eye import Eye
from elbowroom.reconstruct.contradiction.mistakes import ADVICE, mistakes
from elbowroom.reconstruct.contradiction.pairs import SLACK_M, SLACK_SHARE, points_of, seen_by, together
from elbowroom.reconstruct.contradiction.sample import sample_of
from elbowroom.reconstruct.contradiction.views import Views
from reference.contradiction_room import MARGIN, naive_pairs, room_site

SITE = room_site()
VIEWS = Views.of(SITE.cameras, SITE.snapshot.frames, MARGIN, samples=64)


def test_counts_are_those_of_the_naive_twin():
    moved = list(SITE.cameras)
    moved[1] = replace(moved[1], world_from_camera=moved[0].world_from_camera)
    views = Views.of(moved, SITE.snapshot.frames, MARGIN, samples=64)
    pixels = [list(zip(s.u.astype(int), s.v.astype(int), strict=True)) for s in views.samples]
    expected = naive_pairs(
        moved, SITE.snapshot.frames, MARGIN, pixels, lambda z, d: SLACK_M + SLACK_SHARE * (z + d)
    )
    counted = np.stack([views.pairs.through, views.pairs.agrees, views.pairs.hidden])
    np.testing.assert_array_equal(counted, expected)
    assert expected[0].sum() > 30


def test_the_order_of_cameras_does_not_matter():
    order = [2, 0, 3, 1]
    turned = Views.of([SITE.cameras[n] for n in order], SITE.snapshot.frames, MARGIN, samples=64)
    np.testing.assert_array_equal(turned.pairs.agrees, VIEWS.pairs.agrees[np.ix_(order, order)])


def test_counts_of_some_cameras_are_those_of_all():
    some = VIEWS.pairs_if({1: VIEWS.eyes[1]}, [0, 1, 3])
    for partner in (0, 3):
        assert some.agrees[1, partner] == VIEWS.pairs.agrees[1, partner]
        assert some.agrees[partner, 1] == VIEWS.pairs.agrees[partner, 1]
    assert some.agrees[0, 3] == 0


@pytest.mark.parametrize("mistake", mistakes(), ids=lambda mistake: f"{mistake.kind}: {mistake.cure}")
def test_what_undoes_a_mistake_leaves_an_eye_and_can_be_advised(mistake):
    undone = mistake.undone(VIEWS.eyes[0])
    assert mistake.advice == ADVICE[mistake.kind]
    if undone is not None:
        np.testing.assert_allclose(undone.axes.T @ undone.axes, np.eye(3), atol=1e-9)


def test_a_distorted_camera_agrees_with_itself():
    lens = Intrinsics(80.0, 80.0, 79.5, 59.5, (0.08, -0.02, 0.001, 0.0005, 0.0))
    plain = SITE.cameras[0]
    bent = Eye.of(replace(plain, intrinsics=lens), MARGIN)
    depth = np.full((120, 160), 2.5, dtype=np.float32)
    sample = sample_of(bent, depth)
    through, agrees, hidden = seen_by(bent, sample, together([points_of(bent, sample, 0)]), 1)
    assert through.sum() == 0 and hidden.sum() == 0 and agrees[0] > 100
