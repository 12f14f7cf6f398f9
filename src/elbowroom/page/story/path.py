"""The path that the machine was asked to take, in a sentence."""

from typing import Any

from elbowroom.page.story.phrases import meets
from elbowroom.page.story.requested import end_of_path, level_of_path
from elbowroom.page.story.told import Told
from elbowroom.page.words import Words


def path_said(told: Told, words: Words) -> dict[str, Any] | None:
    """How far the machine may follow its path, and what ends that; None: none was asked for, or it is over.

    Args:
        told: the moment.
        words: of the language.
    """
    level = level_of_path(told)
    if level is None:
        return None
    name = level.name.lower()
    return {"level": name, "text": _sentence(told, words)}


def _sentence(told: Told, words: Words) -> str:
    off_path = told["judged"].get("off_path")
    if off_path is not None:
        return words("path.off", text=off_path)
    row, end = told["judged"]["path"], end_of_path(told)
    if end is None:
        ahead_s = max(row["looked_until_s"] - row["begin_s"], 0.0)
        return words("path.free", seconds=words.number(ahead_s, 1))
    cause = meets(words, {**end, "escapes": False, "free_travel": 0.0, "braking_distance": 1.0})
    if row["follow_until_s"] is None:
        return words("path.stop", cause=cause)
    left_s = max(row["follow_until_s"] - row["begin_s"], 0.0)
    return words("path.follow", seconds=words.number(left_s, 1), cause=cause)
