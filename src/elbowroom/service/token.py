"""The token: a file that its owner alone can read."""

import os
import re
import secrets
import stat
from pathlib import Path

from elbowroom.errors import InputError

BYTES, MOST_BYTES = 32, 256
FORM = re.compile(r"[0-9A-Za-z_-]{32,200}")


def made_token(path: Path) -> str:
    """Makes a token and writes it to a new file that its owner alone can read.

    Args:
        path: of the file.

    Raises:
        InputError: there is one already, or it cannot be written.
    """
    token = secrets.token_hex(BYTES)
    try:
        file = os.open(path, os.O_WRONLY | os.O_CREAT | os.O_EXCL | os.O_NOFOLLOW, 0o600)
    except FileExistsError:
        raise InputError(f"{path}: is there already; remove it to make another token") from None
    except OSError as error:
        raise InputError(f"{path}: cannot be written ({error.strerror})") from None
    with os.fdopen(file, "w", encoding="ascii") as written:
        os.fchmod(written.fileno(), 0o600)
        written.write(token + "\n")
    return token


def read_token(path: Path) -> str:
    """The token of a file.

    Args:
        path: of the file.

    Raises:
        InputError: no such file, of somebody else, one that others can read or write, or no token in it.
    """
    try:
        file = os.open(path, os.O_RDONLY | os.O_NOFOLLOW | os.O_NONBLOCK)
    except FileNotFoundError:
        raise InputError(f"{path}: no such file; make one with: elbowroom gate token {path}") from None
    except OSError as error:
        raise InputError(f"{path}: cannot be read ({error.strerror})") from None
    try:
        _require_own(path, os.fstat(file))
        token = os.read(file, MOST_BYTES + 1).decode("ascii", "replace").strip()
    finally:
        os.close(file)
    if FORM.fullmatch(token) is None:
        raise InputError(f"{path}: holds no token; make one with: elbowroom gate token")
    return token


def _require_own(path: Path, status: os.stat_result) -> None:
    """Refuses what is no file of its owner alone."""
    if not stat.S_ISREG(status.st_mode):
        raise InputError(f"{path}: is no file")
    if status.st_uid != os.geteuid():
        raise InputError(
            f"{path}: belongs to somebody else; a token's file has to be of who runs the monitor"
        )
    if status.st_mode & 0o077:
        mode = stat.S_IMODE(status.st_mode)
        raise InputError(f"{path}: others can read or write it (mode {mode:03o}); run: chmod 600 {path}")
