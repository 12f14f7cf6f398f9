"""Compiled kernels are kept beside their sources; this forgets them when any kernel has changed.

Numba compiles a kernel anew when its own file changes, but not when a kernel of another file that it calls does:
after an update of the sources the old code could run on (numba's documentation, "Caching", limitations).
"""

import hashlib
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import IO

_PACKAGE = Path(__file__).parent


def forget_stale_kernels(package: Path = _PACKAGE) -> bool:
    """Removes what numba has kept of the package's kernels, if their sources are not those it was made of.

    Args:
        package: folder whose `kernels/*.py` are meant.

    Returns:
        Whether anything was stale. Where the folder cannot be written, numba keeps its files elsewhere, and nothing is
        done here.
    """
    sources = sorted(package.rglob("kernels/*.py"))
    digest = hashlib.sha256()
    for source in sources:
        digest.update(source.relative_to(package).as_posix().encode())
        digest.update(source.read_bytes())
    note = package / "__pycache__" / "kernels.sha256"
    with suppress(OSError):
        if _says(note, digest.hexdigest()):
            return False
    with suppress(OSError), only_one("forgets kernels", package):
        # while this process waited, another may have done it, and compiled some since
        if _says(note, digest.hexdigest()):
            return False
        for source in sources:
            for kept in (source.parent / "__pycache__").glob(f"{source.stem}.*.nb[ic]"):
                kept.unlink(missing_ok=True)
        note.parent.mkdir(exist_ok=True)
        note.write_text(digest.hexdigest())
    return True


@contextmanager
def only_one(what: str, package: Path = _PACKAGE) -> Iterator[None]:
    """Waits until no other process of this computer is within it; a process that ends lets the next one in.

    Args:
        what: it does; those that do something else do not wait for each other.
        package: folder beside whose compiled files the locks lie. Where it cannot be written, or files cannot be locked
            (Windows), nobody waits.
    """
    file = _lock_file(package / "__pycache__" / f"{what.replace(' ', '_')}.lock")
    if file is None:
        yield
        return
    with file:
        try:
            import fcntl
        except ImportError:
            yield
            return
        fcntl.flock(file, fcntl.LOCK_EX)
        # closing the file lets go of it
        yield


def _lock_file(path: Path) -> IO[str] | None:
    try:
        path.parent.mkdir(exist_ok=True)
        return path.open("a")
    except OSError:
        return None


def _says(note: Path, digest: str) -> bool:
    return note.is_file() and note.read_text() == digest
