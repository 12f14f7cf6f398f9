"""Shared memory: the newest counts, nothing that is half written is read, and nobody waits."""

import threading
import time

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from elbowroom.geometry import VoxelGrid, bits
from elbowroom.page.board import Board, Section
from elbowroom.page.board.board import Sizes, read_images, read_planes
from elbowroom.page.board.section import space_for
from elbowroom.page.scene.near import Planes
from elbowroom.sensing import DepthFrame, Snapshot


def section(capacity: int) -> tuple[Section, Section]:
    """Of one memory, the writer's and the reader's."""
    memory = memoryview(bytearray(space_for(capacity)))
    return Section(memory, capacity), Section(memory, capacity)


@given(st.lists(st.lists(st.binary(max_size=40), max_size=4), max_size=8))
def test_what_was_written_last_is_read(written):
    writer, reader = section(64)
    assert reader.get() is None
    fitting = []
    for parts in written:
        whole = b"".join(parts)
        assert writer.put(parts) == (len(whole) <= 64)
        if len(whole) <= 64:
            fitting.append(whole)
        assert reader.get() == ((len(fitting), fitting[-1]) if fitting else None)


def test_what_a_writer_left_half_done_is_not_read():
    writer, reader = section(64)
    writer.put([b"whole"])
    writer.put([b"newer"])
    slot = writer._slot(2)
    slot[64] ^= 1
    assert reader.get() is None  # its sum is another
    slot[64] ^= 1
    slot[0] ^= 4
    assert reader.get() is None  # begun anew, and not ended
    writer.put([b"third"])
    assert reader.get() == (3, b"third")


@settings(max_examples=3)
@given(st.integers(1000, 100_000))
def test_while_somebody_writes_as_fast_as_can_be_what_is_read_is_of_one_piece(size):
    writer, reader = section(size)
    over, read = threading.Event(), []

    def write() -> None:
        number = 0
        while not over.is_set():
            number += 1
            writer.put([bytes([number % 256]) * size])

    thread = threading.Thread(target=write)
    thread.start()
    until = time.monotonic() + 0.3
    while time.monotonic() < until:
        found = reader.get()
        if found is not None:
            assert len(set(found[1])) == 1 and found[1][0] == found[0] % 256
            read.append(found[0])
    over.set()
    thread.join()
    assert read and read == sorted(read)


@pytest.fixture
def board():
    grid = VoxelGrid((0, 0, 0), (20, 30, 17), 0.1)
    made = Board.made(Sizes(1000, 64 + 25 * bits.word_count(grid), 5000))
    yield grid, made, Board.opened(made.said())
    made.forget()
    assert not made.path.exists()


def test_planes_and_images_come_over_as_they_were(board):
    grid, writer, reader = board
    chance = np.random.default_rng(0)
    planes = Planes(
        *(bits.pack(chance.random(grid.shape) < 0.5, grid) for _ in range(3)),
        chance.random(bits.word_count(grid)) < 0.5,
    )
    assert writer.show(7, planes)
    sequence, read = read_planes(reader.planes.get()[1])
    assert sequence == 7
    for name in Planes._fields:
        np.testing.assert_array_equal(getattr(read, name), getattr(planes, name))
    frame = DepthFrame("a", 5, chance.random((6, 8)).astype(np.float32))
    assert reader.ask() == writer.asked == 1
    told = {"joints": {"x": 1.0}, "now_ns": 9, "bounds": {}}
    assert writer.answer(1, told, Snapshot((frame,), {"x": 1.0}, {"a": {"x": 0.9}}, 9))
    answered = read_images(reader.images.get()[1])
    assert answered.number == 1 and answered.told == told and answered.snapshot.joints_of == {"a": {"x": 0.9}}
    np.testing.assert_array_equal(answered.snapshot.frames[0].depth_m, frame.depth_m)


def test_what_does_not_fit_is_not_told(board):
    _, writer, reader = board
    assert writer.tell({"a": 1}) and not writer.tell({"a": "x" * 2000})
    assert reader.text.get()[1] == b'{"a":1}'


def test_only_its_owner_can_open_it(board):
    assert board[1].path.stat().st_mode & 0o077 == 0
