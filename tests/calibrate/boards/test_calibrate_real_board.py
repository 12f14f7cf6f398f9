"""The printed board of a real recording, in colour."""

import os
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from elbowroom.calibrate import Board, BoardView, Fault, Trouble, printed_view
from elbowroom.geometry import DepthCamera, Intrinsics

FOLDER = Path(os.environ.get("ELBOWROOM_DATA", "../shared/data")) / "kinect_board_2cam"
pytestmark = pytest.mark.skipif(not FOLDER.is_dir(), reason=f"no recording at {FOLDER}; set ELBOWROOM_DATA")


@pytest.mark.parametrize("side", ["left", "right"])
def test_the_board_of_pair_2_is_found(side: str) -> None:
    camera = DepthCamera(side, 640, 480, np.eye(4), Intrinsics(527.0, 529.0, 315.0, 268.0))
    grey = np.asarray(Image.open(FOLDER / f"{side}_2.rgb_board_only.png").convert("L"))
    view = printed_view(camera, Board(7, 4, 0.09), grey, None, 0)
    assert isinstance(view, BoardView), view
    assert len(view.corner_ids) == 28
    assert view.corner_sigma_px.max() < 0.6
    other = printed_view(camera, Board(8, 5, 0.09), grey, None, 0)
    assert isinstance(other, Trouble)
    assert other.fault is Fault.WRONG_COUNT
