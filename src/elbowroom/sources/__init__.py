"""Where frames come from, as snapshots: recordings on disk, the simulated room; a source a file. Cameras of a site."""

from elbowroom.sources.cameras import cameras_of
from elbowroom.sources.depth_png import read_depth_png
from elbowroom.sources.looked import dark_note, looked_at
from elbowroom.sources.played import Played
from elbowroom.sources.recorded import (
    Recorded,
    check_images,
    clocks_of,
    excluded_frames,
    first_known,
    moments,
    silent_cameras,
    time_findings,
    times_of,
)
from elbowroom.sources.room import Room, live, open_room
from elbowroom.sources.source import Source

__all__ = [
    "Played",
    "Recorded",
    "Room",
    "Source",
    "cameras_of",
    "check_images",
    "clocks_of",
    "dark_note",
    "excluded_frames",
    "first_known",
    "live",
    "looked_at",
    "moments",
    "open_room",
    "read_depth_png",
    "silent_cameras",
    "time_findings",
    "times_of",
]
