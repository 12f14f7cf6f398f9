"""Captures to try calibration on: what cameras would have recorded, and the truth beside it."""

from elbowroom.calibrate.simulated.board_capture import BoardCapture, record_board
from elbowroom.calibrate.simulated.hand_poses import Shown, hand_poses
from elbowroom.calibrate.simulated.room_capture import record_machine, record_room
from elbowroom.calibrate.simulated.start import Start, started
from elbowroom.calibrate.simulated.writer import CaptureWriter, read_truth

__all__ = [
    "BoardCapture",
    "CaptureWriter",
    "Shown",
    "Start",
    "hand_poses",
    "read_truth",
    "record_board",
    "record_machine",
    "record_room",
    "started",
]
