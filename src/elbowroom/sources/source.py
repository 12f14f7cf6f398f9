"""What every source is: snapshots of a room, one after the other."""

from collections.abc import Iterator
from typing import Protocol

from elbowroom.sensing import Snapshot


class Source(Protocol):
    """Where snapshots come from: a recording, the simulated room, live cameras; one file each.

    Iterating begins: a recording at its first moment, the simulated room at time 0, live cameras now. Each step waits
    for something new and gives the newest frame of each camera that has one; a camera that was unplugged has an old
    one, or none. An iteration ends where nothing more will come.
    """

    @property
    def name(self) -> str:
        """What brings the frames, in a word for the screen: "simulator", "reading"."""

    def __iter__(self) -> Iterator[Snapshot]:
        """The snapshots, from the beginning."""

    def close(self) -> None:
        """Lets go of files and devices; nothing comes after it. Twice is as once."""
