"""Verdicts as phrases: what a link meets, after how much travel, in the words of a table."""

from collections.abc import Mapping
from typing import Any

from elbowroom.motion import Level
from elbowroom.page.words import Words
from elbowroom.view.screen.words import travel_text

EVERYTHING = ("fault", "stale", "input", "watch")
"""Causes that lie nowhere in the space: all stops."""


def level_of(row: Mapping[str, Any]) -> Level:
    """The level of a row."""
    return Level[str(row["level"]).upper()]


def name_of(row: Mapping[str, Any]) -> str:
    """The name of the motion of a verdict's row."""
    return f"{row['joint']} {row['direction'] or ''}".strip()


def travel(words: Words, value: float, unit: str) -> str:
    """A distance along a joint; rounded down.

    Args:
        words: of the language.
        value: the distance [unit].
        unit: "m" or "rad".
    """
    return travel_text(float(value), unit).replace(".", words("decimal"))


def length(words: Words, metres: float) -> str:
    """A length.

    Args:
        words: of the language.
        metres: how long [m].
    """
    return f"{1e3 * metres:.0f} mm" if metres < 1 else f"{words.number(metres, 2)} m"


def meets(words: Words, row: Mapping[str, Any]) -> str:
    """What ends a motion, as a clause: "detector meets space that nobody sees".

    Args:
        words: of the language.
        row: of a verdict.
    """
    return _filled(words, row, "cause")


def in_short(words: Words, row: Mapping[str, Any]) -> str:
    """What ends a motion, for a table: "detector: nobody sees it".

    Args:
        words: of the language.
        row: of a verdict.
    """
    return _filled(words, row, "short")


def _filled(words: Words, row: Mapping[str, Any], kind: str) -> str:
    values = {
        "link": row["link"] or "?",
        "other": row.get("other_link") or "?",
        "zone": row.get("zone") or "?",
    }
    text = words(f"{kind}.{'limit' if _is_limit(row) else row['cause']}", **values)
    is_way_out = row.get("escapes") and row["cause"] != "none"
    return words(f"{kind}.escapes", cause=text) if is_way_out else text


def says(words: Words, row: Mapping[str, Any]) -> str:
    """A verdict as a sentence without its full stop: "larm + stops: after 6.2° detector meets ...".

    Args:
        words: of the language.
        row: of a verdict.
    """
    level, name = level_of(row).name.lower(), name_of(row)
    far = travel(words, row["free_travel"], row["free_travel_unit"])
    if row["cause"] in EVERYTHING:
        return words("headline.all", cause=words(f"cause.{row['cause']}"))
    if level == "stop" and not row["free_travel"] > 0:
        verb = words("verb.at_once", motion=name)
    elif level == "clear":
        ended = row["cause"] != "none" or _is_limit(row)
        verb = words("verb.clear_far" if ended else "verb.clear", motion=name, travel=far)
    else:
        verb = words(f"verb.{level}", motion=name, travel=far)
    return words("headline", verb=verb, cause=meets(words, row))


def _is_limit(row: Mapping[str, Any]) -> bool:
    """Whether the joint ends before what was looked at does."""
    looked = row.get("looked_at", 5 * row["braking_distance"])
    return bool(row["cause"] == "none" and row["free_travel"] < looked * (1 - 1e-9))
