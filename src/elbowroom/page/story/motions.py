"""The table of motions."""

from collections.abc import Mapping, Sequence
from typing import Any

from elbowroom.motion import Motion
from elbowroom.page.colours import MARKS
from elbowroom.page.story.phrases import in_short, level_of, name_of, travel
from elbowroom.page.story.told import Told
from elbowroom.page.words import Words


def motion_rows(told: Told, words: Words, looked_at: Mapping[str, float]) -> list[dict[str, Any]]:
    """A row a motion, in words.

    Args:
        told: the moment.
        words: of the language.
        looked_at: by name of the motion, how far it was looked [m or rad].
    """
    return [_row(row, words, looked_at) for row in told["judged"]["verdicts"]]


def looked_at_of(motions: Sequence[Motion]) -> dict[str, float]:
    """How far each motion is looked at, by its name [m or rad]."""
    return {motion.name: motion.looked_at for motion in motions}


def with_reach(row: Mapping[str, Any], looked_at: Mapping[str, float]) -> dict[str, Any]:
    """A verdict's row with how far it was looked.

    Args:
        row: of a verdict.
        looked_at: of `looked_at_of`.
    """
    return {**row, "looked_at": looked_at.get(name_of(row), 5 * row["braking_distance"])}


def _row(given: Mapping[str, Any], words: Words, looked_at: Mapping[str, float]) -> dict[str, Any]:
    row = with_reach(given, looked_at)
    level, unit = level_of(row), row["free_travel_unit"]
    far = travel(words, row["free_travel"], unit)
    if row["free_travel"] >= row["looked_at"] * (1 - 1e-9):
        far = words("free.at_least", travel=far)
    return {
        "name": name_of(row),
        "level": level.name.lower(),
        "mark": MARKS[level],
        "word": words(f"level.{level.name.lower()}"),
        "free": far,
        "share": min(1.0, row["free_travel"] / row["looked_at"]),
        "brakes": row["free_travel"] / row["braking_distance"],
        "speed": words("percent", value=f"{100 * row['safe_speed']:.0f}"),
        "cause": in_short(words, row),
    }
