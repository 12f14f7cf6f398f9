"""Where frames come from: recordings on disk, the simulated room; and what a simulated moment is written as."""

from elbowroom.sources.depth_png import read_depth_png
from elbowroom.sources.recorded import RecordedMoment, check_images, excluded_frames, moments, silent_cameras

__all__ = [
    "RecordedMoment",
    "check_images",
    "excluded_frames",
    "moments",
    "read_depth_png",
    "silent_cameras",
]
