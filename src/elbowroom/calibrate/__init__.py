"""Where cameras are and how they see, from depth images of a board, of the machine, of the room; and how sure that is.

captures -> what was seen of the target -> first solution -> joint least squares -> pose, covariance -> margin
"""

from elbowroom.calibrate.board import Board
from elbowroom.calibrate.board_view import BoardView
from elbowroom.calibrate.calibrated_camera import CalibratedCamera
from elbowroom.calibrate.capture import Sightings, board_of, sightings
from elbowroom.calibrate.cut_out import cut_out_view
from elbowroom.calibrate.printed import printed_view
from elbowroom.calibrate.trouble import Fault, Trouble

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
