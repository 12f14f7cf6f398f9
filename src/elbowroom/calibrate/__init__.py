"""Where cameras are and how they see, from depth images of a board, of the machine, of the room; and how sure that is.

captures -> what was seen of the target -> first solution -> joint least squares -> pose, covariance -> margin
"""

from elbowroom.calibrate.boards.board import Board
from elbowroom.calibrate.boards.board_view import BoardView
from elbowroom.calibrate.boards.capture import Sightings, board_of, sightings
from elbowroom.calibrate.boards.cut_out import cut_out_view
from elbowroom.calibrate.boards.printed import printed_view
from elbowroom.calibrate.boards.trouble import Fault, Trouble
from elbowroom.calibrate.result.calibrated_camera import CalibratedCamera

__all__ = [
    "Board",
    "BoardView",
    "CalibratedCamera",
    "Fault",
    "Sightings",
    "Trouble",
    "board_of",
    "cut_out_view",
    "printed_view",
    "sightings",
]
