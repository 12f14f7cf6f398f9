"""One file that says all of a room, and the recordings that belong to it."""

from elbowroom.site.depth_png import read_depth_png
from elbowroom.site.memory import Memory, memory_of
from elbowroom.site.recording import RecordedMoment, check_images, excluded_frames, moments, silent_cameras
from elbowroom.site.site import SIMULATED_ROOM, Site

__all__ = [
    "SIMULATED_ROOM",
    "Memory",
    "RecordedMoment",
    "Site",
    "check_images",
    "excluded_frames",
    "memory_of",
    "moments",
    "read_depth_png",
    "silent_cameras",
]
