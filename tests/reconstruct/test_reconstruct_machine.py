"""What the machine explains in the images, and what that leaves of the laws."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from elbowroom.errors import MachineError
from elbowroom.geometry import VoxelGrid, bits
from elbowroom.machine import body_words
from elbowroom.motion import check_motions, joint_motions
from elbowroom.reconstruct import Terms, carve, reconstruct, resolve
from elbowroom.reconstruct.carve import carve_images
from elbowroom.reconstruct.explained import explain
from elbowroom.reconstruct.images import room_images
from elbowroom.reconstruct.own_body import OwnBody, own_body
from elbowroom.reconstruct.resolve import decide_around
from elbowroom.sensing import DepthFrame, Snapshot
from reference import motion_machines as machines
from reference import reconstruct_scenes as scenes
from reference.motion_machines import HOME
from reference.reconstruct_weaken import AGE, NOW, WAYS, some_margin, weakened

GRID = VoxelGrid((1.0, -0.5, -0.5), (20, 10, 10), 0.1)
WALL = scenes.Scene(boxes=np.array([[2.02, -5.0, -5.0, 2.08, 5.0, 5.0]]))
details = pytest.mark.parametrize("detail", ["footprint", "pixel"])
kinds = pytest.mark.parametrize("kind", ["planar", "radial"])


def ahead(name="front", kind="planar"):
    """A camera at the origin that looks along x, with all of the grid in its image."""
    return scenes.camera_at(name, (0, 0, 0), (1, 0, 0), size=(96, 72), focal=60.0, kind=kind)


@details
@kinds
def test_an_explained_ray_is_free_up_to_the_model_unseen_behind_and_never_disputed(detail, kind):
    camera = ahead(kind=kind)
    frame = scenes.frame_of(camera, WALL)
    evidence = carve(GRID, [camera], [frame], detail=detail, model_depth={"front": frame.depth_m})
    assert not evidence.disputed.any()
    assert not evidence.surface.any()
    free = resolve(evidence, [camera], detail=detail).free
    unexplained = reconstruct(GRID, [camera], [frame], detail=detail)
    assert free[1:9].all()
    assert not free[10:].any()
    assert not (unexplained.free & ~free).any()
    # the two others see through what the first one explains: it does not stand against them
    others = [ahead(name, kind) for name in ("left", "right")]
    empty = [scenes.frame_of(other, scenes.Scene()) for other in others]
    group = [camera, *others]
    explained = carve(
        GRID, group, [frame, *empty], detail=detail, model_depth={"front": frame.depth_m}, complete=True
    )
    for rule in ("three", "majority"):
        assert resolve(explained, group, rule=rule, detail=detail).free.all()
    disputed = carve(GRID, group, [frame, *empty], detail=detail, complete=True)
    assert not resolve(disputed, group, detail=detail).free[10].any()


@details
def test_an_explained_pixel_frees_nothing_beyond_the_model_though_more_was_measured(detail):
    camera = ahead()
    frame = scenes.frame_of(camera, WALL)
    model = np.full_like(frame.depth_m, 1.55)
    free = resolve(carve(GRID, [camera], [frame], detail=detail, model_depth={"front": model}), [camera]).free
    assert free[1:5].all()
    assert not free[5:].any()


@pytest.fixture(scope="module")
def arm(tmp_path_factory):
    return machines.slider_and_arm(tmp_path_factory.mktemp("arm"))


def test_a_hand_in_a_voxel_of_the_body_stays_blocked(arm):
    grid = machines.room(0.1)
    plain = bits.unpack(body_words(arm, HOME, grid), grid)
    inside = np.argwhere(plain)[plain.sum() // 2]
    hand = np.zeros(grid.shape, dtype=bool)
    hand[tuple(inside)] = True
    evidence = carve(grid, [], [], unexplained=bits.pack(hand, grid))
    space = resolve(evidence, [], machine=arm, joints=HOME)
    np.testing.assert_array_equal(space.free, plain & ~hand)
    assert space.surface[tuple(inside)]
    assert bits.unpack(space.disputed_words, grid)[tuple(inside)]
    # what lies beside the body does not take away what cameras have seen through
    beside = ~plain
    cameras = ring(grid)
    frames = [scenes.frame_of(camera, scenes.Scene()) for camera in cameras]
    seen = resolve(carve(grid, cameras, frames, unexplained=bits.pack(beside, grid)), cameras)
    np.testing.assert_array_equal(
        resolve(
            carve(grid, cameras, frames, unexplained=bits.pack(beside, grid)),
            cameras,
            machine=arm,
            joints=HOME,
        ).free,
        seen.free | plain,
    )


def ring(grid, count=6, **more):
    """Cameras around a grid that look at its middle, with most of it in their images."""
    middle = (grid.lower_m + grid.upper_m) / 2
    angles = np.linspace(0, 2 * np.pi, count, endpoint=False) + 0.2
    return [
        scenes.camera_at(
            f"c{n}",
            middle + (2.6 * np.cos(a), 2.6 * np.sin(a), 0.9 * (-1) ** n),
            middle,
            size=(96, 72),
            focal=55.0,
            **more,
        )
        for n, a in enumerate(angles)
    ]


# the links of the arm at HOME, as boxes and a ball that can be ray-cast exactly
BODY = scenes.Scene(
    balls=np.array([[0.6, 0.0, 0.6, 0.09]]),
    boxes=np.array(
        [
            [-0.1, -0.1, -0.1, 0.1, 0.1, 0.1],
            [-0.15, -0.1, 0.2, 0.15, 0.1, 0.4],
            [0.0, -0.05, 0.44, 0.6, 0.05, 0.56],
        ]
    ),
)


CLEARANCE_M = 0.5 * 4.5 / 55 * np.sqrt(3)
"""An unexplained return marks what lies within half a pixel pitch of it, here at most 4.5 m away, on each axis."""


def room_with_arm(seed, arm, kind):
    """Cameras around the arm, some objects none of whose returns marks a voxel of its body, frames at NOW."""
    rng = np.random.default_rng(seed)
    grid = machines.room(0.1)
    body = bits.unpack(body_words(arm, HOME, grid), grid)
    cameras = ring(grid, int(rng.integers(3, 7)), kind=kind)
    scene = scenes.Scene(balls=BODY.balls, boxes=BODY.boxes)
    for _ in range(4):
        centre = grid.lower_m + rng.random(3) * (grid.upper_m - grid.lower_m)
        ball = np.array([[*centre, rng.uniform(0.1, 0.3)]])
        if not (scenes.touched(grid, scenes.Scene(balls=ball + (0, 0, 0, CLEARANCE_M))) & body).any():
            scene.balls = np.concatenate([scene.balls, ball])
    frames = [DepthFrame(c.name, NOW, scenes.depth_of(c, scene)) for c in cameras]
    return rng, grid, cameras, scene, frames


@settings(derandomize=True, max_examples=12)
@given(
    seed=st.integers(0, 10**6),
    ways=st.sets(st.sampled_from(WAYS), min_size=1),
    detail=st.sampled_from(["footprint", "pixel"]),
    kind=st.sampled_from(["planar", "radial"]),
    rule=st.sampled_from(["three", "majority"]),
)
def test_less_evidence_never_makes_a_verdict_milder(arm, seed, ways, detail, kind, rule):
    rng, grid, cameras, _, frames = room_with_arm(seed, arm, kind)
    margin = some_margin(rng)
    fewer, wider = weakened(rng, frames, margin, ways)
    same = {"rule": rule, "detail": detail, "now_ns": NOW, "max_age_ns": AGE, "machine": arm, "joints": HOME}
    full = reconstruct(grid, cameras, frames, margin=margin, **same)
    weak = reconstruct(grid, cameras, fewer, margin=wider, **same)
    assert not (weak.free & ~full.free).any()
    motions = joint_motions(arm, {"slide": 0.2, "turn": 0.5, "nod": 0.5}, 0.5)
    for less, more in zip(
        check_motions(weak, arm, HOME, motions), check_motions(full, arm, HOME, motions), strict=True
    ):
        assert less.level.rank <= more.level.rank
        assert less.free_travel <= more.free_travel


@settings(derandomize=True, max_examples=8)
@given(
    seed=st.integers(0, 10**6),
    detail=st.sampled_from(["footprint", "pixel", "point"]),
    rule=st.sampled_from(["three", "majority"]),
    is_larger=st.booleans(),
)
def test_cameras_need_not_be_asked_of_what_is_free_as_body_anyway(arm, seed, detail, rule, is_larger):
    rng, grid, cameras, _, frames = room_with_arm(seed, arm, "planar")
    # so that some of the body is disputed, and some of it holds what the model does not explain
    frames = [replace(f, depth_m=f.depth_m * rng.choice((1.0, 0.95), f.depth_m.shape)) for f in frames]
    terms = Terms(rule, detail)
    images = room_images(cameras, frames)
    explained = explain(grid, arm, images, Snapshot.taken(frames, HOME), terms)
    own = own_body(grid, cameras, arm, HOME, terms)
    if is_larger:
        own = OwnBody(own.covered, own.covered & rng.integers(0, 2**64, len(own.covered), dtype=np.uint64))
    decided = own.decided(explained.unexplained_words)
    assert decided.any() and (decided & ~own.covered == 0).all()
    asked, spared = (
        decide_around(
            carve_images(
                grid, images, replace(explained, decided_words=words), terms, complete=terms.needs_counts
            ),
            cameras,
            own,
            terms,
        )
        for words in (None, decided)
    )
    for name in ("free_words", "surface_words", "blind_words", "disputed_words", "body_words"):
        np.testing.assert_array_equal(getattr(spared, name), getattr(asked, name))


@pytest.mark.parametrize("kind", ["planar", "radial"])
def test_the_arm_alone_may_move(arm, kind):
    """The law above is not kept by blocking everything: seen from all around, the arm's own body is explained."""
    grid = machines.room(0.1)
    cameras = ring(grid, 6, kind=kind)
    frames = [scenes.frame_of(camera, BODY) for camera in cameras]
    space = reconstruct(grid, cameras, frames, machine=arm, joints=HOME)
    body = bits.unpack(body_words(arm, HOME, grid), grid)
    assert space.free[body].all()
    nods = check_motions(space, arm, HOME, joint_motions(arm, {"slide": 0.1, "turn": 0.2, "nod": 0.2}, 0.2))
    assert all(verdict.free_travel > 0 for verdict in nods)


@pytest.mark.parametrize("growth_m", [0.03, 0.05, 0.12])
def test_the_body_is_taken_out_by_the_growth_that_is_given_but_for_what_else_was_seen_there(arm, growth_m):
    grid = machines.room(0.1)
    cameras = ring(grid, 6)
    body = bits.unpack(body_words(arm, HOME, grid, growth_m), grid)
    frames = [scenes.frame_of(camera, BODY) for camera in cameras]
    space = reconstruct(grid, cameras, frames, machine=arm, joints=HOME, body_growth_m=growth_m)
    np.testing.assert_array_equal(bits.unpack(space.body_words, grid), body)
    # a hand 5 cm beside the arm
    hand = np.array([0.33, 0.2, 0.5, 0.1])
    scene = scenes.Scene(balls=np.vstack([BODY.balls, hand]), boxes=BODY.boxes)
    frames = [scenes.frame_of(camera, scene) for camera in cameras]
    space = reconstruct(grid, cameras, frames, machine=arm, joints=HOME, body_growth_m=growth_m)
    touched = machines.touched_by_ball(grid, hand[:3], hand[3])
    assert not (space.free & touched).any()
    assert (body & touched).any() == (growth_m == 0.12)


def test_a_growth_below_a_quarter_voxel_is_refused(arm):
    grid = machines.room(0.1)
    with pytest.raises(MachineError, match=r"growth_m is 0\.02"):
        reconstruct(grid, ring(grid), [], machine=arm, joints=HOME, body_growth_m=0.02)
