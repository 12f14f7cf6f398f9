"""Paths and stops from them, beside plain geometry."""

import functools
import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from elbowroom.errors import InputError, JointsError, MachineError
from elbowroom.machine import Contact, Zone
from elbowroom.motion import (
    Braking,
    Cause,
    JointPath,
    Level,
    MachineState,
    Motion,
    Trajectory,
    check_motion,
    check_path,
    check_stop,
    longest_safe_prefix,
)
from elbowroom.motion.course import way_of
from elbowroom.reconstruct.free_space import FreeSpace
from reference import motion_machines as machines
from reference.motion_machines import HOME, nothing_in, room, touched_by_ball, touched_by_box

GRID = room(0.05)
NAMES = ("slide", "turn", "nod")
FULL = Braking(dict.fromkeys(NAMES, 1.0), {"slide": 0.4, "turn": 0.6, "nod": 0.2})
ON_PATH = replace(FULL, leaves_path=False)


@pytest.fixture(scope="module")
def arm(tmp_path_factory):
    return machines.slider_and_arm(tmp_path_factory.mktemp("arm"))


def space_with(arm, *occupied, joints=HOME, grid=GRID):
    blocked = nothing_in(grid)
    for part in occupied:
        blocked |= part
    return FreeSpace.from_occupied(grid, blocked).without(arm, joints)


def sliding(speed=0.2, seconds=2.0):
    return Trajectory(("slide",), [0.0, seconds], [[0.0], [speed * seconds]])


WALL = touched_by_box(GRID, (0.951, -1.0, 0.4), (1.2, 1.0, 0.8))
"""0.26 m before the hand's front at home."""


def test_one_joint_at_a_steady_speed_may_go_as_far_as_its_motion_less_what_it_brakes(arm):
    space = space_with(arm, WALL)
    verdict = check_path(space, arm, sliding(), HOME, replace(FULL, reaction_time_s=0.1))
    motion = check_motion(space, arm, HOME, Motion("slide", 1, 0.4, reach=0.5))
    assert verdict.blocked.time_s * 0.2 == pytest.approx(motion.free_travel, abs=0.05 / 16)
    # v T_r + v t / 2
    assert verdict.follow_until_s * 0.2 == pytest.approx(motion.free_travel - 0.2 * (0.1 + 0.2), abs=0.015)
    assert (verdict.cause, verdict.blocked.link) == (Cause.SURFACE, "hand")
    assert WALL[tuple(GRID.index_of(verdict.blocked.place_in_world))]
    assert not verdict.is_free and verdict.prefix.end_s == verdict.follow_until_s


def test_a_path_that_stays_free_may_be_followed_to_its_end(arm):
    verdict = check_path(space_with(arm), arm, sliding(), HOME, FULL)
    assert verdict.is_free and verdict.level is Level.CLEAR and verdict.first is None
    assert verdict.prefix.end_s == 2.0
    # it ends at a speed, and the stop after it is looked at too
    assert verdict.rests_by_s == pytest.approx(2.2)


def test_the_stop_after_the_end_has_to_be_free_as_well(arm):
    space, short = space_with(arm, WALL), sliding(0.2, 1.2)
    assert not check_path(space, arm, short, HOME, FULL).is_free
    ends_at_rest = Trajectory(("slide",), [0.0, 1.2, 1.5], [[0.0], [0.24 - 1e-3], [0.24 - 1e-3]])
    assert check_path(space, arm, ends_at_rest, HOME, ON_PATH).is_free


def test_levels_say_how_soon_a_stop_must_be_commanded(arm):
    space = space_with(arm, WALL)
    levels = [check_path(space, arm, sliding(v, 0.5 / v), HOME, FULL).level for v in (1.0, 0.5, 0.1)]
    assert levels == [Level.DECELERATE, Level.INFORM, Level.CLEAR]
    near = touched_by_box(GRID, (0.701, -1.0, 0.4), (1.2, 1.0, 0.8))
    stop = check_path(space_with(arm, near), arm, sliding(1.0, 0.4), HOME, FULL)
    assert (stop.level, stop.follow_until_s, stop.rests_by_s, stop.prefix) == (Level.STOP, None, None, None)
    assert longest_safe_prefix(space_with(arm, near), arm, sliding(1.0, 0.4), HOME, FULL) is None


def test_a_horizon_looks_no_farther_but_always_as_far_as_a_stop(arm):
    space = space_with(arm, WALL)
    near = check_path(space, arm, sliding(), HOME, FULL, horizon_s=0.5)
    assert near.looked_until_s == 0.5 and near.first is None and near.level is Level.CLEAR
    assert near.follow_until_s == pytest.approx(0.3)  # 0.2 s of stop
    least = check_path(space, arm, sliding(), HOME, FULL, horizon_s=1e-3)
    assert least.looked_until_s == pytest.approx(0.2) and least.follow_until_s == pytest.approx(0.0)
    with pytest.raises(InputError, match="horizon_s"):
        check_path(space, arm, sliding(), HOME, FULL, horizon_s=0.0)


def test_a_stop_that_leaves_the_path_meets_what_the_path_passes_by(arm):
    # slide and turn together go round a post; a joint that stops early does not
    times = np.linspace(0, 1, 21)
    path = Trajectory(("slide", "turn"), times, np.stack([0.45 * times, 0.9 * times], axis=1))
    post = touched_by_box(GRID, (0.701, 0.451, 0.301), (0.749, 0.499, 0.699))
    space = space_with(arm, post)
    along, beside = (check_path(space, arm, path, HOME, each) for each in (ON_PATH, FULL))
    assert beside.follow_until_s <= along.follow_until_s
    assert along.stop_blocked is None
    tried = [
        _meets(arm, HOME | {"slide": slide, "turn": turn}, post)
        for time_s in np.linspace(0, along.follow_until_s, 20)
        for slide in 0.45 * time_s + np.linspace(0, 0.45 * 0.2, 6)
        for turn in 0.9 * time_s + np.linspace(0, 0.9 * 0.3, 6)
    ]
    assert any(tried) == (beside.stop_blocked is not None)


def _meets(arm, joints, blocked):
    """Whether a dense sample of the machine's surface lies in a blocked voxel."""
    placed = arm.world_from_links(joints)
    for link in arm.links:
        points = _points(link.name, arm) @ placed[link.name][:3, :3].T + placed[link.name][:3, 3]
        index = np.floor((points - GRID.lower_m) / GRID.voxel_size_m).astype(int)
        inside = ((index >= 0) & (index < GRID.shape)).all(axis=1)
        if not inside.all() or blocked[tuple(index.T)].any():
            return True
    return False


@functools.cache
def _points(link, arm):
    """Points of a link's surface, in its frame: corners, and large triangles every 3 cm."""
    triangles = next(each.triangles for each in arm.links if each.name == link)
    large = np.linalg.norm(triangles - np.roll(triangles, 1, axis=1), axis=2).max(axis=1) > 0.06
    shares = np.array([(a, b, 20 - a - b) for a in range(21) for b in range(21 - a)]) / 20
    return np.concatenate(
        [triangles.reshape(-1, 3), np.einsum("sc,tcx->tsx", shares, triangles[large]).reshape(-1, 3)]
    )


balls = st.tuples(
    st.tuples(st.floats(-1.2, 1.2), st.floats(-1.2, 1.2), st.floats(-0.2, 1.0)), st.floats(0.05, 0.2)
)
ends = st.tuples(st.floats(-0.4, 0.4), st.floats(-1.2, 1.2), st.floats(-0.8, 0.8))


@settings(max_examples=20)
@given(st.lists(balls, min_size=1, max_size=3), balls, st.lists(ends, min_size=1, max_size=2), st.booleans())
def test_no_stop_of_what_may_be_followed_meets_a_block_and_less_evidence_allows_no_more(
    arm, seen, unseen, points, leaves
):
    times = 2.5 * np.arange(len(points) + 1)
    path = Trajectory(NAMES, times, [[0.0, 0.0, 0.0], *points])
    blocked = nothing_in(GRID)
    for ball in seen:
        blocked |= touched_by_ball(GRID, *ball)
    braking = replace(FULL, leaves_path=leaves, reaction_time_s=0.1)
    space = FreeSpace.from_occupied(GRID, blocked).without(arm, HOME)
    verdict = check_path(space, arm, path, HOME, braking)
    more = FreeSpace.from_occupied(GRID, blocked | touched_by_ball(GRID, *unseen)).without(arm, HOME)
    less = check_path(more, arm, path, HOME, braking)
    assert (less.follow_until_s or -1.0) <= (verdict.follow_until_s or -1.0)
    assert less.level.rank <= verdict.level.rank
    if verdict.follow_until_s is None:
        return
    rng = np.random.default_rng(0)
    still_blocked = ~space.free
    for time_s in np.linspace(0, verdict.follow_until_s, 4):
        for _ in range(3):
            beside = _stop(path, time_s, braking, rng) if leaves else path.at(time_s + rng.uniform(0, 0.4))
            inside = {
                name: np.clip(beside[name], arm.joint(name).lower, arm.joint(name).upper) for name in NAMES
            }
            assert not _meets(arm, inside, still_blocked)


def _stop(path, time_s, braking, rng):
    """A place where joints may rest that brake each by itself, by the formula of the docs."""
    begin_s = time_s + braking.reaction_time_s
    found = path.at(begin_s)
    speeds = np.diff(path.positions, axis=0) / np.diff(path.times_s)[:, None]
    for n, name in enumerate(path.joint_names):
        half_s = braking.times_s[name] / 2
        in_window = (path.times_s[:-1] < begin_s + half_s) & (path.times_s[1:] > begin_s)
        own = speeds[in_window, n] if in_window.any() else speeds[-1:, n]
        low, high = min(0.0, own.min()) * half_s, max(0.0, own.max()) * half_s
        found[name] += rng.choice([low, high, rng.uniform(low, high)])
    return found


def test_a_machine_that_moves_is_told_whether_its_stop_is_free(arm):
    space = space_with(arm, WALL)  # 0.26 m away
    for speed, is_free in ((0.0, True), (0.5, True), (1.0, True), (-1.0, True)):
        verdict = check_stop(space, arm, MachineState(HOME, {"slide": speed}), FULL)
        assert verdict.is_free is is_free, speed
    late = replace(FULL, reaction_time_s=0.1)
    assert not check_stop(space, arm, MachineState(HOME, {"slide": 1.0}), late).is_free
    assert check_stop(space, arm, MachineState(HOME, {"slide": 0.7}), late).is_free
    blocked = check_stop(space, arm, MachineState(HOME, {"slide": 1.05}), late)
    assert (blocked.level, blocked.blocked.link) == (Level.STOP, "hand")


@pytest.mark.parametrize("speed", (0.3, -0.3))
def test_noise_of_a_joint_that_nobody_commands_is_none_and_a_movement_of_it_is_an_error(arm, speed):
    space = space_with(arm)
    braking = Braking({"slide": 1.0}, {"slide": 0.4})
    assert check_stop(space, arm, MachineState(HOME, {"slide": 0.1, "nod": 1e-5}), braking).is_free
    with pytest.raises(JointsError, match="nod has no speed"):
        check_stop(space, arm, MachineState(HOME, {"nod": speed}), braking)
    with pytest.raises(JointsError, match="its full speed is 1 "):
        check_stop(space, arm, MachineState(HOME, {"slide": 4 * speed}), braking)


@pytest.mark.parametrize(
    ("names", "rows", "error", "said"),
    [
        (("slid",), [[0.0], [0.1]], MachineError, "slid"),
        (("slide",), [[0.0], [0.6]], JointsError, "at 1 s joint slide is at 0.6 m, out of its limits"),
        (("turn",), [[0.0], [90.0]], JointsError, "if these are degrees"),
        (
            ("slide",),
            [[0.1], [0.2]],
            JointsError,
            "begins with joint slide at 0.1 m, and the machine is at 0 m",
        ),
        (("turn",), [[0.0], [1.2]], JointsError, "moves at 1.2 a second, its full speed is 1 "),
    ],
)
def test_a_path_that_the_machine_cannot_follow_is_an_error(arm, names, rows, error, said):
    with pytest.raises(error, match=said):
        check_path(space_with(arm), arm, Trajectory(names, [0.0, 1.0], rows), HOME, FULL)


def test_a_joint_of_the_path_needs_a_speed(arm):
    with pytest.raises(JointsError, match="joint turn has no speed"):
        path = Trajectory(("turn",), [0.0, 1.0], [[0.0], [0.5]])
        check_path(space_with(arm), arm, path, HOME, Braking({"slide": 1.0}, {"slide": 0.4}))


@pytest.mark.parametrize(
    ("speeds", "times", "reaction", "said"),
    [
        ({"slide": 1.0}, {}, 0.0, "slide needs a speed and a braking time"),
        ({"slide": 0.0}, {"slide": 0.4}, 0.0, "speed is 0"),
        ({"slide": 1.0}, {"slide": math.inf}, 0.0, "braking_time_s is inf"),
        ({"slide": 1.0}, {"slide": 0.4}, -0.1, "reaction_time_s"),
    ],
)
def test_brakes_that_are_none_are_refused(speeds, times, reaction, said):
    with pytest.raises(InputError, match=said):
        Braking(speeds, times, reaction)


def test_laws_of_single_motions_hold_for_paths(arm):
    # a zone that is kept out, the machine's own links, and what it stands close beside
    kept = replace(arm, zones=(Zone.box("door", "kept_out", (0.951, -1.0, 0.3), (1.4, 1.0, 0.9)),))
    verdict = check_path(space_with(kept), kept, sliding(), HOME, FULL)
    assert (verdict.cause, verdict.first.zone) == (Cause.KEPT_OUT, "door")
    back = Trajectory(("slide",), [0.0, 2.0], [[0.0], [-0.4]])
    # the hand reaches into one voxel by 4 cm of its 5
    touching = FreeSpace.from_occupied(GRID, touched_by_box(GRID, (0.66, -0.01, 0.57), (0.69, 0.01, 0.59)))
    leaving, into = (check_path(touching, arm, each, HOME, FULL) for each in (back, sliding()))
    assert leaving.is_free and leaving.escapes
    assert into.level is Level.STOP
    near = arm.near(Contact.box("bar", ("hand",), (0.80, -0.5, 0.5), (0.82, 0.5, 0.7)))
    declared = check_path(space_with(near), near, sliding(), HOME, FULL)
    assert (declared.cause, declared.first.other_link) == (Cause.SURFACE, "bar")


def test_points_nearer_than_rounding_make_no_joint_endlessly_fast(arm):
    steps = [0.4, 0.4 + 6e-17, 0.4 + 1.2e-16, 0.45]
    path = JointPath([{"slide": at} for at in steps], 0.02)
    way = way_of(arm, arm.positions(HOME), path)
    assert np.isfinite(way.rates).all() and way.rates.max() <= 2 and way.length == pytest.approx(0.45)
    tiny = JointPath([{"slide": 0.4}, {"turn": 1e-18}, {"turn": 2e-18}, {"slide": 0.45}], 0.02)
    assert np.isfinite(way_of(arm, arm.positions(HOME), tiny).rates).all()
