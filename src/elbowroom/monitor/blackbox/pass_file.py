"""One file of passes, as they are kept."""

import errno
import shutil
from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

from elbowroom.monitor.blackbox.kept_pass import KeptPass
from elbowroom.wire.mcap_writer import Attached, McapWriter, Told

LEAST_FREE_BYTES, LEAST_FREE_SHARE = 1_000_000_000, 0.05
"""Of a disk so much is left to others, or this share of a small one: what a gate has to remember must find room."""


class Head(NamedTuple):
    """What each file begins with.

    Args:
        attached: files within it.
        still: messages that are said once.
    """

    attached: Sequence[Attached]
    still: Sequence[Told]


class PassFile:
    """A file that passes are added to; a frame is written with the first pass that it is part of.

    Args:
        path: of a file that is not there yet.
        head: what it begins with.

    Raises:
        OSError: it cannot be written; here and in every call.
    """

    def __init__(self, path: Path, head: Head) -> None:
        self._writer = McapWriter(path, head.attached)
        self._still = list(head.still)
        self._newest: dict[str, int] = {}
        self.path, self.passes = path, 0

    def add(self, one: KeptPass) -> None:
        """Writes a pass."""
        new = [frame for frame in one.frames if self._newest.get(frame.camera) != frame.number]
        try:
            require_free(self.path)
            self._writer.step([*self._still, *(frame.told for frame in new), *one.messages], one.time_ns)
        except OSError:
            self._writer.drop()
            raise
        self._still = []
        self._newest |= {frame.camera: frame.number for frame in new}
        self.passes += 1

    def end(self) -> str:
        """Ends it; what is said of it."""
        self._writer.end()
        megabytes = self._writer.length / 1e6
        return f"{self.path}: {self.passes} passes, {megabytes:.1f} MB, sum {self._writer.sum[:16]}"


def require_free(path: Path) -> None:
    """Leaves some of a disk to others.

    Args:
        path: of a file on it.

    Raises:
        OSError: so little is free that no more should be written.
    """
    disk = shutil.disk_usage(path.parent)
    if disk.free < min(LEAST_FREE_BYTES, LEAST_FREE_SHARE * disk.total):
        raise OSError(
            errno.ENOSPC, f"{disk.free / 1e6:.0f} MB of the disk are free, which are left to others"
        )
