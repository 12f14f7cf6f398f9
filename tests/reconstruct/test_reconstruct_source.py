"""What a free space was made of: kept as long as somebody asks for it, and asked through an interface."""

import gc
import weakref
from dataclasses import replace

import numpy as np
import pytest

from elbowroom.errors import CameraError, EvidenceError, JointsError
from elbowroom.geometry import VoxelGrid
from elbowroom.machine.probe import probe
from elbowroom.motion import Motion, check_motion
from elbowroom.reconstruct import PointReport, Terms, free_space_of, reconstruct
from elbowroom.sensing import DepthFrame, JointRecord, Snapshot
from reference import reconstruct_scenes as scenes

GRID = VoxelGrid((1.0, -0.5, -0.5), (20, 10, 10), 0.1)
CAMERA = scenes.camera_at("front", (0, 0, 0), (1, 0, 0), size=(96, 72), focal=60.0)
POINT = (1.5, 0.0, 0.0)


def a_frame(stamp_ns=0):
    return DepthFrame("front", stamp_ns, np.full((72, 96), 2.0, dtype=np.float32))


def images_alive(space_of):
    """Whether an image is still there after its frame went, and the space that `space_of` makes of it is kept."""
    frame = a_frame()
    image = weakref.ref(frame.depth_m)
    space = space_of(frame)
    del frame
    gc.collect()
    assert space.free.any()
    return image() is not None


def test_a_space_keeps_its_images_until_it_is_released():
    assert images_alive(lambda frame: reconstruct(GRID, [CAMERA], [frame]))
    assert not images_alive(lambda frame: reconstruct(GRID, [CAMERA], [frame]).released())


def test_a_space_with_a_machine_keeps_neither_images_nor_what_the_machine_explains():
    def space_of(frame):
        space = reconstruct(GRID, [CAMERA], [frame], probe(), {"slide": 0.0})
        models.append(weakref.ref(space.source.model_depth["front"]))
        return space.released()

    models = []
    assert not images_alive(space_of)
    assert models[0]() is None


def test_a_released_space_is_the_same_space_that_explains_nothing():
    space = reconstruct(GRID, [CAMERA], [a_frame()])
    released = space.released()
    for plane in ("free_words", "surface_words", "blind_words", "disputed_words", "body_words"):
        np.testing.assert_array_equal(getattr(released, plane), getattr(space, plane))
    assert isinstance(space.explain(POINT), PointReport)
    with pytest.raises(EvidenceError, match="no frames at hand"):
        released.explain(POINT)
    assert released.released().source is None


class AnotherComputer:
    """It has the images; a space made there has it as its source here."""

    def __init__(self, there):
        self.there = there

    def report(self, space, index):
        return self.there.source.report(space, index)

    def free_parts(self, space, index):
        return self.there.source.free_parts(space, index)


def test_another_computer_may_answer_for_the_images():
    there = reconstruct(GRID, [CAMERA], [a_frame()])
    here = replace(there, source=AnotherComputer(there))
    assert str(here.explain(POINT)) == str(there.explain(POINT))
    machine, joints, motion = probe(), {"slide": 0.0}, Motion("slide", 1, 0.1)
    assert check_motion(here, machine, joints, motion) == check_motion(there, machine, joints, motion)


@pytest.mark.parametrize("detail", ["footprint", "pixel", "point"])
@pytest.mark.parametrize("rule", ["three", "majority", "veto", "any"])
def test_values_and_loose_arguments_say_the_same(rule, detail):
    joints, frame = {"slide": 0.02}, a_frame(50)
    one = reconstruct(
        GRID, [CAMERA], [frame], probe(), joints, rule=rule, detail=detail, now_ns=60, max_age_ns=20
    )
    terms = Terms(rule, detail, max_age_ns=20)
    other = free_space_of(GRID, [CAMERA], Snapshot((frame,), joints, now_ns=60), probe(), terms)
    for plane in ("free_words", "surface_words", "blind_words", "disputed_words", "body_words"):
        np.testing.assert_array_equal(getattr(one, plane), getattr(other, plane))
    assert other.source.terms == terms


RECORD = JointRecord(np.array([1000, 1100]), {"slide": np.array([0.0, 0.02])})


def test_a_record_is_not_asked_where_the_machine_was_at_a_frame_past_its_age():
    old = scenes.camera_at("old", (0, 0, 0), (1, 0, 0), size=(96, 72), focal=60.0)
    frames = [a_frame(1050), DepthFrame("old", -(10**9), np.ones((72, 96)))]
    given = (GRID, [CAMERA, old], frames, probe(), RECORD)
    limited = reconstruct(*given, now_ns=1060, max_age_ns=100)
    missing = reconstruct(GRID, [CAMERA, old], frames[:1], probe(), {"slide": 0.01})
    np.testing.assert_array_equal(limited.free_words, missing.free_words)
    with pytest.raises(JointsError, match="not known"):
        reconstruct(*given, now_ns=1060)


def test_a_frame_past_its_age_must_be_of_this_room_too():
    strangers = [a_frame(1050), DepthFrame("elsewhere", 0, np.ones((2, 2)))]
    with pytest.raises(CameraError, match="camera elsewhere is unknown"):
        reconstruct(GRID, [CAMERA], strangers, now_ns=1060, max_age_ns=100)
