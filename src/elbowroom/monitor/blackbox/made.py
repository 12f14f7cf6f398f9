"""The recorder of a room, as its site and its run say it should be."""

from pathlib import Path

from elbowroom.errors import InputError
from elbowroom.files.atomic import folder as made_folder
from elbowroom.monitor.blackbox.recorder import Recorder, require_new
from elbowroom.monitor.blackbox.sinks import BlackBox, Sink, WholeRun
from elbowroom.site.black_box_entry import BlackBoxEntry
from elbowroom.site.memory import physical_memory_bytes
from elbowroom.sources import Room

SECOND_NS = 1_000_000_000
MOST_BYTES = 6_000_000_000
"""Of memory for the black box, where the site does not say [bytes]."""


def most_bytes(entry: BlackBoxEntry) -> int:
    """How much memory a black box may take [bytes]."""
    if entry.memory_mb is not None:
        return round(entry.memory_mb * 1e6)
    there = physical_memory_bytes()
    return MOST_BYTES if there is None else min(MOST_BYTES, there // 4)


def recorder_of(room: Room, file: Path | None = None, folder: Path | None = None) -> Recorder | None:
    """What keeps a run; None: nobody asked for it.

    Args:
        room: with its site.
        file: in which all is kept; None: in none.
        folder: in which a file for each stop is kept; None: as the site says.

    Raises:
        InputError: the file is there already, a folder is not, or the site has a black box and nobody says where.
        PackageError: zstandard is not installed.
    """
    sinks: list[Sink] = [] if file is None else [WholeRun(require_new(file))]
    entry = room.site.entry.black_box
    if entry is not None and folder is None:
        folder = entry.folder_path(room.site.path.parent)
        if folder is None:
            raise InputError(
                f"{room.site.path}: black_box: no folder for its files; write black_box.folder, or give --black-box"
            )
    if folder is not None:
        entry = entry or BlackBoxEntry()
        sinks.append(
            BlackBox(
                made_folder(folder),
                round(entry.before_s * SECOND_NS),
                round(entry.after_s * SECOND_NS),
                most_bytes(entry),
            )
        )
    return Recorder(sinks) if sinks else None
