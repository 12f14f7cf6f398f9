import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from elbowroom.errors import InputError, MachineError
from elbowroom.geometry import bits
from elbowroom.motion import Cause, JointPath, Level, Motion, check_motion, check_motions, joint_motions
from elbowroom.motion.course import way_of
from elbowroom.reconstruct.free_space import FreeSpace
from reference import motion_machines as machines
from reference.motion_machines import HOME, nothing_in, room, touched_by_box

GRID = room(0.05)


@pytest.fixture(scope="module")
def arm(tmp_path_factory):
    return machines.slider_and_arm(tmp_path_factory.mktemp("arm"))


def space_with(arm, *occupied, joints=HOME, grid=GRID):
    blocked = nothing_in(grid)
    for part in occupied:
        blocked |= part
    return FreeSpace.from_occupied(grid, blocked).without(arm, joints)


def test_a_room_without_obstacles_is_clear_for_every_joint(arm):
    motions = joint_motions(arm, {"slide": 0.2, "turn": 0.5, "nod": 0.5}, 0.5)
    verdicts = check_motions(space_with(arm), arm, HOME, motions)
    assert [verdict.motion for verdict in verdicts] == motions
    for verdict in verdicts:
        assert (verdict.level, verdict.cause, verdict.link) == (Level.CLEAR, Cause.NONE, None)
        assert verdict.free_travel == pytest.approx(5 * verdict.motion.braking_distance)


def test_a_wall_ahead_of_a_slide_ends_the_travel_where_the_hand_meets_it(arm):
    # the hand's front is at x = 0.69, the wall begins at 0.95
    wall = touched_by_box(GRID, (0.951, -1.0, 0.4), (1.2, 1.0, 0.8))
    verdict = check_motion(space_with(arm, wall), arm, HOME, Motion("slide", 1, 0.15))
    assert 0.26 - 1.5 * 0.05 < verdict.free_travel <= 0.261
    assert (verdict.level, verdict.band) == (Level.DECELERATE, "M")
    assert (verdict.link, verdict.cause, verdict.free_travel_unit) == ("hand", Cause.SURFACE, "m")
    assert wall[tuple(GRID.index_of(verdict.place_in_world))]
    away = check_motion(space_with(arm, wall), arm, HOME, Motion("slide", -1, 0.08))
    assert away.level is Level.CLEAR


@pytest.mark.parametrize(
    ("braking", "level"),
    [(0.3, Level.STOP), (0.15, Level.DECELERATE), (0.06, Level.INFORM), (0.04, Level.CLEAR)],
)
def test_the_level_follows_from_the_braking_distance(arm, braking, level):
    wall = touched_by_box(GRID, (0.951, -1.0, 0.4), (1.2, 1.0, 0.8))
    verdict = check_motion(space_with(arm, wall), arm, HOME, Motion("slide", 1, braking, reach=0.4))
    assert verdict.level is level
    assert verdict.cause is Cause.SURFACE


def test_a_post_beside_the_arm_ends_its_turn(arm):
    # the arm's near side is at y = 0.05; the post begins at y = 0.301, x = 0.4 to 0.5, under the hand
    post = touched_by_box(GRID, (0.401, 0.301, -0.3), (0.499, 0.349, 0.499))
    verdict = check_motion(space_with(arm, post), arm, HOME, Motion("turn", 1, 0.2))
    truth = math.atan2(0.301, 0.499) - math.asin(0.05 / math.hypot(0.301, 0.499))
    assert truth - 1.5 * 0.05 / 0.6 < verdict.free_travel <= truth
    assert (verdict.link, verdict.free_travel_unit) == ("arm", "rad")


def test_a_joint_limit_caps_the_travel_and_not_the_level(arm):
    near_limit = HOME | {"slide": 0.45}
    verdict = check_motion(space_with(arm, joints=near_limit), arm, near_limit, Motion("slide", 1, 0.1))
    assert verdict.free_travel == pytest.approx(0.05)
    assert (verdict.level, verdict.cause) == (Level.CLEAR, Cause.NONE)
    at_limit = HOME | {"slide": 0.5}
    verdict = check_motion(space_with(arm, joints=at_limit), arm, at_limit, Motion("slide", 1, 0.1))
    assert (verdict.free_travel, verdict.level) == (0.0, Level.CLEAR)


@pytest.mark.parametrize("over", [1e-7, 1e-5, 1e-3, 4.9e-3])
def test_beyond_a_limit_by_little_nothing_leads_farther_out_and_all_of_it_back_in(arm, over):
    beyond = HOME | {"slide": 0.5 + over}
    space = space_with(arm, joints=beyond)
    out = check_motion(space, arm, beyond, Motion("slide", 1, 0.1))
    assert (out.free_travel, out.level) == (0.0, Level.CLEAR)
    back = check_motion(space, arm, beyond, Motion("slide", -1, 0.1))
    assert back.free_travel == pytest.approx(Motion("slide", -1, 0.1).looked_at)
    inside = check_motion(space_with(arm), arm, HOME, Motion("slide", -1, 0.1))
    assert back.level is inside.level
    assert check_motion(space, arm, beyond, JointPath([{"slide": 0.4}], 0.05)).level is Level.CLEAR
    with pytest.raises(MachineError, match=r"slide.*out of its limits"):
        check_motion(space, arm, beyond, JointPath([{"slide": 0.5 + 2 * over + 1e-5}], 0.05))


def test_whole_joint_states_are_taken_and_names_of_other_machines_change_nothing(arm):
    alone = check_motion(space_with(arm), arm, HOME, Motion("turn", 1, 0.1))
    with_others = check_motion(space_with(arm), arm, HOME | {"elbow_of_another": 1.0}, Motion("turn", 1, 0.1))
    assert alone.row() == with_others.row()


def test_only_the_links_that_a_joint_carries_count(arm):
    below_the_cart = touched_by_box(GRID, (0.21, -0.1, 0.25), (0.4, 0.1, 0.35))
    space = space_with(arm, below_the_cart)
    assert check_motion(space, arm, HOME, Motion("slide", 1, 0.1)).link == "cart"
    assert check_motion(space, arm, HOME, Motion("turn", 1, 0.1)).level is Level.CLEAR


def test_a_body_in_blocked_space_may_not_move_at_all(arm):
    blocked = touched_by_box(GRID, (0.3, -0.2, 0.4), (0.5, 0.2, 0.6))
    for verdict in check_motions(
        FreeSpace.from_occupied(GRID, blocked), arm, HOME, [Motion("turn", 1, 0.1), Motion("turn", -1, 0.1)]
    ):
        assert (verdict.free_travel, verdict.level) == (0.0, Level.STOP)


def test_leaving_the_grid_is_blocked_unless_the_link_is_unchecked(arm, tmp_path):
    short = room(0.05, upper=(0.8, 1.5, 1.2))
    verdict = check_motion(space_with(arm, grid=short), arm, HOME, Motion("slide", 1, 0.1))
    assert (verdict.cause, verdict.link, verdict.overridable) == (Cause.OUTSIDE_GRID, "hand", False)
    assert 0.11 - 0.01 < verdict.free_travel <= 0.11
    handless = machines.slider_and_arm(tmp_path, unchecked_links=("arm", "hand"))
    assert (
        check_motion(space_with(handless, grid=short), handless, HOME, Motion("slide", 1, 0.1)).level
        is Level.CLEAR
    )


@pytest.mark.parametrize(
    ("planes", "cause"),
    [
        ((), Cause.UNSEEN),
        (("disputed",), Cause.SURFACE),
        (("disputed", "blind"), Cause.BLIND),
        (("disputed", "blind", "surface"), Cause.SURFACE),
    ],
)
def test_the_cause_is_what_the_planes_say_of_the_first_block(arm, planes, cause):
    wall = bits.pack(touched_by_box(GRID, (0.951, -1.0, 0.4), (1.2, 1.0, 0.8)), GRID)
    none = bits.empty(GRID)
    given = {name: wall if name in planes else none for name in ("surface", "blind", "disputed")}
    space = FreeSpace(
        GRID, bits.inside(GRID) & ~wall, given["surface"], given["blind"], given["disputed"]
    ).without(arm, HOME)
    verdict = check_motion(space, arm, HOME, Motion("slide", 1, 0.1))
    assert verdict.cause is cause
    assert verdict.overridable == (cause is Cause.UNSEEN)


def test_where_unseen_and_seen_are_met_together_the_cause_cannot_be_overridden(arm):
    wall = touched_by_box(GRID, (0.951, -1.0, 0.4), (1.2, 1.0, 0.8))
    seen = wall & (np.indices(GRID.shape)[2] == GRID.index_of((0, 0, 0.61))[2])
    space = FreeSpace(
        GRID, bits.pack(~wall, GRID), bits.pack(seen, GRID), bits.empty(GRID), bits.pack(seen, GRID)
    ).without(arm, HOME)
    assert not check_motion(space, arm, HOME, Motion("slide", 1, 0.1)).overridable


def test_one_thread_and_many_give_the_same_verdicts(arm):
    rng = np.random.default_rng(3)
    space = space_with(arm, rng.random(GRID.shape) < 0.002)
    motions = joint_motions(
        arm, {"slide": 0.2, "turn": 0.8, "nod": 0.5}, {"slide": 0.5, "turn": 0.5, "nod": 1.0}
    )
    assert check_motions(space, arm, HOME, motions, threads=1) == check_motions(
        space, arm, HOME, motions, threads=3
    )


blobs = st.tuples(*(st.floats(-1.2, 1.1),) * 2, st.floats(-0.2, 1.0), st.floats(0.02, 0.3))


def volume_of(some):
    blocked = nothing_in(GRID)
    for x, y, z, size in some:
        blocked |= touched_by_box(GRID, (x, y, z), (x + size, y + size, z + size))
    return blocked


@settings(max_examples=40)
@given(
    st.lists(blobs, max_size=3),
    st.lists(blobs, min_size=1, max_size=3),
    st.sampled_from(["slide", "turn", "nod", "path"]),
    st.sampled_from([1, -1]),
    st.floats(-0.2, 0.2),
)
def test_less_free_space_never_gives_a_milder_verdict_nor_more_travel(
    arm, some, more, what, direction, start
):
    joints = HOME | {"slide": start, "turn": 3 * start}
    motion = (
        JointPath([{"slide": 0.3 * direction, "nod": 0.5}, {"turn": 1.0 * direction}], 0.2)
        if what == "path"
        else Motion(what, direction, 0.15)
    )
    wide = check_motion(space_with(arm, volume_of(some), joints=joints), arm, joints, motion)
    narrow = check_motion(space_with(arm, volume_of(some + more), joints=joints), arm, joints, motion)
    assert narrow.free_travel <= wide.free_travel
    assert narrow.level.rank <= wide.level.rank
    assert 0 <= narrow.free_travel <= way_of(arm, arm.positions(joints), motion).length


def test_a_path_of_one_joint_is_judged_as_that_joint(arm):
    wall = touched_by_box(GRID, (0.951, -1.0, 0.4), (1.2, 1.0, 0.8))
    space = space_with(arm, wall)
    single = check_motion(space, arm, HOME, Motion("slide", 1, 0.1, reach=0.4))
    path = check_motion(space, arm, HOME, JointPath([{"slide": 0.1}, {"slide": 0.4}], 0.1))
    assert path.free_travel == pytest.approx(single.free_travel, abs=0.05 / 16)
    assert (path.level, path.cause, path.free_travel_unit) == (single.level, single.cause, "m")


def test_a_path_of_both_kinds_of_joints_measures_the_largest_displacement(arm):
    path = JointPath([{"slide": 0.1, "turn": 0.4}, {"slide": -0.2, "turn": 0.4}], 0.1)
    verdict = check_motion(space_with(arm), arm, HOME, path)
    assert verdict.free_travel == pytest.approx(0.4 + 0.3)
    assert verdict.free_travel_unit == "m or rad"


def test_a_path_that_stays_where_it_is_is_clear(arm):
    verdict = check_motion(space_with(arm), arm, HOME, JointPath([HOME], 0.1))
    assert (verdict.free_travel, verdict.level) == (0.0, Level.CLEAR)


@pytest.mark.parametrize(
    ("joints", "message"),
    [
        (HOME | {"turn": math.nan}, "turn.*finite"),
        (HOME | {"turn": 2.5}, "turn.*out of its limits"),
        ({"slide": 0.0, "turn": 0.0}, "'nod' has no position"),
    ],
)
def test_joints_that_cannot_be_are_refused(arm, joints, message):
    with pytest.raises(MachineError, match=message):
        check_motion(space_with(arm), arm, joints, Motion("turn", 1, 0.1))


def test_motions_of_joints_that_cannot_be_are_refused(arm):
    with pytest.raises(MachineError, match="no joint 'elbow'"):
        check_motion(space_with(arm), arm, HOME, Motion("elbow", 1, 0.1))
    with pytest.raises(MachineError, match="no joint 'elbow'"):
        check_motion(space_with(arm), arm, HOME, JointPath([{"elbow": 1.0}], 0.1))
    with pytest.raises(MachineError, match=r"slide.*out of its limits"):
        check_motion(space_with(arm), arm, HOME, JointPath([{"slide": 1.0}], 0.1))
    with pytest.raises(MachineError, match="'nod' has no speed"):
        joint_motions(arm, {"slide": 0.1, "turn": 0.1}, 0.5)
    with pytest.raises(MachineError, match="no joint 'elbow'"):
        joint_motions(arm, {"slide": 0.1, "turn": 0.1, "nod": 0.1, "elbow": 1.0}, 0.5)
    with pytest.raises(InputError, match=r"speed is -0\.1"):
        joint_motions(arm, {"slide": -0.1, "turn": 0.1, "nod": 0.1}, 0.5)
