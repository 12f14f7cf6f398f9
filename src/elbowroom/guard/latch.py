"""The latch on disk: one file that says *not latched* only where a run has ended as it was asked to.

While a run goes on, the file says so, and is read as latched: so nothing has to be written in time. Cut off at any
byte, changed, lost, one write older, of another site or of a later version: latched.

    {"elbowroom latch": 1, "site": "...", "mark": "latched", "faults": [{"reason": "WATCH", ...}]}
    sha256 of the line above, in hexadecimal
"""

import hashlib
import json
import os
import stat
from collections.abc import Sequence
from dataclasses import dataclass
from enum import Enum
from pathlib import Path
from typing import Any

from elbowroom.errors import InputError
from elbowroom.files.durable import write_durably
from elbowroom.guard.fault import Fault
from elbowroom.guard.reason import Reason

VERSION = 1
MAX_BYTES = 1_000_000
NAME = "latch"
"""Of the file, in the folder of the gate."""


class Mark(Enum):
    """What a latch says of its run."""

    RUNNING = "running"
    LATCHED = "latched"
    ENDED = "ended"


@dataclass(frozen=True, slots=True)
class Kept:
    """What was read.

    Args:
        faults: what is latched; empty alone where the last run has ended as it was asked to, with nothing latched.
        is_ours: whether the file may be replaced: not one of another site, of a later version, or that cannot be read.
    """

    faults: tuple[Fault, ...]
    is_ours: bool = True


def latch_bytes(site: str, mark: Mark, faults: Sequence[Fault] = ()) -> bytes:
    """A whole latch, as it lies on disk.

    Args:
        site: what it is a latch of.
        mark: what it says of its run.
        faults: what is latched; some, if and only if the mark is LATCHED.

    Raises:
        InputError: a mark that does not go with the faults.
    """
    if bool(faults) != (mark is Mark.LATCHED):
        raise InputError(f"latch: {len(faults)} faults do not go with {mark.value}")
    told = {
        "elbowroom latch": VERSION,
        "site": site,
        "mark": mark.value,
        "faults": [
            {"reason": fault.reason.name, "subject": fault.subject, "text": fault.text} for fault in faults
        ],
    }
    line = json.dumps(told).encode()
    return line + b"\n" + hashlib.sha256(line).hexdigest().encode() + b"\n"


def write_latch(path: Path, site: str, mark: Mark, faults: Sequence[Fault] = ()) -> None:
    """Writes a latch to disk, as `latch_bytes`.

    Args:
        path: of the file.
        site: what it is a latch of.
        mark: what it says of its run.
        faults: what is latched.

    Raises:
        OSError: it could not be written; what was there still is, and is latched or was so all along.
        InputError: as `latch_bytes`.
    """
    write_durably(path, latch_bytes(site, mark, faults))


def read_latch(path: Path, site: str) -> Kept:
    """What a file keeps; whatever is wrong with it is latched. It does not raise.

    Args:
        path: of the file.
        site: what it should be a latch of.
    """
    try:
        content = _content(path)
    except FileNotFoundError:
        return Kept((_fault(f"{path}: there is no latch yet, so nobody has reset it"),))
    except OSError as error:
        return Kept((_fault(f"{path}: cannot be read ({error.strerror or error})"),), False)
    try:
        told = _told(content)
        version, of = told["elbowroom latch"], told["site"]
        if version != VERSION:
            return Kept((_fault(f"{path}: is of version {version}, this program knows {VERSION}"),), False)
        if of != site:
            text = f"{path}: is the latch of {of}, not of {site}; give each site a folder of its own"
            return Kept((_fault(text),), False)
        return Kept(_faults(Mark(told["mark"]), told["faults"]))
    except (ValueError, KeyError, TypeError, AttributeError, RecursionError):
        return Kept((_fault(f"{path}: is damaged, and so taken for latched"),))


def _content(path: Path) -> bytes:
    """The first bytes of a plain file. What is none, such as a pipe that nobody writes to, is not waited for.

    Raises:
        OSError: it cannot be read, or is no plain file.
    """
    file = os.open(path, os.O_RDONLY | os.O_NONBLOCK)
    with os.fdopen(file, "rb") as opened:
        if not stat.S_ISREG(os.fstat(file).st_mode):
            raise OSError("is no plain file; take it away")
        return opened.read(MAX_BYTES + 1)


def _told(content: bytes) -> dict[str, Any]:
    """What a whole file says.

    Raises:
        ValueError, KeyError, TypeError: it is not whole.
    """
    line, digest, rest = content.split(b"\n")
    if rest or digest.decode("ascii") != hashlib.sha256(line).hexdigest():
        raise ValueError("not whole")
    told = json.loads(line)
    if not isinstance(told, dict):
        raise ValueError("no mapping")
    return told


def _faults(mark: Mark, rows: Sequence[dict[str, str]]) -> tuple[Fault, ...]:
    """What a mark and its faults come to."""
    faults = tuple(Fault(Reason[row["reason"]], row["subject"], row["text"]) for row in rows)
    if bool(faults) != (mark is Mark.LATCHED):
        raise ValueError("mark and faults differ")
    if mark is Mark.RUNNING:
        return (Fault(Reason.UNCLEAN_END),)
    return faults


def _fault(text: str) -> Fault:
    return Fault(Reason.LATCH_FILE, "", text)
