"""How often a latch is kept: through kills at random moments, files cut off at any byte, changed, or older."""

import json
import random
import subprocess
import sys
from collections.abc import Iterator, Sequence
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from elbowroom.errors import ElbowroomError
from elbowroom.evaluate.due import Due
from elbowroom.evaluate.latch.writer import SITE
from elbowroom.guard.fault import Fault
from elbowroom.guard.latch import NAME, Mark, latch_bytes, read_latch
from elbowroom.guard.latch_file import LatchFile
from elbowroom.guard.reason import Reason

DUE = (Due("lost", "≤", 0, words="latches lost"), Due("unnamed", "≤", 0, words="causes not named"))
"""Of 10,000 in each kind."""
FAULTS = tuple(
    Fault(reason, subject, f"{subject or 'something'}: {reason.sentence}")
    for reason in Reason
    if reason.is_fault
    for subject in ("", "cam01", "ceiling camera über der Tür")
)
SECOND_NS = 1_000_000_000


def latch_rows(many: int = 10_000, seed: int = 1) -> Iterator[dict[str, Any]]:
    """One row for each time: kills, then cut files, changed ones, and older ones of a run.

    Args:
        many: how often, of each kind.
        seed: of all that is random.

    Raises:
        ElbowroomError: the process that kills came to an end before its time.
    """
    with TemporaryDirectory() as folder:
        yield from _kills(Path(folder), many, seed)
    with TemporaryDirectory() as folder:
        yield from _files(Path(folder) / NAME, many, random.Random(seed))
    with TemporaryDirectory() as folder:
        yield from _older(Path(folder), many, random.Random(seed))


def _kills(folder: Path, many: int, seed: int) -> Iterator[dict[str, Any]]:
    words = [sys.executable, "-m", "elbowroom.evaluate.latch.killing", str(folder), str(many), str(seed)]
    with subprocess.Popen(words, stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout is not None
        for line in process.stdout:
            yield {"case": "killed", **json.loads(line)}
    if process.returncode != 0:
        raise ElbowroomError(f"evaluate latch: the process that kills ended with {process.returncode}")


def _files(path: Path, many: int, chance: random.Random) -> Iterator[dict[str, Any]]:
    """Files cut off at every byte in turn, and files of which one bit is another."""
    cuts = _every_cut(chance)
    for _ in range(many):
        yield {"case": "cut off", **_read(path, next(cuts))}
    for _ in range(many):
        content = bytearray(_some_latch(chance))
        content[chance.randrange(len(content))] ^= 1 << chance.randrange(8)
        yield {"case": "one bit changed", **_read(path, bytes(content))}


def _every_cut(chance: random.Random) -> Iterator[bytes]:
    """Each latch cut off at each byte, one latch after the other."""
    while True:
        content = _some_latch(chance)
        yield from (content[:length] for length in range(len(content)))


def _some_latch(chance: random.Random) -> bytes:
    """Each mark as often as the others: also the one that would read as unlatched, were it whole."""
    mark = chance.choice(list(Mark))
    faults = chance.sample(FAULTS, chance.randint(1, 4)) if mark is Mark.LATCHED else ()
    return latch_bytes(SITE, mark, faults)


def _read(path: Path, content: bytes) -> dict[str, Any]:
    path.write_bytes(content)
    return {"kept": bool(read_latch(path, SITE).faults), "named": True}


def _older(folder: Path, many: int, chance: random.Random) -> Iterator[dict[str, Any]]:
    """Each file that a run of faults and resets leaves on the way, as if all later ones had been lost."""
    path = folder / NAME
    path.write_bytes(latch_bytes(SITE, Mark.ENDED))
    file, latched = LatchFile(folder, SITE), tuple[Fault, ...]()
    file.begin()
    for number in range(many):
        file.keep(latched, number * SECOND_NS)
        older = read_latch(path, SITE).faults
        yield {"case": "older", "kept": bool(older), "named": set(latched) <= set(older)}
        latched = () if latched and chance.random() < 0.5 else (*latched, chance.choice(FAULTS))


def latch_summary(rows: Sequence[dict[str, Any]]) -> list[dict[str, Any]]:
    """A row for each kind: how often, and how often the latch was lost, or a cause not named.

    Args:
        rows: of `latch_rows`.
    """
    summary = []
    for case in dict.fromkeys(row["case"] for row in rows):
        of = [row for row in rows if row["case"] == case]
        summary.append(
            {
                "case": case,
                "times": len(of),
                "kept": sum(row["kept"] for row in of),
                "lost": sum(not row["kept"] for row in of),
                "unnamed": sum(not row["named"] for row in of),
                "after_latching": sum(row["lines"] > 0 for row in of) if case == "killed" else None,
                "inside_a_write": sum(row["inside_a_write"] for row in of) if case == "killed" else None,
                "unlatched": sum(row["unlatched"] for row in of) if case == "killed" else None,
            }
        )
    return summary


def wrong_rows(rows: Sequence[dict[str, Any]]) -> list[dict[str, Any]]:
    """Those that show a latch lost, or a cause not named.

    Args:
        rows: of `latch_rows`.
    """
    return [{**row, "case": f"{row['case']}, wrong"} for row in rows if not (row["kept"] and row["named"])]
