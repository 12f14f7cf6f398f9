"""Whether a recording opens wherever it is cut off, and whether one bit that is another is noticed."""

import random
from collections.abc import Iterator, Sequence
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from elbowroom.errors import BagError
from elbowroom.evaluate.due import Due
from elbowroom.evaluate.recording.sample import record_sample
from elbowroom.monitor.blackbox.recording import RecordedPass, Recording

DUE = (
    Due("not_opened", "≤", 0, words="files that do not open"),
    Due("most_lost", "≤", 1, words="passes lost by a cut"),
    Due("other", "≤", 0, words="passes that are not as they were"),
    Due("unnoticed", "≤", 0, words="changed bits that go unnoticed"),
)
"""Of 10,000 cuts and 10,000 bits."""
PASSES = 12


def cut_rows(many: int = 10_000, seed: int = 1) -> Iterator[dict[str, Any]]:
    """A row for each cut, evenly over the whole file, and one for each changed bit, at random.

    Args:
        many: how often, of each kind.
        seed: of what is recorded, and of the bits.
    """
    with TemporaryDirectory() as folder:
        file = record_sample(Path(folder) / "whole.mcap", PASSES, seed)
        content, chance = file.read_bytes(), random.Random(seed)
        with Recording(file) as whole:
            passes, ends = [_told(one) for one in whole.passes()], whole.ends
        broken = Path(folder) / "broken.mcap"
        for number in range(many):
            length = number * len(content) // many
            yield {"case": "cut off", "at": length, **cut(broken, content[:length], passes, ends)}
        for _ in range(many):
            bit = chance.randrange(8 * len(content))
            changed = bytearray(content)
            changed[bit // 8] ^= 1 << bit % 8
            yield {
                "case": "one bit changed",
                "at": bit // 8,
                "unnoticed": not is_noticed(broken, bytes(changed)),
            }


def cut(path: Path, content: bytes, passes: Sequence[Any], ends: Sequence[int]) -> dict[str, Any]:
    """What a file comes to that was cut off.

    Args:
        path: of the file, written here.
        content: of it.
        passes: of the whole file, as `_told` says them.
        ends: where each pass ends [bytes].

    Returns:
        Whether it opens, how many passes it has lost of those that had begun, how many are not as they were, and
        whether it says that it was cut.
    """
    path.write_bytes(content)
    begun = 1 + sum(end < len(content) for end in ends)
    try:
        with Recording(path) as recording:
            found = [_told(one) for one in recording.passes()]
            wrong, note = recording.wrong(), recording.note
    except BagError as error:
        return {"opens": False, "lost": min(begun, len(passes)), "other": 0, "said": str(error)}
    lost = min(begun, len(passes)) - len(found)
    other = sum(one != due for one, due in zip(found, passes, strict=False)) + (wrong is not None)
    return {"opens": True, "lost": lost, "other": other, "said": note}


def is_noticed(path: Path, content: bytes) -> bool:
    """Whether something is said of a file that is not as it was written.

    Args:
        path: of the file, written here.
        content: of it.
    """
    path.write_bytes(content)
    try:
        with Recording(path) as recording:
            return recording.wrong() is not None or recording.note is not None
    except BagError:
        return True


def cut_summary(rows: Sequence[dict[str, Any]]) -> list[dict[str, Any]]:
    """A row for each kind.

    Args:
        rows: of `cut_rows`.
    """
    cuts = [row for row in rows if row["case"] == "cut off"]
    bits = [row for row in rows if row["case"] != "cut off"]
    unsaid = sum(row["said"] is None for row in cuts)
    return [
        {
            "case": "cut off",
            "times": len(cuts),
            "not_opened": sum(not row["opens"] for row in cuts),
            "most_lost": max((row["lost"] for row in cuts), default=0),
            "other": sum(row["other"] for row in cuts),
            "unsaid": unsaid,
        },
        {"case": "one bit changed", "times": len(bits), "unnoticed": sum(row["unnoticed"] for row in bits)},
    ]


def _told(one: RecordedPass) -> tuple[Any, ...]:
    """All that a pass says."""
    frames = [(frame.camera, frame.stamp_ns, frame.depth_m.tobytes()) for frame in one.snapshot.frames]
    return one.sequence, frames, one.snapshot.joints, one.judged, one.gate
