"""Files that a power cut leaves as they were, or as they shall be: never in between."""

import os
from pathlib import Path


def write_durably(path: Path, content: bytes) -> None:
    """Replaces a file. When this returns, the new one is on the disk and stays there; readable by the owner alone.

    One writer at a time: what is unfinished has one name, and the next call takes its place.

    Args:
        path: of the file; its folder exists.
        content: all of it.

    Raises:
        OSError: it could not be written; the file is as it was.
    """
    unfinished = path.with_name(f".{path.name}.unfinished")
    # a pipe of that name, which nobody reads, is not waited for
    flags = os.O_WRONLY | os.O_CREAT | os.O_TRUNC
    flags |= getattr(os, "O_NOFOLLOW", 0) | getattr(os, "O_NONBLOCK", 0)
    try:
        file = os.open(unfinished, flags, 0o600)
        try:
            left = memoryview(content)
            while left:
                left = left[os.write(file, left) :]
            os.fsync(file)
        finally:
            os.close(file)
        unfinished.replace(path)
    except OSError:
        unfinished.unlink(missing_ok=True)
        raise
    _sync_folder(path.parent)


def _sync_folder(path: Path) -> None:
    """Brings a rename in a folder to the disk."""
    folder = os.open(path, os.O_RDONLY)
    try:
        os.fsync(folder)
    finally:
        os.close(folder)
