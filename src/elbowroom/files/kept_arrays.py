"""Arrays that take long to make, kept in a folder of the user's from one process to the next.

A file is named after all that its arrays are made of, so that it is never out of date; its sums are checked where it is
read. Where nothing can be written or read, arrays are made anew each time: nobody needs the folder.
"""

import os
import zipfile
from collections.abc import Callable, Mapping
from contextlib import suppress
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from elbowroom.errors import InputError
from elbowroom.files.atomic import whole_file

Arrays = Mapping[str, NDArray[np.generic]]

LEAST_BYTES, MOST_BYTES = 100_000, 200_000_000
"""Smaller arrays are made as fast as they are read; larger ones would fill a disk."""
FOLDER_BYTES = 1_000_000_000
"""The folder holds no more: what was written first goes first."""


def cache_folder() -> Path | None:
    """ELBOWROOM_CACHE, or elbowroom/ in the user's folder of caches; None: nothing is kept.

    So it is where that variable is empty, and for users without a home.
    """
    given = os.environ.get("ELBOWROOM_CACHE")
    if given is not None:
        return Path(given) if given else None
    try:
        return Path(os.environ.get("XDG_CACHE_HOME") or "~/.cache").expanduser() / "elbowroom"
    except RuntimeError:
        return None


def kept_arrays(name: str, make: Callable[[], Arrays]) -> Arrays:
    """The arrays of this name: read if they were kept, else made, and kept.

    Args:
        name: of all that they are made of, such as a check sum; a file name.
        make: makes them.
    """
    folder = cache_folder()
    if folder is None:
        return make()
    path = folder / f"{name}.npz"
    # whatever is wrong with a file, it is as if it were not there
    with suppress(OSError, ValueError, KeyError, EOFError, zipfile.BadZipFile):
        return _read(path)
    arrays = make()
    if LEAST_BYTES <= sum(array.nbytes for array in arrays.values()) <= MOST_BYTES:
        with suppress(OSError, InputError):
            folder.mkdir(parents=True, exist_ok=True)
            with whole_file(path) as unfinished:
                np.savez(unfinished, allow_pickle=False, **arrays)
            _make_room(folder)
    return arrays


def _read(path: Path) -> Arrays:
    with path.open("rb") as stream, np.load(stream) as file:
        return {array: file[array] for array in file.files}


def _make_room(folder: Path) -> None:
    """Removes what was written first until the folder is no larger than it may be."""
    files = sorted(folder.glob("*.npz"), key=lambda file: file.stat().st_mtime, reverse=True)
    sizes = np.cumsum([file.stat().st_size for file in files])
    for file, size in zip(files, sizes, strict=True):
        if size > FOLDER_BYTES:
            file.unlink(missing_ok=True)
