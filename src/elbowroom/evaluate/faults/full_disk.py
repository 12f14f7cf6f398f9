"""A disk that is full while a stop is saved: the machine stops all the same, it is said, and what was kept opens."""

import os
import random
import subprocess
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from elbowroom.errors import ElbowroomError
from elbowroom.evaluate.faults.cell import Cell
from elbowroom.evaluate.faults.faults import thrown
from elbowroom.evaluate.faults.kinds import kind_named
from elbowroom.monitor.blackbox.recording import Recording

CASE = "off, and the disk is full while the stop is saved"
FITS_BYTES = 262_144
"""So much the disk holds: less than the minute before a stop."""
SAYS_S = 5.0
FULL = ("No space left on device", "are left to others", "File too large")
"""What the system says: of a disk, and of a file where nobody may mount one."""


def full_disk_rows(times: int = 3, seed: int = 1, deadline_ms: float = 60.0) -> Iterator[dict[str, Any]]:
    """A row for each time that a camera goes off while the black box has no room for the stop.

    Args:
        times: how often.
        seed: of the moments and the cameras.
        deadline_ms: of the gate.

    Yields:
        Rows as of `fault_rows`; `named` holds only if the full disk is said as well, and what was kept can be read.

    Raises:
        ElbowroomError: as `fault_rows`.
    """
    chance = random.Random(seed)
    for _ in range(times):
        with TemporaryDirectory() as folder, small_disk(Path(folder) / "stops") as box:
            cell = Cell(Path(folder), deadline_ms)
            cell.black_box = box
            try:
                cell.start()
                row = thrown(cell, kind_named("off", "camera"), chance)
                said = cell.troubles or (cell.next_said("troubles", SAYS_S) or {}).get("troubles", [])
                is_said = any(text in line for line in said for text in FULL)
                row |= {"case": CASE, "named": row["named"] and is_said and opens(Path(box[0])), "disk": said}
                yield row
            finally:
                cell.end()


@contextmanager
def small_disk(folder: Path) -> Iterator[Sequence[str]]:
    """A folder that holds `FITS_BYTES`: a file system of its own, or files that may grow to no more.

    Args:
        folder: that is not there yet.

    Yields:
        What the monitor's process is told: the folder; then, where nobody may mount, how long a file may be.
    """
    folder.mkdir()
    size = f"size={FITS_BYTES}"
    is_mounted = False
    with suppress(OSError):
        words = ["mount", "-t", "tmpfs", "-o", size, "tmpfs", str(folder)]
        is_mounted = os.geteuid() == 0 and subprocess.run(words, capture_output=True).returncode == 0
    try:
        yield [str(folder)] if is_mounted else [str(folder), str(FITS_BYTES)]
    finally:
        if is_mounted:
            subprocess.run(["umount", "--lazy", str(folder)], capture_output=True, check=False)


def opens(folder: Path) -> bool:
    """Whether each file of a black box can be read, and says that it is cut off."""
    files = list(folder.glob("*.mcap"))
    for file in files:
        try:
            with Recording(file) as recording:
                list(recording.passes())
                if recording.note is None or recording.wrong() is not None:
                    return False
        except ElbowroomError:
            return False
    return bool(files)
