"""What cameras see of a machine whose collision geometry is larger than it is, and a hand in the excess."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from elbowroom.errors import MachineError
from elbowroom.geometry import VoxelGrid, bits
from elbowroom.geometry.margin import Margin
from elbowroom.machine import body_words
from elbowroom.machine.excess import excess_of
from elbowroom.machine.rasterise import rasterise
from elbowroom.motion import Level, Motion, check_motions
from elbowroom.reconstruct import reconstruct
from elbowroom.sensing import NOISE_PRESETS
from elbowroom.simulate import Moment, Solid, render, wall_cameras
from elbowroom.simulate.furniture import shell
from elbowroom.simulate.machine_solids import link_solids
from elbowroom.simulate.shapes import ellipsoid, join
from reference.contact_machines import joint, link, machine

ROOM = VoxelGrid((-2, -2, 0), (100, 100, 63), 0.04)
JOINTS = {"turn": 0.0}
BASE = np.eye(4)
BASE[:3, 3] = (-0.5, 0, 1.2)
C = [
    ((0.06, 0.06, 0.5), (0.3, 0, 0)),
    ((0.5, 0.06, 0.06), (0.55, 0, 0.22)),
    ((0.5, 0.06, 0.06), (0.55, 0, -0.22)),
]
AROUND = ((0.53, 0.16, 0.5), (0.535, 0, 0))
MOTIONS = [Motion("turn", way, 0.1) for way in (1, -1)]
HAND = Solid("hand", join([ellipsoid((0.1, 0, 1.2), (0.06, 0.028, 0.06), 12, 20)]), np.eye(4))


def c_arm(folder, *, around=AROUND, visual=C, **more):
    return machine(
        folder,
        link("base", (0.1, 0.1, 0.1)),
        link("c", *around, visual=visual),
        joint("turn", "base", "c"),
        world_from_base=BASE,
        **more,
    )


@pytest.fixture(scope="module")
def explained(tmp_path_factory):
    """By which geometry explains: the same arm."""
    folder = tmp_path_factory.mktemp("c")
    return {words: c_arm(folder, explain_with=words) for words in ("auto", "collision")}


@pytest.fixture(scope="module", params=["tof", "exact"])
def images(request, explained):
    """Cameras, and what they see of the arm with a hand in its opening, and alone."""
    noise = NOISE_PRESETS["tof"] if request.param == "tof" else None
    cameras = wall_cameras(12, height_m=(2.4, 0.4), size="vga", noise=noise)
    links = link_solids(explained["auto"], JOINTS)
    return cameras, {
        what: render(cameras, Moment(0.0, (*shell(), *things, *links), JOINTS))
        for what, things in (("hand", (HAND,)), ("alone", ()))
    }


def space_of(images, what, arm):
    cameras, frames = images
    return reconstruct(ROOM, cameras, frames[what], arm, JOINTS, margin=Margin(lateral_px=0.0))


def levels(images, what, arm):
    return {verdict.level for verdict in check_motions(space_of(images, what, arm), arm, JOINTS, MOTIONS)}


def test_a_hand_in_the_excess_stops_and_the_machine_alone_does_not(images, explained):
    arm = explained["auto"]
    inside = ROOM.index_of(np.array([0.1, 0.0, 1.2]))
    assert not space_of(images, "hand", arm).free[tuple(inside)]
    assert levels(images, "hand", arm) == {Level.STOP}
    assert levels(images, "alone", arm) == {Level.CLEAR}


def test_without_the_surface_that_is_seen_both_stop_whatever_the_cameras(images, explained):
    arm = explained["collision"]
    assert levels(images, "hand", arm) == {Level.STOP}
    assert levels(images, "alone", arm) == {Level.STOP}


def test_the_excess_of_a_model_is_said_by_link(images, explained):
    cameras, frames = images
    given = [np.asarray(frame.depth_m) for frame in frames["alone"]]
    found = excess_of(explained["collision"], cameras, given, [JOINTS] * len(cameras))
    assert [one.link for one in found] == ["c"]
    # the C stands 50 mm within the box about it
    assert 0.03 < found[0].excess_m < 0.07 and found[0].share > 0.3
    # each camera's body is where the machine was at its own time
    here, there, both = [JOINTS] * len(cameras), [{"turn": 0.2}] * len(cameras), (*cameras, *cameras)
    one, other, still = (
        excess_of(explained["collision"], both, [*given, *given], joints)
        for joints in (here + there, there + here, here + here)
    )
    assert one == other != still
    assert excess_of(explained["auto"], cameras, given, [JOINTS] * len(cameras)) == ()
    nothing = [np.zeros_like(depth) for depth in given]
    assert excess_of(explained["collision"], cameras, nothing, [JOINTS] * len(cameras)) == ()


@settings(max_examples=8)
@given(lost=st.sets(st.integers(0, 11)), blind=st.integers(0, 3))
def test_less_evidence_adds_no_free_space_in_the_excess_beyond_the_body(explained, shown, lost, blind):
    cameras, frames = shown
    arm = explained["auto"]
    body = bits.unpack(body_words(arm.as_seen, JOINTS, ROOM), ROOM)
    rng = np.random.default_rng(blind)
    fewer = []
    for n, frame in enumerate(frames):
        if n in lost:
            continue
        depth = np.array(frame.depth_m)
        depth[rng.random(depth.shape) < 0.05 * blind] = 0
        fewer.append(replace(frame, depth_m=depth))
    margin = Margin(lateral_px=0.0)
    whole = reconstruct(ROOM, cameras, frames, arm, JOINTS, margin=margin)
    less = reconstruct(ROOM, cameras, fewer, arm, JOINTS, margin=margin)
    assert not (less.free & ~whole.free & ~body).any()


@pytest.fixture(scope="module")
def shown(explained):
    """Small images with noise of the arm and the hand."""
    cameras = wall_cameras(12, height_m=(2.4, 0.4), size="qqvga", noise=NOISE_PRESETS["tof"])
    links = link_solids(explained["auto"], JOINTS)
    return cameras, render(cameras, Moment(0.0, (*shell(), HAND, *links), JOINTS))


def seen_of(arm):
    return arm.links[arm.link_names.index("c")].seen


def test_visual_geometry_explains_where_it_fills_what_is_swept(tmp_path, explained):
    arm = explained["auto"]
    assert np.ptp(seen_of(arm).vertices, axis=0) == pytest.approx((0.53, 0.06, 0.5))
    assert np.ptp(arm.links[1].vertices, axis=0) == pytest.approx(AROUND[0])
    assert arm.as_seen.as_seen is arm.as_seen and seen_of(arm.as_seen) is None
    assert (
        seen_of(explained["collision"]) is None and explained["collision"].as_seen is explained["collision"]
    )
    cameras = wall_cameras(2, size="qqvga")
    near, far = (
        np.isfinite(rasterise(explained[words], cameras[0], JOINTS)).sum() for words in ("collision", "auto")
    )
    assert far < near
    # the same shapes need no second reading
    same = c_arm(tmp_path, visual=[AROUND])
    assert seen_of(same) is None


@pytest.mark.parametrize(
    "visual",
    [
        [((0.53, 0.06, 0.5), (0.535, 0, 0)), ((0.1, 0.1, 0.1), (0.535, 0.13, 0))],  # stands out
        [((0.53, 0.06, 0.5), (0.535, 0, 2.0))],  # lies elsewhere
        [((530, 60, 500), (535, 0, 0))],  # millimetres
        [((0.02, 0.02, 0.02), (0.5, 0, 0))],  # a logo
    ],
)
def test_visual_geometry_that_is_a_picture_of_something_else_explains_only_by_word(tmp_path, visual):
    assert seen_of(c_arm(tmp_path, visual=visual)) is None
    assert seen_of(c_arm(tmp_path, visual=visual, explain_with="visual")) is not None


def test_a_picture_that_is_larger_than_what_is_swept_is_said(tmp_path):
    def told(visual, **more):
        found = c_arm(tmp_path, visual=visual, **more).findings
        return [finding.text for finding in found if finding.kind == "larger"]

    (text,) = told([((0.6, 0.2, 0.5), (0.535, 0, 0))])
    assert "link c: its visual geometry stands out of its collision geometry by up to 35 mm" in text
    assert not told(C) and not told([AROUND])
    # no picture of the same thing
    assert not told([((530, 60, 500), (535, 0, 0))])


def test_a_body_that_is_missing_is_named_where_its_picture_is_there(tmp_path):
    shape = link("c", *AROUND).replace("collision", "visual")
    body = '<collision><geometry><mesh filename="nowhere.stl"/></geometry></collision>'
    lost = shape.replace("<visual>", f"{body}<visual>", 1)
    with pytest.raises(MachineError, match=r"link c: .*'nowhere.stl' is missing"):
        machine(tmp_path, link("base", (0.1, 0.1, 0.1)), lost, joint("turn", "base", "c"))


def test_a_visual_mesh_that_is_missing_is_an_error_only_by_word(tmp_path):
    def with_mesh(**more):
        shape = link("c", *AROUND).replace(
            "<collision>", '<visual><geometry><mesh filename="nowhere.stl"/></geometry></visual><collision>'
        )
        return machine(tmp_path, link("base", (0.1, 0.1, 0.1)), shape, joint("turn", "base", "c"), **more)

    assert seen_of(with_mesh()) is None
    with pytest.raises(MachineError, match="nowhere"):
        with_mesh(explain_with="visual")
