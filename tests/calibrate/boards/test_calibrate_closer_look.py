"""Images that do not show the board as it is described: what is believed of them instead."""

from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from elbowroom.calibrate import Board
from elbowroom.calibrate.boards.closer_look import Looks, closer_look
from elbowroom.calibrate.boards.trouble import Fault, Trouble
from elbowroom.geometry import DepthCamera, Intrinsics
from elbowroom.sources.layouts.image import Image

BOARD = Board(5, 4, 0.18, "cut_out", 0.04, marked=True)
CAMERA = DepthCamera("a", 64, 48, np.eye(4), Intrinsics(32.0, 32.0, 31.5, 23.5))
WORK = [(Image(CAMERA, None, Path("none.png"), 0.001), pose) for pose in range(40)]


def looks(counts, poses):
    """Images of some poses show a board of other counts, and none what is described."""

    def look(board, image, pose):
        if (board.columns, board.rows) == counts and pose in poses:
            return SimpleNamespace(camera="a", pose=pose)
        return Trouble("a", pose, Fault.NOT_SEEN)

    return Looks(look, lambda *_: Trouble("a", 0, Fault.NOT_SEEN), lambda *_: Trouble("a", 0, Fault.NOT_SEEN))


@pytest.fixture(autouse=True)
def views(monkeypatch):
    module = "elbowroom.calibrate.boards.closer_look"
    monkeypatch.setattr(f"{module}.BoardView", SimpleNamespace)


def test_other_counts_are_said_where_the_images_show_them():
    said = closer_look(BOARD, WORK, looks((6, 3), range(40)), others_see_it=False)
    assert said.startswith("the images show 6 x 3 inner corners (columns x rows), not 5 x 4")


@pytest.mark.parametrize(("share", "is_said"), [(0.0, True), (0.2, False), (0.5, False)])
def test_a_few_misread_images_say_nothing_where_the_board_is_seen_as_described_elsewhere(share, is_said):
    said = closer_look(BOARD, WORK, looks((6, 3), (0, 39)), others_see_it=False, seen_share=share)
    assert bool(said) == is_said
