"""Files that are whole or not there: written beside their place, then renamed into it."""

import os
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from elbowroom.errors import InputError


@contextmanager
def whole_file(path: Path | str) -> Iterator[Path]:
    """A path to write to, which becomes `path` when the block ends well and vanishes when it does not.

    Args:
        path: where the file shall be; its folder must exist. A file that is already there stays until the
            new one is whole.

    Raises:
        InputError: the folder does not exist or cannot be written to, or the path is a folder itself.
    """
    path = Path(path)
    if path.is_dir():
        raise InputError(f"{path}: is a folder; name a file")
    try:
        handle, name = tempfile.mkstemp(prefix=f".{path.name}.", suffix=path.suffix, dir=path.parent)
    except OSError as error:
        raise InputError(
            f"{path}: cannot be written ({error.strerror}); name a folder that exists"
        ) from error
    os.close(handle)
    unfinished = Path(name)
    try:
        yield unfinished
        unfinished.chmod(0o666 & ~_umask())
        unfinished.replace(path)
    finally:
        unfinished.unlink(missing_ok=True)


def _umask() -> int:
    """The permissions that new files of this process do not get; mkstemp gives its own to the owner alone."""
    mask = os.umask(0)
    os.umask(mask)
    return mask


def folder(path: Path | str) -> Path:
    """The folder of that name, made if it is not there.

    Raises:
        InputError: there is a file of that name, or it cannot be made.
    """
    path = Path(path)
    try:
        path.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise InputError(f"{path}: is no folder and cannot be made one ({error.strerror})") from error
    return path
