"""An operator may creep into what nobody sees, up to S at that speed before anything else, and never otherwise."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as some

from elbowroom.errors import InputError
from elbowroom.geometry import bits
from elbowroom.motion import Cause, Level, Motion, Override, check_motions, joint_motions, with_creep
from elbowroom.reconstruct.free_space import FreeSpace
from reference import motion_machines as machines
from reference.motion_machines import HOME, nothing_in, room, touched_by_box

GRID = room(0.05)
SPEEDS = {"slide": 0.4, "turn": 0.5, "nod": 0.5}
FEW = settings(derandomize=True, max_examples=20)
AHEAD = ((0.751, -1.0, 0.4), (0.95, 1.0, 0.8))
BEHIND = ((0.951, -1.0, 0.4), (1.2, 1.0, 0.8))
"""Boxes before the hand of an arm that slides along x: its front is at x = 0.69."""


@pytest.fixture(scope="module")
def arm(tmp_path_factory):
    return machines.slider_and_arm(tmp_path_factory.mktemp("arm"))


def space_of(arm, unseen=None, surface=None, blind=None, disputed=None):
    nothing = nothing_in(GRID)
    said = [nothing if part is None else part for part in (surface, blind, disputed)]
    blocked = np.logical_or.reduce([*said, nothing if unseen is None else unseen])
    surface, blind, disputed = (bits.pack(part, GRID) for part in said)
    free = ~bits.pack(blocked, GRID) & bits.inside(GRID)
    return FreeSpace(GRID, free, surface, blind, surface | blind | disputed).without(arm, HOME)


def creeping(arm, space, motion, **how):
    verdicts = check_motions(space, arm, HOME, [motion])
    (verdict,) = with_creep(space, arm, HOME, verdicts, Override(speeds=SPEEDS, **how))
    return verdict


SLIDE = Motion("slide", 1, 0.15, reach=0.4)


def test_into_the_unseen_as_far_as_the_wall_behind_it_less_the_braking_distance_at_that_speed(arm):
    ahead, behind = touched_by_box(GRID, *AHEAD), touched_by_box(GRID, *BEHIND)
    verdict = creeping(arm, space_of(arm, unseen=ahead, surface=behind), SLIDE, max_speed_m_s=0.05)
    assert (verdict.level, verdict.cause) == (Level.STOP, Cause.UNSEEN)
    creep = verdict.creep
    assert creep.speed == pytest.approx(0.05) and creep.braking_distance == pytest.approx(0.15 / 8)
    assert 0.26 - 0.15 / 8 - 1.5 * 0.05 < creep.travel <= 0.261 - 0.15 / 8
    assert (creep.cause, creep.link) == (Cause.SURFACE, "hand")
    assert behind[tuple(GRID.index_of(creep.place_in_world))]
    assert verdict.row()["creep"]["cause"] == "surface"


def test_the_lesser_of_both_speeds_holds_and_a_lever_slows_a_joint_that_turns(arm):
    ahead = touched_by_box(GRID, *AHEAD)
    assert creeping(arm, space_of(arm, unseen=ahead), SLIDE).creep.speed == pytest.approx(0.1)
    everywhere = ~nothing_in(GRID)
    verdicts = [
        creeping(arm, space_of(arm, unseen=everywhere), motion, share_of_full_speed=1.0)
        for motion in joint_motions(arm, SPEEDS, 1.0)
    ]
    assert {verdict.motion.joint for verdict in verdicts if verdict.creep} >= {"slide", "turn"}
    for motion, creep in ((verdict.motion, verdict.creep) for verdict in verdicts if verdict.creep):
        assert 0 < creep.speed <= SPEEDS[motion.joint]
        lever = 1.0 if motion.joint == "slide" else 0.6
        assert creep.speed * lever <= 0.25 + 1e-9
        assert creep.cause is Cause.NONE or creep.cause is Cause.OUTSIDE_GRID


@pytest.mark.parametrize("plane", ["surface", "blind", "disputed"])
def test_never_where_anything_but_unseen_space_stops(arm, plane):
    space = space_of(arm, **{plane: touched_by_box(GRID, *AHEAD)})
    assert creeping(arm, space, SLIDE).creep is None


def test_what_is_no_stop_has_none_and_nothing_else_of_a_verdict_changes(arm):
    far = touched_by_box(GRID, *BEHIND)
    verdicts = check_motions(space_of(arm, unseen=far), arm, HOME, [Motion("slide", 1, 0.06, reach=0.4)])
    assert verdicts[0].level is Level.INFORM
    assert with_creep(space_of(arm, unseen=far), arm, HOME, verdicts, Override(speeds=SPEEDS)) == verdicts
    unnamed = with_creep(space_of(arm, unseen=far), arm, HOME, verdicts, Override())
    assert unnamed == verdicts


@FEW
@given(some.data())
def test_less_evidence_never_lets_creep_farther_than_before(arm, data):
    """What is not free and not unseen only grows with less evidence; then so do stops of other kinds."""
    rng = np.random.default_rng(data.draw(some.integers(0, 10**6)))
    blocked = rng.random(GRID.shape) < 0.02
    kinds = rng.integers(0, 4, GRID.shape)
    full = space_of(arm, blocked & (kinds == 0), blocked & (kinds == 1), blocked & (kinds == 2))
    more = rng.random(GRID.shape) < 0.01
    weak = space_of(arm, blocked & (kinds == 0), blocked & (kinds == 1) | more, blocked & (kinds == 2), None)
    for motion in joint_motions(arm, SPEEDS, 0.5):
        one, other = creeping(arm, full, motion), creeping(arm, weak, motion)
        if one.creep is not None and other.creep is not None:
            assert other.creep.travel <= one.creep.travel + 1e-9


@pytest.mark.parametrize(
    "wrong", [{"max_speed_m_s": 0.0}, {"share_of_full_speed": 1.5}, {"max_speed_m_s": np.nan}]
)
def test_speeds_that_are_none(wrong):
    with pytest.raises(InputError, match="override"):
        Override(**wrong)
