"""What stands within a voxel of the machine: motions that lead away go, and none goes on into it."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from elbowroom.motion import Cause, Level, Motion, check_motion, check_motions, joint_motions
from elbowroom.motion.ground import grounds_of
from elbowroom.motion.kernels.covered import COVERED, cover, open_cells
from elbowroom.motion.kernels.shared import triangle_meets_cells
from elbowroom.motion.pieces import pieces
from elbowroom.motion.shared import MOST_SHARED, Start
from elbowroom.reconstruct.free_space import FreeSpace
from reference import contact_machines as contacts
from reference import motion_machines as machines
from reference import motion_shared as naive
from reference.motion_machines import nothing_in, room, touched_by_ball, touched_by_box
from reference.motion_sweep import box_cuts_triangle

GRID = room(0.05)
SPEEDS = {"slide": 0.3, "turn": 0.5, "nod": 0.8}
PLACES = st.tuples(st.floats(-0.3, 0.3), st.floats(-1.5, 1.5), st.floats(-0.9, 0.9))


@pytest.fixture(scope="module")
def arm(tmp_path_factory):
    return machines.slider_and_arm(tmp_path_factory.mktemp("arm"))


def joints_at(place):
    return dict(zip(("slide", "turn", "nod"), place, strict=True))


def placed(machine, joints):
    return machine.world_from_link_array(machine.positions(joints)[None])[0]


@settings(max_examples=15)
@given(PLACES, st.integers(0, 999), st.floats(0.002, 0.01))
def test_covered_cells_are_those_near_the_surface_or_within(arm, place, seed, reach):
    rng, at = np.random.default_rng(seed), placed(arm, joints_at(place))
    row = int(rng.integers(len(arm.links)))
    on = arm.links[row].triangles[rng.integers(len(arm.links[row].faces))].T @ rng.dirichlet((1, 1, 1))
    corner = at[row][:3, :3] @ on + at[row][:3, 3] - rng.uniform(0, 0.05, 3)
    found, links = np.zeros((16, 16, 16), dtype=np.uint8), np.zeros(len(arm.links), dtype=np.bool_)
    cover(pieces(arm, 0.05), at, np.append(corner, 0.05), (reach, reach), found, links)
    some = rng.integers(16, size=(60, 3))
    away, within = naive.distance(arm, at, naive.middles(corner, 0.05)[tuple(some.T)])
    is_sure = abs(away - reach) > 1e-7
    truth = (away <= reach) | within
    np.testing.assert_array_equal((found[tuple(some.T)] == COVERED)[is_sure], truth[is_sure])
    assert links[row]


@settings(max_examples=10)
@given(PLACES, st.integers(0, 999))
def test_many_voxels_are_asked_as_each_is(arm, place, seed):
    rng, at, edge = np.random.default_rng(seed), placed(arm, joints_at(place)), 0.05
    row = int(rng.integers(len(arm.links)))
    on = arm.links[row].triangles[rng.integers(len(arm.links[row].faces), size=5)].mean(axis=1)
    corners = on @ at[row][:3, :3].T + at[row][:3, 3] - rng.uniform(0, edge, (5, 3))
    voxels, reach = np.column_stack([corners, np.full(5, edge)]), (0.003, 0.006)
    cells, links = np.empty((5, 64), np.uint64), np.zeros((5, len(arm.links)), np.bool_)
    open_cells(pieces(arm, edge), at, voxels, reach, cells, links)
    for n, voxel in enumerate(voxels):
        found, near = np.zeros((16, 16, 16), np.uint8), np.zeros(len(arm.links), np.bool_)
        cover(pieces(arm, edge), at, voxel, reach, found, near)
        np.testing.assert_array_equal(cells[n], naive.words_of(found != COVERED))
        np.testing.assert_array_equal(links[n], near)


@settings(max_examples=60)
@given(st.integers(0, 9999), st.floats(0, 0.004))
def test_a_triangle_meets_the_cells_that_it_cuts(seed, grown):
    rng = np.random.default_rng(seed)
    blocked = rng.random((16, 16, 16)) < rng.choice([0.001, 0.05])
    triangle = rng.uniform(-0.02, 0.07, 3) + rng.uniform(-0.02, 0.02, (3, 3))
    meets = triangle_meets_cells(triangle, naive.words_of(blocked), 0.0, 0.0, 0.0, 0.05, grown)
    assert meets == naive.triangle_meets(triangle, blocked, (0, 0, 0), 0.05, grown, box_cuts_triangle)


@pytest.fixture(scope="module")
def block(tmp_path_factory):
    return contacts.machine(
        tmp_path_factory.mktemp("block"),
        contacts.link("base", (0.1, 0.1, 0.1), (0, 0, -0.2)),
        contacts.link("block", (0.4, 0.4, 0.4), (0, 0, 0.4)),
        contacts.joint("slide", "base", "block", axis="1 0 0", kind="prismatic"),
    )


@settings(max_examples=40)
@given(st.floats(0.0003, 0.04), st.floats(-0.02, 0.02), st.floats(0.01, 0.2))
def test_what_leads_away_from_a_wall_goes_and_what_leads_into_it_does_not(block, gap, at, thick):
    joints = {"slide": at}
    wall = touched_by_box(GRID, (0.2 + at + gap, -1, 0), (0.2 + at + gap + thick, 1, 1))
    space = FreeSpace.from_occupied(GRID, wall)
    away, into = (check_motion(space, block, joints, Motion("slide", way, 0.06)) for way in (-1, 1))
    assert (away.level, away.cause) == (Level.CLEAR, Cause.NONE)
    assert into.level is Level.STOP and into.free_travel <= gap and not into.escapes
    # it reaches into the wall's voxels if these begin before its own face
    assert away.escapes or not wall[GRID.index_of((0.2 + at, 0.0, 0.4))[0]].any()


def test_what_slides_along_a_wall_is_let_go_as_far_as_its_own_voxels(block):
    wall = touched_by_box(GRID, (-0.12, 0.205, 0.3), (0.12, 0.3, 0.5))
    verdict = check_motion(
        FreeSpace.from_occupied(GRID, wall), block, {"slide": 0.0}, Motion("slide", 1, 0.06)
    )
    assert verdict.escapes and verdict.level is Level.CLEAR


def test_what_lies_in_the_body_still_leaves_it_no_travel(block):
    inside = touched_by_box(GRID, (-0.02, -0.02, 0.38), (0.02, 0.02, 0.42))
    for way in (1, -1):
        verdict = check_motion(
            FreeSpace.from_occupied(GRID, inside), block, {"slide": 0.0}, Motion("slide", way, 0.06)
        )
        assert (verdict.level, verdict.free_travel, verdict.escapes) == (Level.STOP, 0.0, False)


def beside(arm, trees, joints, gap, seed):
    """A box or a ball whose distance from the machine is a gap, and how to block what it touches when it is smaller."""
    from reference import motion_exact as exact

    rng = np.random.default_rng(seed)
    at = arm.world_from_links(joints)
    moving = [name for name in trees if name != "base"]
    link = arm.links[arm.link_names.index(str(rng.choice(moving)))]
    on = link.triangles[rng.integers(len(link.faces))].T @ rng.dirichlet((1, 1, 1))
    way = rng.normal(size=3)
    way /= np.linalg.norm(way)
    start, size = at[link.name][:3, :3] @ on + at[link.name][:3, 3], rng.uniform(0.03, 0.25, 3)
    is_ball = bool(rng.integers(2))

    def solid(away, less=0.0):
        centre = start + away * way
        return exact.ball(centre, size[0] - less) if is_ball else exact.box(centre, size - 2 * less)

    def gap_at(away):
        return exact.gap(trees, at, trees, [solid(away)])[0]

    low, high = 0.0, 1.5
    for _ in range(50):
        middle = (low + high) / 2
        low, high = (middle, high) if gap_at(middle) < gap else (low, middle)
    centre = start + high * way
    if is_ball:
        touched = touched_by_ball(GRID, centre, size[0])
    else:
        touched = touched_by_box(GRID, centre - size / 2, centre + size / 2)
    return gap_at(high), touched, lambda less: solid(high, less)


@settings(max_examples=40)
@given(PLACES, st.floats(0.0003, 0.02), st.integers(0, 9999))
def test_no_motion_meets_what_stands_beside_it_before_its_travel_ends(arm, place, gap, seed):
    pytest.importorskip("coal", reason="coal is not installed; exact mesh distance is left out")
    from reference import motion_exact as exact

    joints, trees = joints_at(place), exact.meshes_of(arm)
    _, touched, solid = beside(arm, trees, joints, gap, seed)
    space = FreeSpace.from_occupied(GRID, touched)
    for verdict in check_motions(space, arm, joints, joint_motions(arm, SPEEDS, 0.4)):
        if verdict.free_travel > 0 and verdict.cause is not Cause.MACHINE:
            truth, _ = exact.travel_until_contact(
                arm, trees, joints, verdict.motion, verdict.free_travel, [solid(0.0)]
            )
            assert verdict.free_travel <= truth


@settings(max_examples=40)
@given(PLACES, st.integers(0, 9999))
def test_more_blocked_voxels_never_let_a_motion_go_farther(arm, place, seed):
    rng, joints = np.random.default_rng(seed), joints_at(place)
    body = ~FreeSpace.from_occupied(GRID, ~nothing_in(GRID)).without(arm, joints).free
    body = FreeSpace.from_occupied(GRID, nothing_in(GRID)).without(arm, joints).free & ~body
    about = np.argwhere(FreeSpace.from_occupied(GRID, ~nothing_in(GRID)).without(arm, joints).free)
    some = nothing_in(GRID)
    for index in about[rng.integers(len(about), size=rng.integers(1, 8))] + rng.integers(-1, 2, (1, 3)):
        some[tuple(index)] = True
    more = some.copy()
    for index in about[rng.integers(len(about), size=rng.integers(1, 8))] + rng.integers(-2, 3, (1, 3)):
        more[tuple(index)] = True
    motions = joint_motions(arm, SPEEDS, 0.4)
    before, after = (
        check_motions(FreeSpace.from_occupied(GRID, blocked), arm, joints, motions)
        for blocked in (some, more)
    )
    for one, other in zip(before, after, strict=True):
        assert other.free_travel <= one.free_travel
        assert other.level.rank <= one.level.rank


def test_a_machine_in_the_dark_is_not_let_go(arm):
    joints = dict.fromkeys(SPEEDS, 0.0)
    fine = room(0.02, (-0.4, -0.5, -0.1), (1.0, 0.5, 1.0))
    dark = FreeSpace.from_occupied(fine, ~nothing_in(fine))
    assert Start.of(arm, grounds_of(dark, arm)[0], placed(arm, joints)).within is None
    for verdict in check_motions(dark, arm, joints, joint_motions(arm, SPEEDS, 0.4)):
        assert verdict.free_travel == 0.0 and not verdict.escapes
    assert MOST_SHARED == 512
