"""A verdict explained: a sentence of what is there, and sentences of what would change it."""

from collections.abc import Iterable, Mapping, Sequence
from typing import Any

from elbowroom.monitor.why.changes import Change
from elbowroom.page.story.phrases import EVERYTHING, length, name_of, says, travel
from elbowroom.page.story.told import Told
from elbowroom.page.words import Words

LENGTHS = ("distance", "margin")
"""Values of a change that are lengths in words; others are numbers of metres."""


def why_text(
    told: Told, row: Mapping[str, Any], words: Words, changes: Sequence[Change] | None = None
) -> dict[str, Any]:
    """What ends a motion, and what would change it.

    Args:
        told: the moment.
        row: of the motion's verdict, with its reach (`motions.with_reach`).
        words: of the language.
        changes: what the cameras say; None: they were not asked, and what the verdict itself says is said.

    Returns:
        Of keys motion, sentence and changes.
    """
    said = {"motion": name_of(row), "place": row["place_m"], "is_asked": changes is not None}
    if row["cause"] in EVERYTHING or told["judged"]["stopped_by"] is not None:
        return {**said, "sentence": _of_all(told, row, words), "changes": _clearing(told, row, words)}
    if row["cause"] == "none":
        return {**said, "sentence": says(words, row) + ".", "changes": []}
    sentence = f"{says(words, row)}."
    if row["place_m"] is not None:
        x, y, z = (words.number(float(value), 2) for value in row["place_m"])
        sentence = f"{sentence[:-1]}, {words('why.where', x=x, y=y, z=z)}."
    given = list(changes) if changes is not None else list(_without_images(row))
    return {**said, "sentence": sentence, "changes": [change_text(one, words) for one in given]}


def change_text(change: Change, words: Words) -> str:
    """A change as a sentence.

    Args:
        change: of `monitor.why.changes`.
        words: of the language.
    """
    given = dict(change.values)
    unit = str(given.pop("unit", "m"))
    if change.kind == "override":
        given = {key: travel(words, float(value), unit) for key, value in given.items()}
    said: dict[str, object] = {}
    for key, value in given.items():
        if key == "side":
            said[key] = words(f"side.{value}")
        elif key == "shift_m":
            said["shift"] = f"{100 * float(value):.0f}"
        elif key == "share":
            said[key] = f"{100 * float(value):.0f}"
        elif key.endswith("_m"):
            said[key[:-2]] = _metres(change.kind, key[:-2], float(value), words)
        else:
            said[key] = value
    return words(f"change.{change.kind}", **said)


def _metres(kind: str, key: str, value: float, words: Words) -> str:
    if kind in ("something", "margin") and key in LENGTHS:
        return length(words, value)
    return words.number(value, 1)


def _of_all(told: Told, row: Mapping[str, Any], words: Words) -> str:
    from elbowroom.page.story.headline import headline

    if told["judged"]["stopped_by"] is not None:
        said = headline(told, words)
        return words("reported", cause=said.sentence, text=said.detail)
    return says(words, row) + "."


def _clearing(told: Told, row: Mapping[str, Any], words: Words) -> list[str]:
    """What ends a stop of everything."""
    judged = told["judged"]
    found = [words("change.clears", clears=each["clears"]) for each in judged["sick"]]
    if judged["fault"] is not None or row["cause"] == "fault":
        found.append(words("change.fault"))
    elif judged["late"] is not None:
        found.append(words("change.stale"))
    elif row["cause"] in ("watch", "off_path"):
        found.append(words(f"change.{row['cause']}"))
    elif not found:
        found.append(words("change.input"))
    return found


def _without_images(row: Mapping[str, Any]) -> Iterable[Change]:
    """What a verdict says by itself of what would change it."""
    link, cause = row["link"] or "?", row["cause"]
    if cause == "outside_grid":
        yield Change("box", {"link": link})
    elif cause == "machine":
        yield Change("back")
        yield Change("touch", {"link": link, "other": row["other_link"] or "?"})
    elif cause == "kept_out":
        yield Change("zone", {"zone": row["zone"] or "?"})
    elif cause == "surface":
        yield Change("is_there")
    else:
        yield Change("other_side")
    creep = row.get("creep")
    if not row["overridable"]:
        yield Change("no_override")
    elif creep is not None and creep["travel"] > 0:
        unit = row["free_travel_unit"]
        yield Change("override", {"travel": creep["travel"], "speed": creep["speed"], "unit": unit})
    elif creep is not None:
        yield Change("no_creep")
