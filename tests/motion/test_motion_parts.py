"""What stops a motion is looked at again in parts."""

from dataclasses import replace

import numpy as np
import pytest

from elbowroom.geometry import VoxelGrid, bits
from elbowroom.machine import Zone
from elbowroom.motion import Cause, check_motions, joint_motions
from elbowroom.motion.check import MOST_LOOKS
from elbowroom.reconstruct import FreeSpace, reconstruct
from reference import motion_machines as machines
from reference import reconstruct_scenes as scenes
from reference.motion_machines import HOME, room

GRID = room(0.1)
SEEDS = range(5)


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


def in_parts(space):
    """The space in voxels of a quarter of the edge, each free if its voxel is, or it as a part of it."""
    fine = VoxelGrid(
        tuple(space.grid.lower_m), tuple(4 * n for n in space.grid.shape), space.grid.voxel_size_m / 4
    )
    free = space.free.repeat(4, 0).repeat(4, 1).repeat(4, 2)
    near = np.zeros(space.grid.shape, dtype=bool)
    near[4:-4, 4:-4, 4:-4] = True
    for i, j, k in np.argwhere(~space.free & near):
        word = np.array([space.free_parts((i, j, k))]).view(np.uint8)
        parts = np.unpackbits(word, bitorder="little").view(bool).reshape(4, 4, 4)
        free[4 * i : 4 * i + 4, 4 * j : 4 * j + 4, 4 * k : 4 * k + 4] = parts
    return FreeSpace.from_occupied(fine, ~free)


def test_a_motion_goes_on_through_free_parts_and_no_farther(arm):
    motions = joint_motions(arm, {"slide": 0.4, "turn": 1.0, "nod": 1.0}, 0.5)
    farther = as_far = 0
    for seed in SEEDS:
        space = space_among_balls(arm, seed)
        looked = check_motions(space, arm, HOME, motions)
        before = check_motions(space.released(), arm, HOME, motions)
        at_most = check_motions(in_parts(space), arm, HOME, motions)
        for one, less, most in zip(looked, before, at_most, strict=True):
            assert less.free_travel <= one.free_travel
            if not one.escapes and not less.escapes:
                # the finer sweep ends later, by no more than an interval
                assert one.free_travel <= most.free_travel
                as_far += most.free_travel - one.free_travel < 0.01
            farther += one.free_travel > less.free_travel
    assert farther > len(SEEDS) and as_far > 2 * len(SEEDS)


class AnotherComputer:
    """What a space was made of, elsewhere: it says that all parts of every voxel are free."""

    def __init__(self):
        self.asked = []

    def free_parts(self, space, index):
        self.asked.append(index)
        return ~np.uint64(0)


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
    assert verdict.cause is Cause.UNSEEN


def test_no_part_of_a_zone_kept_out_is_free(arm):
    """Cameras see that it is empty; a person said that links are kept out of it."""
    space, way = (
        space_among_balls(arm, 3),
        joint_motions(arm, {"slide": 0.4, "turn": 1.0, "nod": 1.0}, 0.5)[:1],
    )
    guarded = arm.with_zones(Zone.box("door", "kept_out", (0.81, -1, 0.3), (0.99, 1, 0.8)))
    (found,) = check_motions(space, guarded, HOME, way)
    (from_the_volume,) = check_motions(space.released(), guarded, HOME, way)
    (without,) = check_motions(space, arm, HOME, way)
    assert (found.cause, found.zone) == (Cause.KEPT_OUT, "door")
    assert found.free_travel == from_the_volume.free_travel < without.free_travel
