"""Values that are kept: each comes back as it was, to the last bit, and nothing else is made of a text."""

import json

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from elbowroom.errors import BagError
from elbowroom.geometry import DepthCamera, Intrinsics, looking_at
from elbowroom.geometry.margin import Margin
from elbowroom.geometry.noise import NoiseModel
from elbowroom.machine import Machine
from elbowroom.machine.c_arm import ceiling_c_arm
from elbowroom.monitor.blackbox import kept_values
from elbowroom.monitor.blackbox.kept_values import kept, read, text_of
from elbowroom.motion import Motion, Override
from elbowroom.reconstruct import Terms
from elbowroom.site import Site

ANYTHING = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats(allow_nan=False) | st.text(),
    lambda inner: st.lists(inner).map(tuple) | st.dictionaries(st.text(), inner),
    max_leaves=12,
)


@given(ANYTHING)
def test_plain_values_come_back(value):
    again = read(text_of(value), "it")
    assert again == value
    assert text_of(again) == text_of(value)


@pytest.mark.parametrize(
    "value", [float("inf"), float("-inf"), -0.0, 0.1, 5e-324, np.float64(0.1), np.float32(0.1)]
)
def test_numbers_come_back_to_the_last_bit(value):
    assert np.float64(read(text_of(value), "it")).tobytes() == np.float64(value).tobytes()


def test_nan_comes_back():
    assert np.isnan(read(text_of({"x": float("nan")}), "it")["x"])


@pytest.mark.parametrize("dtype", ["f8", "f4", "i4", "u1", "?", "u8"])
def test_arrays_come_back(dtype):
    array = np.random.default_rng(1).integers(0, 2, (3, 4)).astype(dtype)
    again = read(text_of(array), "it")
    assert again.dtype == array.dtype and again.shape == array.shape and again.tobytes() == array.tobytes()


def machines() -> list[Machine]:
    site = Site.simulated_room()
    machine = site.machine()
    assert machine is not None
    return [ceiling_c_arm(), machine]


@pytest.mark.parametrize("machine", machines(), ids=lambda machine: machine.name)
def test_a_machine_comes_back_and_moves_as_before(machine):
    again = read(text_of(machine), "it")
    assert text_of(again) == text_of(machine)
    joints = dict.fromkeys(machine.joint_names, 0.05)
    for name, pose in machine.world_from_links(joints).items():
        assert pose.tobytes() == again.world_from_links(joints)[name].tobytes()


def test_cameras_terms_and_motions_come_back():
    mask = np.zeros((48, 64), bool)
    mask[3:5] = True
    camera = DepthCamera(
        name="über der Tür",
        width=64,
        height=48,
        # a pose that is mended when a camera is made
        world_from_camera=looking_at((1.0, 2.0, 2.4), (0.1, 0.2, 0.3)) + 1e-9,
        intrinsics=Intrinsics(40.0, 41.0, 31.5, 23.5, (0.1, -0.2, 1e-3, 0.0, 0.05)),
        noise=NoiseModel(0.001, 0.002, 0.0019, 0.4),
        margin=Margin(2.5, bias_m=0.001),
        mask=mask,
    )
    terms = Terms("majority", "footprint", Margin(lateral_px=1.0), max_age_ns=200_000_000, body_growth_m=0.03)
    values = (
        camera,
        terms,
        Override(0.2, 0.1, {"slide": 0.5}),
        (Motion("long", 1, 0.1), Motion("larm", -1, 0.2, 0.7)),
    )
    again = read(text_of(values), "it")
    assert text_of(again) == text_of(values)
    assert again[1] == terms
    assert again[0].world_from_camera.tobytes() == camera.world_from_camera.tobytes()
    assert not again[0].mask.flags.writeable


@pytest.mark.parametrize(
    "text",
    [
        "",
        "[",
        '{"of": "Popen", "fields": {}}',
        '{"of": "Machine", "fields": {}}',
        '{"of": "VoxelGrid", "fields": {"origin_m": [0, 0, 0], "shape": [0, 1, 1], "voxel_size_m": 0.1}}',
        '{"array": "|O", "shape": [1], "data": ""}',
        '{"array": "<f8", "shape": [2], "data": "AAAA"}',
        '{"array": "<f8", "shape": [100000000000], "data": ""}',
        '{"map": [[[1, {"map": []}], 2]]}',
        '{"other": 1}',
        "[" * 5000,
    ],
)
def test_a_text_that_is_no_value_is_an_error(text):
    with pytest.raises(BagError, match="it: malformed"):
        read(text, "it")


def test_what_is_not_on_the_list_is_not_kept():
    with pytest.raises(TypeError, match="not kept"):
        kept(object())


@given(
    st.recursive(
        st.none() | st.integers() | st.text(),
        lambda inner: (
            st.lists(inner)
            | st.dictionaries(
                st.sampled_from(["of", "fields", "array", "shape", "data", "map", "float"])
                | st.sampled_from(list(kept_values.KINDS)),
                inner,
            )
        ),
        max_leaves=10,
    )
)
def test_any_json_is_a_value_or_an_error(given_json):
    try:
        read(json.dumps(given_json), "it")
    except BagError as error:
        assert str(error).startswith("it: malformed")
