"""The one sentence that is read from three metres away."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from elbowroom.motion import Level
from elbowroom.page.story.phrases import EVERYTHING, level_of, meets, says
from elbowroom.page.story.told import Told
from elbowroom.page.words import Words


@dataclass(frozen=True, slots=True)
class Headline:
    """What a moment comes to.

    Args:
        level: of all motions; None: no motion is judged.
        sentence: why.
        detail: what was reported besides, as it was; empty: nothing.
        motion: number of the motion that it is about; None: all.
    """

    level: Level | None
    sentence: str
    motion: int | None = None
    detail: str = ""


def headline(told: Told, words: Words) -> Headline:
    """What a moment comes to, in a sentence.

    Args:
        told: the moment.
        words: of the language.
    """
    rows: Sequence[Mapping[str, Any]] = told["judged"]["verdicts"]
    stopped_by = told["judged"]["stopped_by"]
    if stopped_by is not None:
        text = words("headline.all", cause=_cause_of_all(told, words))
        return Headline(Level.STOP, _ended(text), detail=_ended(stopped_by))
    held = _held(told, words)
    if held is not None:
        return held
    if not rows:
        return _without_motions(told, words)
    worst = min(range(len(rows)), key=lambda number: urgency(rows[number]))
    level = level_of(rows[worst])
    stopping = told["judged"].get("stopping")
    first = None if stopping is None else stopping.get("stop_blocked") or stopping.get("blocked")
    if level is Level.STOP and first is not None:
        row = {**first, "escapes": False, "free_travel": 0.0, "braking_distance": 1.0}
        return Headline(level, _ended(words("headline.stopping", cause=meets(words, row))), worst)
    if level is Level.CLEAR:
        return Headline(level, words("headline.free"))
    return Headline(level, _ended(says(words, rows[worst])), worst)


def urgency(row: Mapping[str, Any]) -> tuple[int, bool, float]:
    """Of two rows the one with the lesser is said first; as `motion.most_cautious`.

    Args:
        row: of a verdict.
    """
    left = row["free_travel"] / max(row["braking_distance"], 1e-12)
    return level_of(row).rank, bool(row["overridable"]), left


def _ended(text: str) -> str:
    """With a full stop."""
    return text if text.endswith((".", "!", "?")) else f"{text}."


def _cause_of_all(told: Told, words: Words) -> str:
    """Why everything stops, in the page's words."""
    judged = told["judged"]
    if judged["fault"] is not None:
        return words("cause.fault")
    if judged["late"] is not None:
        return words("cause.stale")
    if any(each["stops"] for each in (*judged["sick"], *judged["findings"])):
        return words("cause.input")
    causes = {row["cause"] for row in judged["verdicts"]}
    for cause in EVERYTHING:
        if cause in causes:
            return words(f"cause.{cause}")
    return words("cause.no_camera")


def _held(told: Told, words: Words) -> Headline | None:
    """What a gate holds; None: there is none, or it holds nothing back that verdicts do not."""
    gate = told["gate"]
    if gate is None:
        return None
    faults = [fault["text"] for fault in (*gate.get("latched", ()), *gate.get("active", ()))]
    if not faults and gate["phase"] == "guarding":
        return None
    faults = faults or [gate["sentence"]]
    return Headline(Level.STOP, _ended(words("headline.gate", text="; ".join(dict.fromkeys(faults)))))


def _without_motions(told: Told, words: Words) -> Headline:
    shares = told["shares"]
    if shares is None:
        return Headline(None, words("headline.none", text=words("unknown")))
    text = words(
        "shares", **{name: words.number(shares[f"{name}_pct"], 1) for name in ("free", "surface", "unseen")}
    )
    return Headline(None, _ended(words("headline.none", text=text)))
