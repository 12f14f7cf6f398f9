"""A reader takes each thing once, and leaves what was not shown; images wait for no pass."""

import time
from types import SimpleNamespace

import numpy as np
import pytest

from elbowroom.geometry import VoxelGrid, bits
from elbowroom.page.board import Board
from elbowroom.page.board.board import Sizes
from elbowroom.page.board.reader import Reader, look_until
from elbowroom.page.face import PageFace
from elbowroom.page.scene.near import Planes
from elbowroom.sensing import DepthFrame, Snapshot

GRID = VoxelGrid((0, 0, 0), (16, 16, 16), 0.1)
TOLD = {"joints": None, "now_ns": 7, "bounds": {}}


@pytest.fixture
def board():
    made = Board.made(Sizes(1 << 12, 1 << 16, 1 << 16))
    yield made
    made.forget()


def test_each_text_and_each_picture_is_read_once(board):
    reader = Reader(board)
    assert reader.told() is None and reader.images() is None
    board.tell({"sequence": 1})
    assert reader.told() == {"sequence": 1} and reader.told() is None
    board.tell({"sequence": 2})
    board.tell({"sequence": 3})
    assert reader.told() == {"sequence": 3} and reader.told() is None
    snapshot = Snapshot((DepthFrame("a", 5, np.ones((2, 2), np.float32)),), now_ns=7)
    board.answer(4, TOLD, snapshot)
    answered = reader.images()
    assert answered is not None and answered.number == 4 and reader.images() is None


def test_planes_stay_news_until_somebody_shows_them(board):
    reader, seen = Reader(board), []
    empty = bits.empty(GRID)
    board.show(1, Planes(empty, empty, empty, np.zeros(0, dtype=bool)))

    def show(is_shown: bool) -> None:
        reader.planes(lambda planes: seen.append(planes) is None and is_shown)

    show(False)
    show(False)
    assert len(seen) == 2
    show(True)
    show(True)
    assert len(seen) == 3


def test_looking_ends_when_it_is_over():
    looks: list[float] = []
    look_until(lambda: len(looks) == 3, looks.append)
    assert looks == sorted(looks) and len(looks) == 3


def test_images_are_handed_out_while_the_next_pass_is_waited_for(board, monkeypatch):
    face, answered = PageFace(board), []
    monkeypatch.setattr(PageFace, "_answer", lambda self: answered.append(time.monotonic()))
    face._last = SimpleNamespace()
    begun_s = time.monotonic()
    board.ask()
    face._rest(begun_s + 0.5)
    assert answered and answered[0] - begun_s < 0.2 and time.monotonic() - begun_s >= 0.5
