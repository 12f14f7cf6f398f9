"""What is blocked in a body, and what some links may touch."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from elbowroom.errors import MachineError
from elbowroom.machine import Stand
from elbowroom.motion import Cause, Level, Motion, check_motion
from elbowroom.reconstruct.free_space import FreeSpace
from reference import motion_machines as machines
from reference.contact_machines import joint, link, machine
from reference.motion_machines import HOME, nothing_in, room, touched_by_box

GRID = room(0.05)
ANYWHERE = ((-2.0, -2.0, -1.0), (2.0, 2.0, 2.0))


@pytest.fixture(scope="module")
def arm(tmp_path_factory):
    return machines.slider_and_arm(tmp_path_factory.mktemp("arm"))


@pytest.fixture(scope="module")
def block(tmp_path_factory):
    return machine(
        tmp_path_factory.mktemp("block"),
        link("base", (0.1, 0.1, 0.1), (0, 0, -0.2)),
        link("block", (0.6, 0.4, 0.4), (0, 0, 0.4)),
        joint("slide", "base", "block", axis="1 0 0", kind="prismatic"),
        link("still", (0.1, 0.1, 0.1), (0, 1, 0.4)),
        joint("other", "base", "still", axis="1 0 0", kind="prismatic"),
    )


def space_of(machine, joints, *occupied):
    """A room in which some voxels are blocked, the machine's own as well."""
    free = FreeSpace.from_occupied(GRID, nothing_in(GRID)).without(machine, joints).free
    for part in occupied:
        free &= ~part
    return FreeSpace.from_occupied(GRID, ~free)


@settings(max_examples=30)
@given(st.tuples(st.floats(-0.15, 0.15), st.floats(-0.05, 0.05), st.floats(0.35, 0.45)))
def test_a_body_about_a_blocked_voxel_goes_nowhere(block, at):
    joints = {"slide": 0.0, "other": 0.0}
    hand = touched_by_box(GRID, np.subtract(at, 0.02), np.add(at, 0.02))
    space = space_of(block, joints, hand)
    for way in (1, -1):
        found = check_motion(space, block, joints, Motion("slide", way, 0.05))
        assert (found.level, found.free_travel, found.cause) == (Level.STOP, 0.0, Cause.SURFACE)
        assert found.link == "block" and hand[tuple(GRID.index_of(found.place_in_world))]
    assert check_motion(space, block, joints, Motion("other", 1, 0.05)).level is Level.CLEAR


def test_a_blocked_voxel_about_a_body_is_not_in_it(block):
    joints = {"slide": 0.0, "other": 0.0}
    beside = touched_by_box(GRID, (-0.3, 0.26, 0.2), (0.3, 0.34, 0.6))
    assert (
        check_motion(space_of(block, joints, beside), block, joints, Motion("slide", 1, 0.05)).level
        is Level.CLEAR
    )


def table(lower=(-0.4, -0.3, -0.1), upper=(0.4, 0.3, 0.18)):
    return touched_by_box(GRID, lower, upper)


def test_a_stand_holds_none_of_its_links_and_all_others(arm):
    # a slab that the cart's underside stands in, and that reaches as high as the hand a metre on
    slab, wall = table(upper=(0.4, 0.3, 0.25)), touched_by_box(GRID, (0.75, -1, 0.3), (0.8, 1, 0.8))
    space = space_of(arm, HOME, slab, wall)
    slide = Motion("slide", 1, 0.05)
    assert check_motion(space, arm, HOME, slide).free_travel == 0.0
    standing = arm.standing_on(Stand.box(["cart"], (-0.41, -0.31, -0.11), (0.41, 0.31, 0.31)))
    assert check_motion(space, standing, HOME, slide).cause is not Cause.NONE
    found = check_motion(space, standing, HOME, slide)
    assert found.link == "hand" and found.free_travel > 0
    # nor does a stand that names another link
    other = arm.standing_on(Stand.box(["hand"], (-0.41, -0.31, -0.11), (0.41, 0.31, 0.31)))
    assert check_motion(space, other, HOME, slide).free_travel == 0.0
    everything = arm.standing_on(Stand.box(["*"], *ANYWHERE))
    assert check_motion(space, everything, HOME, slide).level is Level.CLEAR


def test_a_voxel_that_stands_out_of_a_stand_still_blocks(arm):
    space = space_of(arm, HOME, table(upper=(0.4, 0.3, 0.25)))
    # the slab's upper voxels end at 0.25: this box cuts them
    cut = arm.standing_on(Stand.box(["cart"], (-0.41, -0.31, -0.11), (0.41, 0.31, 0.23)))
    assert check_motion(space, cut, HOME, Motion("slide", 1, 0.05)).free_travel == 0.0


def test_what_stands_on_what_a_machine_stands_on_blocks_it(arm):
    """A cup beside the cart: where it stands out of the box, the column beneath and those beside it are blocked."""
    slab = table(upper=(0.5, 0.3, 0.25))
    stand = Stand.box(["cart"], (-0.41, -0.31, -0.11), (0.51, 0.31, 0.31))
    low, high = ((0.3, -0.05, 0.25), (0.4, 0.05, 0.29)), ((0.3, -0.05, 0.25), (0.4, 0.05, 0.34))
    standing, slide = arm.standing_on(stand), Motion("slide", 1, 0.05)
    assert check_motion(space_of(arm, HOME, slab), standing, HOME, slide).level is Level.CLEAR
    assert (
        check_motion(space_of(arm, HOME, slab, touched_by_box(GRID, *low)), standing, HOME, slide).level
        is Level.CLEAR
    )
    found = check_motion(space_of(arm, HOME, slab, touched_by_box(GRID, *high)), standing, HOME, slide)
    assert (found.link, found.cause) == ("cart", Cause.SURFACE)
    # it blocks low down as well, where the cart's underside is
    assert found.free_travel <= 0.3 - 0.05 - 0.15 + 1e-9


def test_a_stand_frees_nothing(arm):
    space = space_of(arm, HOME, table())
    standing = arm.standing_on(Stand.box(["cart"], *ANYWHERE))
    before = space.free.copy()
    check_motion(space, standing, HOME, Motion("slide", 1, 0.05))
    assert (space.free == before).all()


@settings(max_examples=25)
@given(
    st.lists(st.sampled_from(["cart", "arm", "hand", "base"]), min_size=1, max_size=3, unique=True),
    st.integers(0, 99),
)
def test_fewer_links_on_a_stand_never_make_a_verdict_milder(arm, links, seed):
    rng = np.random.default_rng(seed)
    lower = rng.uniform(-1, 0.8, 3)
    space = space_of(arm, HOME, touched_by_box(GRID, lower, lower + 0.4))
    stand = Stand.box(links, *ANYWHERE)
    fewer = Stand.box(links[1:], *ANYWHERE) if len(links) > 1 else None
    for name in ("slide", "turn"):
        motion = Motion(name, 1, 0.1)
        more = check_motion(space, arm.standing_on(stand), HOME, motion)
        less = check_motion(space, arm.standing_on(fewer) if fewer else arm, HOME, motion)
        assert less.free_travel <= more.free_travel


def test_a_stand_says_what_is_wrong_with_it(arm):
    for links, lower, upper, words in (
        ([], (0, 0, 0), (1, 1, 1), "no links"),
        (["cart"], (0, 0, 1), (1, 1, 0), "has no inside"),
        (["cart"], (0, 0, np.nan), (1, 1, 0), "three finite numbers"),
    ):
        with pytest.raises(MachineError, match=words):
            Stand.box(links, lower, upper)
    with pytest.raises(MachineError, match="stands_on: link 'card' does not exist"):
        arm.standing_on(Stand.box(["card"], *ANYWHERE))
    standing = arm.standing_on(Stand.box(["cart", "base"], (0, 0, 0), (1, 1, 0.5)))
    assert standing.allowances == (
        "Not stopped by anything there, by the site's word: cart, base in (0, 0, 0) to (1, 1, 0.5) m",
    )
