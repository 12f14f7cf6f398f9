"""What stops a motion because no one camera sees all of it is looked at again in parts."""

from dataclasses import replace

import numpy as np
import pytest

from elbowroom.geometry import bits
from elbowroom.motion import check_motions, joint_motions
from elbowroom.motion.check import MOST_LOOKS
from elbowroom.reconstruct import reconstruct
from reference import motion_machines as machines
from reference import reconstruct_scenes as scenes
from reference.motion_machines import HOME, room

GRID = room(0.1)
SEEDS = range(30)


@pytest.fixture(scope="module")
def arm(tmp_path_factory):
    return machines.slider_and_arm(tmp_path_factory.mktemp("arm"))


def space_among_balls(arm, seed):
    """The arm among balls, from exact images of five cameras around it in which the arm is not seen."""
    rng = np.random.default_rng(seed)
    eyes = [(2.5 * np.cos(a), 2.5 * np.sin(a), rng.uniform(0.0, 2.0)) for a in rng.uniform(0, 2 * np.pi, 5)]
    cameras = [
        scenes.camera_at(f"c{n}", eye, (0.2, 0.0, 0.4), size=(160, 120), focal=110.0)
        for n, eye in enumerate(eyes)
    ]
    centres = rng.uniform(GRID.lower_m, GRID.upper_m, (30, 3))
    far = np.linalg.norm(centres - (0.3, 0.0, 0.5), axis=1) > 0.75
    scene = scenes.Scene(balls=np.column_stack([centres, rng.uniform(0.1, 0.2, 30)])[far])
    frames = [scenes.frame_of(camera, scene) for camera in cameras]
    return reconstruct(GRID, cameras, frames, looks=False).without(arm, HOME)


def with_free_parts(space):
    """The space with every voxel made free that is free in parts, and without its frames."""
    said = space.surface_words | space.blind_words | space.disputed_words
    free = space.free
    for index in np.argwhere(bits.unpack(space.blocked_words & ~said, space.grid)):
        free[tuple(index)] = space.is_free_in_parts(tuple(index))
    return replace(space, free_words=space.free_words | bits.pack(free, space.grid), source=None)


def test_a_motion_goes_on_through_voxels_that_are_free_in_parts_and_no_farther(arm):
    motions = joint_motions(arm, {"slide": 0.4, "turn": 1.0, "nod": 1.0}, 0.5)
    farther = 0
    for seed in SEEDS:
        space = space_among_balls(arm, seed)
        looked = check_motions(space, arm, HOME, motions)
        before = check_motions(space.released(), arm, HOME, motions)
        at_most = check_motions(with_free_parts(space), arm, HOME, motions)
        for one, less, most in zip(looked, before, at_most, strict=True):
            assert less.free_travel <= one.free_travel <= most.free_travel
            farther += one.free_travel > less.free_travel
            if one.free_travel < most.free_travel:
                # only where it met more of such voxels than it asks for
                index = tuple(GRID.index_of(one.place_in_world))
                assert with_free_parts(space).free[index]
    assert farther >= 3


class AnotherComputer:
    """What a space was made of, elsewhere: it says that every voxel is free in parts."""

    def __init__(self):
        self.asked = []

    def is_free_in_parts(self, space, index):
        self.asked.append(index)
        return True


def test_only_so_many_voxels_are_asked_for_each_motion(arm):
    source = AnotherComputer()
    space = space_among_balls(arm, 3)
    nothing = replace(
        space,
        free_words=space.body_words,
        surface_words=bits.empty(GRID),
        blind_words=bits.empty(GRID),
        disputed_words=bits.empty(GRID),
        source=source,
    )
    (verdict,) = check_motions(
        nothing, arm, HOME, joint_motions(arm, {"slide": 0.4, "turn": 1.0, "nod": 1.0}, 0.5)[:1]
    )
    assert len(source.asked) == MOST_LOOKS
    assert verdict.free_travel < verdict.motion.braking_distance
