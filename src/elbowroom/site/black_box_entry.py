"""What a site file says of the black box: where a file for each stop lies, and how much of it is kept."""

from pathlib import Path
from typing import Annotated

from elbowroom.site.entry import Entry, Number, Text
from elbowroom.site.paths import expand
from elbowroom.site.ranges import MILLISECONDS, between


class BlackBoxEntry(Entry):
    """The last minute of a run in memory; each stop leaves a file.

    Without `memory_mb` it takes 6000 MB at most, and no more than a quarter of this computer's memory.
    """

    folder: Text | None = None
    before_s: Annotated[Number, between(1, 600, "s", MILLISECONDS)] = 60.0
    after_s: Annotated[Number, between(1, 600, "s", MILLISECONDS)] = 10.0
    memory_mb: Annotated[Number, between(16, 1_000_000, "MB")] | None = None

    def folder_path(self, beside: Path) -> Path | None:
        """Where the files lie; None: the file does not say.

        Args:
            beside: the site file's folder.
        """
        return None if self.folder is None else expand(self.folder, beside)
