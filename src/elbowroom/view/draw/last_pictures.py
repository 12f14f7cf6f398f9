"""The face that draws: pictures of the last pass of a run."""

from pathlib import Path

from rich.console import Console

from elbowroom.files.atomic import folder
from elbowroom.monitor import Pass
from elbowroom.sensing import Snapshot
from elbowroom.sources import Room
from elbowroom.view.draw.pictures import save_sections


class LastPictures:
    """Draws sections of the last pass when the run ends. A pass looks only where motions can go; pictures show all.

    Args:
        out: folder of the pictures, made if it is not there.
        console: told how many there are.

    Raises:
        InputError: the folder cannot be made.
    """

    def __init__(self, out: Path, console: Console) -> None:
        self._out, self._console = folder(out), console
        self._room: Room | None = None
        self._last: Snapshot | None = None
        self._failed = False

    def begin(self, room: Room) -> None:
        """Keeps the room, to be drawn at the end."""
        self._room = room

    def show(self, done: Pass) -> None:
        """Keeps the snapshot; the one before it is let go."""
        self._last, self._failed = done.snapshot, done.result.space is None

    def end(self) -> None:
        """Reconstructs all of the room once more, and draws it."""
        room, last = self._room, self._last
        if room is None or last is None:
            return
        if self._failed:
            self._console.print(
                "no pictures: the last cycle failed and has no free space", style="red", highlight=False
            )
            return
        paths = save_sections(room.space_of(last), self._out, room.machine, last.joints, room.cameras)
        self._console.print(
            f"{len(paths)} pictures of the last cycle in {self._out}", highlight=False, soft_wrap=True
        )
