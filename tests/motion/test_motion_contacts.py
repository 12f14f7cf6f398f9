"""Declared contact: links that may be near a table, and what stands out of it."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from elbowroom.errors import MachineError
from elbowroom.geometry import DepthCamera, Intrinsics, VoxelGrid
from elbowroom.geometry.margin import Margin
from elbowroom.geometry.transforms import looking_at
from elbowroom.machine import Contact
from elbowroom.motion import Cause, Level, Motion, check_motion
from elbowroom.reconstruct import FreeSpace, Terms, free_space_of
from elbowroom.sensing import Snapshot
from elbowroom.simulate import Solid, render
from elbowroom.simulate.machine_solids import link_solids
from elbowroom.simulate.shapes import box, join
from elbowroom.simulate.solid import Moment
from reference import contact_machines as machines
from reference.contact_machines import joint, link

GRID = VoxelGrid.covering((-0.8, -0.5, -0.1), (0.8, 0.5, 0.7), 0.04)
EYES = (
    (-0.9, -0.7, 0.9),
    (0.9, -0.7, 0.9),
    (-0.9, 0.7, 0.9),
    (0.9, 0.7, 0.9),
    (0.0, -1.0, 0.25),
    (0.0, 1.0, 0.25),
)
CAMERAS = [
    DepthCamera(str(n), 120, 90, looking_at(eye, (0, 0, 0.1)), Intrinsics(75.0, 75.0, 59.5, 44.5))
    for n, eye in enumerate(EYES)
]
ALL = range(len(CAMERAS))
TERMS = Terms(margin=Margin(bias_m=0.05))
HOME = {"slide": 0.0, "lift": 0.0}
TABLE = (-0.6, -0.4, -0.05), (0.6, 0.4, 0.0)
ALONG, DOWN = Motion("slide", 1, 0.03), Motion("lift", -1, 0.005)


@pytest.fixture(scope="module")
def cart(tmp_path_factory):
    """A cart 3 cm above a table, which slides along it and may be lowered."""
    return machines.machine(
        tmp_path_factory.mktemp("cart"),
        link("base"),
        link("rail"),
        joint("slide", "base", "rail", axis="1 0 0", kind="prismatic"),
        link("cart", (0.2, 0.2, 0.1), (0, 0, 0.08)),
        joint("lift", "rail", "cart", kind="prismatic"),
    )


def solid(name, lower, upper):
    return Solid(name, join([box(lower, upper)]), np.eye(4), is_static=True)


ROOM = Solid(
    "room",
    join(
        [
            box((-3, -3, -1.1), (3, 3, -1.0)),
            *(box((x, -3, -1), (x + 0.1, 3, 3)) for x in (-3.0, 2.9)),
            *(box((-3, y, -1), (3, y + 0.1, 3)) for y in (-3.0, 2.9)),
        ]
    ),
    np.eye(4),
    is_static=True,
)


def space_of(machine, *more, frames=ALL, joints=HOME):
    things = (ROOM, solid("table", *TABLE), *more)
    moment = Moment(0.0, (*things, *link_solids(machine, joints)), joints)
    images = render(CAMERAS, moment, noise=False)
    return free_space_of(GRID, CAMERAS, Snapshot([images[n] for n in frames], joints), machine, TERMS)


def near(cart, links=("cart",), **more):
    return cart.near(Contact.box("table", links, *TABLE, **more))


def verdict(machine, motion, *more, **how):
    joints = how.get("joints", HOME)
    return check_motion(space_of(machine, *more, **how), machine, joints, motion)


def test_a_link_that_may_be_near_a_table_is_not_stopped_by_its_margin(cart):
    assert verdict(cart, ALONG).level is Level.STOP
    assert verdict(near(cart), ALONG).level is Level.CLEAR
    assert verdict(near(cart, ("rail",)), ALONG).level is Level.STOP


def test_it_comes_down_to_the_table_and_no_farther(cart):
    found = verdict(near(cart), DOWN, joints=HOME)
    assert (found.cause, found.link, found.other_link) == (Cause.NONE, None, None)
    deeper = verdict(near(cart), Motion("lift", -1, 0.02), joints=HOME)
    assert (deeper.cause, deeper.link, deeper.other_link) == (Cause.SURFACE, "cart", "table")
    assert 0.028 < deeper.free_travel <= 0.03
    touching = verdict(near(cart, may_touch=True), Motion("lift", -1, 0.009), joints=HOME)
    assert touching.cause is Cause.NONE


@pytest.mark.parametrize(
    ("name", "lower", "upper"),
    [
        ("hand", (0.16, -0.08, 0.0), (0.32, 0.08, 0.03)),
        ("cup", (0.16, -0.04, 0.0), (0.24, 0.04, 0.1)),
        ("pen", (0.16, -0.08, 0.0), (0.2, 0.08, 0.02)),
    ],
)
def test_what_stands_on_the_table_blocks_the_links_that_may_be_near_it(cart, name, lower, upper):
    thing = solid(name, lower, upper)
    found = verdict(near(cart), ALONG, thing)
    assert found.free_travel <= lower[0] - 0.1 + 1e-9 or upper[2] < 0.03
    blocked = ~space_of(near(cart), thing).declared[0]
    # every voxel that it touches stays blocked for them
    inside = FreeSpace.from_occupied(GRID, _touched(lower, upper)).surface_words
    assert not (inside & ~blocked).any()


def _touched(lower, upper):
    corner = GRID.lower_m + np.moveaxis(np.indices(GRID.shape), 0, -1) * GRID.voxel_size_m
    return ((corner < np.asarray(upper)) & (corner + GRID.voxel_size_m > np.asarray(lower))).all(axis=-1)


subsets = st.lists(st.integers(0, len(CAMERAS) - 1), unique=True, max_size=3)


@settings(max_examples=12)
@given(subsets, st.booleans())
def test_less_evidence_never_gives_a_link_more(cart, lost, with_hand):
    things = [solid("hand", (0.16, -0.08, 0.0), (0.32, 0.08, 0.03))] if with_hand else []
    machine = near(cart)
    left = [n for n in range(len(CAMERAS)) if n not in lost]
    more, less = space_of(machine, *things), space_of(machine, *things, frames=left)
    assert not (less.declared[0] & ~more.declared[0] & ~more.free_words).any()
    for motion in (ALONG, DOWN):
        assert (
            check_motion(less, machine, HOME, motion).free_travel
            <= check_motion(more, machine, HOME, motion).free_travel
        )


@settings(max_examples=10)
@given(st.tuples(st.floats(-0.4, 0.3), st.floats(-0.3, 0.2)), st.floats(0.03, 0.2), st.floats(0.04, 0.2))
def test_nothing_that_is_measured_beyond_the_thing_becomes_free(cart, at, high, wide):
    lower, upper = (*at, 0.0), (at[0] + wide, at[1] + wide, high)
    if all(a < 0.16 and b > -0.16 for a, b in zip(lower[:2], upper[:2], strict=True)):
        return  # in the cart
    space = space_of(near(cart), solid("thing", lower, upper), joints=HOME)
    beyond = _touched((lower[0], lower[1], 0.012), upper)
    own = space.body_words
    held = FreeSpace.from_occupied(GRID, beyond).surface_words
    assert not (held & space.declared[0] & ~own).any()


def test_without_images_a_contact_gives_nothing(cart):
    space = space_of(cart)
    assert check_motion(space, near(cart), HOME, ALONG).level is Level.STOP


def test_outside_its_zone_nothing_changes(cart):
    zone = ((-0.5, -0.5, -0.1), (-0.2, 0.5, 0.2))
    assert verdict(near(cart, zone=zone), ALONG).level is Level.STOP


def test_a_contact_says_what_it_is_and_what_is_wrong_with_it(cart):
    said = (
        "May be near table, (-0.6, -0.4, -0.05) to (0.6, 0.4, 0) m, by the site's word: cart, within 100 mm"
    )
    assert near(cart).allowances == (said,)
    for make, words in (
        (lambda: near(cart, ()), "no links"),
        (lambda: near(cart, ("nobody",)), "link 'nobody' does not exist"),
        (lambda: near(cart, near_m=0.0), "near_m is 0.0"),
        (lambda: near(cart, zone=((0, 0, 0), (0, 1, 1))), "zone has no inside"),
        (lambda: cart.near(Contact.box("t", ["cart"], (0, 0, 1), (1, 1, 0))), "has no inside"),
        (lambda: cart.near(Contact.box("", ["cart"], *TABLE)), "give it a name"),
        (lambda: cart.near(Contact.box("cart", ["cart"], *TABLE)), "more than once, or that of a link"),
    ):
        with pytest.raises(MachineError, match=words):
            make()
