"""What is due of the drift watch, by the kind of row."""

from collections.abc import Mapping

from elbowroom.evaluate.drift.scene import KNOCKED_FRAMES
from elbowroom.evaluate.due import Due, Row


def _runs(row: Row) -> float:
    return float(row["runs"])


DUE: Mapping[str, tuple[Due, ...]] = {
    "knock": (
        Due("named", "≥", _runs),
        Due("others_named", "≤", 0),
        Due("frames_max", "≤", KNOCKED_FRAMES),
    ),
    "wrong joint": (Due("cameras_named", "≤", 0),),
    "furniture": (Due("cameras_named", "≤", 0),),
    "false alarms": (
        Due("camera_frames", "≥", 10_000),
        Due("false_alarms", "≤", 0),
        Due("frames_in_doubt", "≤", 0),
    ),
    "doubt": (Due("in_doubt_at_once", "≥", _runs), Due("undoubted_frames", "≤", 0), Due("named", "≥", _runs)),
    "recorded": (Due("others_named", "≤", 0),),
    "watch time": (Due("median_ms", "≤", 3.0),),
}
