"""Depth images packed: the same bits come back, as few bytes as the page says, and nothing malformed is believed."""

import tracemalloc

import numpy as np
import pytest
import zstandard
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays
from numba import njit

from elbowroom.errors import BagError
from elbowroom.sensing import DepthFrame
from elbowroom.wire import depth_codec
from elbowroom.wire.depth_codec import (
    BYTES,
    FLOATS,
    HALVES,
    HEAD,
    ROWS,
    Units,
    head_of,
    pack_depth,
    unpack_depth,
    unpack_units,
)
from elbowroom.wire.kernels import rows as row_kernels
from reference.wire_depth import plain_content, plain_rows, plain_zigzags

SHAPES = st.tuples(st.integers(1, 9), st.integers(1, 40))
RAW = SHAPES.flatmap(lambda shape: arrays.arrays(np.uint16, shape))
SMOOTH = SHAPES.flatmap(lambda shape: arrays.arrays(np.uint16, shape, elements=st.integers(1000, 1004)))
ANY_FLOATS = SHAPES.flatmap(lambda shape: arrays.arrays(np.float32, shape))
UNITS = st.sampled_from([Units(0.001), Units(0.0002), Units(0.0001, -0.013), Units(0.00025, 0.02)])


def frame_of(raw, units):
    return DepthFrame.from_raw("c", 0, raw, scale_m=units.scale_m, bias_m=units.bias_m).depth_m


@given(st.one_of(RAW, SMOOTH), UNITS)
def test_what_a_sensor_counted_comes_back_bit_for_bit_and_as_units(raw, units):
    raw = np.where(raw > 60000, 0, raw)
    depth_m = frame_of(raw, units)
    packed = pack_depth(depth_m, units)
    assert head_of(packed, "it").kind in (BYTES, HALVES, ROWS)
    assert unpack_depth(packed, "it").tobytes() == depth_m.tobytes()
    if not units.bias_m:
        assert (unpack_units(packed, "it") == raw).all()


@given(ANY_FLOATS, st.one_of(st.none(), UNITS))
def test_any_floats_come_back_bit_for_bit(depth_m, units):
    packed = pack_depth(depth_m, units)
    assert unpack_depth(packed, "it").tobytes() == depth_m.tobytes()


@given(st.one_of(RAW, SMOOTH))
def test_content_is_that_of_the_plain_twin(raw):
    raw, units = np.where(raw > 60000, 0, raw), Units(0.001)
    for depth_m, meant in ((frame_of(raw, units), units), (raw.astype(np.float32) / 3, None)):
        packed = pack_depth(depth_m, meant)
        head = head_of(packed, "it")
        if head.kind == ROWS:
            assert packed[HEAD.size :] == plain_rows(plain_zigzags(raw.ravel().tolist(), 16))
            continue
        found = zstandard.ZstdDecompressor().decompress(packed[HEAD.size :])
        assert found == plain_content(depth_m, None if meant is None else raw, head.kind == HALVES)


@given(st.lists(st.integers(0, 60000) | st.integers(0, 40), min_size=1, max_size=90))
def test_rows_are_those_of_the_plain_twin(numbers):
    raw = np.array([numbers], np.uint16)
    words, widths = np.zeros(raw.size + 24, np.uint16), np.zeros(-(-raw.size // 16), np.uint8)
    depth_m = frame_of(raw, Units(0.001)).reshape(-1)
    used = row_kernels.pack_rows(
        depth_m, depth_m.view(np.int32), np.float32(0.001), np.float32(0), widths, words
    )
    found = widths.tobytes() + words[: 8 * used].tobytes()
    assert found == plain_rows(plain_zigzags(numbers, 16))
    again = np.zeros(raw.size, np.uint16)
    assert row_kernels.from_rows(widths, words[: 8 * used], again) and (again == raw).all()


@pytest.mark.parametrize("size", [2047, 2048, 2049, 4096, 2048 + 7])
def test_rows_go_on_from_piece_to_piece(size):
    raw = np.random.default_rng(3).integers(0, 60000, (1, size)).astype(np.uint16)
    packed = pack_depth(frame_of(raw, Units(0.001)), Units(0.001))
    assert head_of(packed, "it").kind == ROWS
    assert packed[HEAD.size :] == plain_rows(plain_zigzags(raw.ravel().tolist(), 16))
    assert (unpack_units(packed, "it") == raw).all()


@given(st.lists(st.integers(0, 65535), min_size=8, max_size=8), st.integers(0, 15), st.integers(0, 65535))
def test_a_row_of_vectors_is_the_row_of_numpy(row, filled, before):
    numbers = np.array([9] * 8 + row, np.uint16)
    words = np.array([7] * 8 + [before & ((1 << filled) - 1)] * 8 + [3] * 16, np.uint16)
    plain = words.copy()
    width = row_kernels.put_row(numbers, 1, plain, 1, filled)
    assert compiled_row(numbers, 1, words, 1, filled) == width == max(row).bit_length()
    assert (words == plain).all()


@njit
def compiled_row(numbers, row, words, at, filled):
    return row_kernels.put_row(numbers, row, words, at, filled)


@given(st.one_of(RAW, SMOOTH), st.booleans())
def test_what_earlier_versions_packed_is_read(raw, is_half):
    raw = np.where(raw > 60000, 0, raw)
    depth_m, height, width = frame_of(raw, Units(0.001)), *raw.shape
    content = plain_content(depth_m, raw, is_half)
    apart = (len(content) - ((raw.size + 1) // 2 if is_half else raw.size)) // 2
    head = HEAD.pack(b"EBD1", HALVES if is_half else BYTES, width, height, apart, 0.001, 0.0)
    packed = head + zstandard.ZstdCompressor().compress(content)
    assert unpack_depth(packed, "it").tobytes() == depth_m.tobytes()


@pytest.mark.parametrize("more", [b"", b"\x00", b"\x00" * 16, b"\xff" * 600, b"\x00" * 47])
def test_rows_of_another_length_than_they_say_are_refused(more):
    head = HEAD.pack(b"EBD2", ROWS, 32, 24, 0, 0.001, 0.0)
    raw = np.random.default_rng(4).integers(900, 1100, (24, 32)).astype(np.uint16)
    whole = pack_depth(frame_of(raw, Units(0.001)), Units(0.001))
    for damaged in (head + more, whole + more, whole[: len(whole) - 16] + more, whole[:-3] + more):
        if damaged != whole and len(damaged) != len(whole):
            with pytest.raises(BagError, match="it: "):
                unpack_depth(damaged, "it")


@pytest.mark.parametrize("value", [np.nan, np.inf, -0.0, -1.0, 1e9, 65.536, 0.0005])
def test_what_no_unit_is_stays_what_it_was(value):
    depth_m = np.full((4, 6), 1.0, np.float32)
    depth_m[2, 3] = value
    packed = pack_depth(depth_m, Units(0.001))
    assert head_of(packed, "it").kind == FLOATS
    assert unpack_depth(packed, "it").tobytes() == depth_m.tobytes()


def test_a_smooth_image_takes_a_small_part_of_its_sixteen_bits():
    ramp = (1000 + np.add.outer(np.arange(480), np.arange(640)) // 8).astype(np.uint16)
    noise = np.random.default_rng(1).integers(-2, 3, ramp.shape)
    packed = pack_depth(frame_of((ramp + noise).astype(np.uint16), Units(0.001)), Units(0.001))
    assert head_of(packed, "it").kind == HALVES
    assert len(packed) < 2 * ramp.size / 4


@settings(max_examples=300)
@given(st.data())
def test_a_damaged_image_is_an_error_or_an_image_and_makes_nothing_large(data):
    raw = np.random.default_rng(2).integers(900, 1100, (24, 32)).astype(np.uint16)
    packed = bytearray(pack_depth(frame_of(raw, Units(0.001)), Units(0.001)))
    for at in data.draw(st.lists(st.integers(0, len(packed) - 1), min_size=1, max_size=4)):
        packed[at] = data.draw(st.integers(0, 255))
    del packed[data.draw(st.integers(0, len(packed))) :]
    tracemalloc.start()
    try:
        assert unpack_depth(bytes(packed), "it").dtype == np.float32
    except BagError as error:
        assert str(error).startswith("it: ")
    finally:
        peak = tracemalloc.get_traced_memory()[1]
        tracemalloc.stop()
    assert peak < 8 * 4 * raw.size + 100_000  # what is called first takes some


@pytest.mark.parametrize(
    "head",
    [
        HEAD.pack(b"EBD2", 0, 4, 4, 0, 1.0, 0.0),
        HEAD.pack(b"EBD1", 3, 4, 4, 0, 1.0, 0.0),
        HEAD.pack(b"EBD2", 3, 4, 4, 1, 1.0, 0.0),
        HEAD.pack(b"EBD2", 3, 0, 4, 0, 1.0, 0.0),
        HEAD.pack(b"EBD2", 3, 8192, 8192, 0, 1.0, 0.0),
        HEAD.pack(b"EBD3", 3, 4, 4, 0, 1.0, 0.0),
        HEAD.pack(b"EBD1", 0, 0, 4, 0, 1.0, 0.0),
        HEAD.pack(b"EBD1", 0, 1 << 31, 1 << 31, 0, 1.0, 0.0),
        HEAD.pack(b"EBD1", 0, 4, 4, 17, 1.0, 0.0),
        HEAD.pack(b"EBD1", 0, 4, 4, 0, float("nan"), 0.0),
        HEAD.pack(b"EBD1", 0, 4, 4, 0, -1.0, 0.0),
        b"EBD1",
        b"",
    ],
)
def test_a_head_that_no_image_has_is_refused(head):
    with pytest.raises(BagError, match="it: "):
        unpack_depth(head + zstandard.ZstdCompressor().compress(b"\x00" * 16), "it")


def test_less_or_more_than_the_head_says_is_refused_before_it_is_unpacked(monkeypatch):
    bomb = zstandard.ZstdCompressor().compress(bytes(50_000_000))
    tracemalloc.start()
    with pytest.raises(BagError, match="another size"):
        unpack_depth(HEAD.pack(b"EBD1", 0, 4, 4, 0, 1.0, 0.0) + bomb, "it")
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert peak < 1_000_000
    assert depth_codec.MOST_PIXELS == 1 << 26
