"""Compiled kernels are kept beside their sources; this forgets them when any kernel has changed.

Numba compiles a kernel anew when its own file changes, but not when a kernel of another file that it calls does:
after an update of the sources the old code could run on (numba's documentation, "Caching", limitations).
"""

import hashlib
from contextlib import suppress
from pathlib import Path

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
        if note.is_file() and note.read_text() == digest.hexdigest():
            return False
        for source in sources:
            for kept in (source.parent / "__pycache__").glob(f"{source.stem}.*.nb[ic]"):
                kept.unlink(missing_ok=True)
        note.parent.mkdir(exist_ok=True)
        note.write_text(digest.hexdigest())
    return True
