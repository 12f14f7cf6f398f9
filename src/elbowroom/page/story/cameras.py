"""The table of cameras: how often, how old, how far apart, how much of the image, and whether it still stands there."""

from collections import deque
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from elbowroom.page.story.told import Told
from elbowroom.page.words import Words

OVER_S = 2.0
"""Rates are those of so long [s]."""
WELL = ("still", "unsure")
"""Conditions that are no worry."""


@dataclass(slots=True, eq=False)
class Rates:
    """How many images a second each camera gives; told of moments in their order.

    Args:
        over_s: over how long [s].
    """

    over_s: float = OVER_S
    _stamps: dict[str, deque[int]] = field(default_factory=dict, init=False)

    def hear(self, told: Told) -> None:
        """Notes the images of a moment."""
        for camera, stamp_ns in told["stamps"].items():
            if stamp_ns is None:
                continue
            kept = self._stamps.setdefault(camera, deque(maxlen=1000))
            if kept and stamp_ns < kept[-1]:
                kept.clear()
            if not kept or stamp_ns > kept[-1]:
                kept.append(stamp_ns)
            while stamp_ns - kept[0] > 1e9 * self.over_s:
                kept.popleft()

    def of(self, camera: str) -> float | None:
        """Images a second; None: fewer than two came."""
        kept = self._stamps.get(camera)
        if kept is None or len(kept) < 2 or kept[-1] == kept[0]:
            return None
        return 1e9 * (len(kept) - 1) / (kept[-1] - kept[0])


def camera_rows(told: Told, words: Words, names: Sequence[str], rates: Rates) -> list[dict[str, Any]]:
    """A row a camera, in words.

    Args:
        told: the moment.
        words: of the language.
        names: of all cameras of the room.
        rates: that heard it.
    """
    stamps = {name: stamp for name, stamp in told["stamps"].items() if stamp is not None}
    newest = max(stamps.values(), default=0)
    return [_row(told, words, name, rates.of(name), newest) for name in names]


def _row(told: Told, words: Words, name: str, rate_hz: float | None, newest_ns: int) -> dict[str, Any]:
    stamp_ns, now_ns = told["stamps"].get(name), told["now_ns"]
    unknown = words("unknown")
    age = skew = unknown
    if stamp_ns is not None and now_ns is not None:
        took_ms = sum(told["judged"]["stage_ms"].values())
        age_ms = (now_ns - stamp_ns + told["bounds"].get(name, 0)) / 1e6 + took_ms
        age = words("milliseconds", value=f"{age_ms:.0f}")
    if stamp_ns is not None:
        skew = words("milliseconds", value=f"{(newest_ns - stamp_ns) / 1e6:.0f}")
    valid = told["valid"].get(name)
    is_well, state = _state(told, words, name)
    return {
        "name": name,
        "is_well": is_well,
        "state": state,
        "rate": unknown if rate_hz is None else words("per_second", value=words.number(rate_hz, 1)),
        "age": age,
        "skew": skew,
        "valid": unknown if valid is None else words("percent", value=f"{100 * valid:.0f}"),
        "drift": _drift(told, words, name),
    }


def _state(told: Told, words: Words, name: str) -> tuple[bool, str]:
    """Whether a camera is well, and what is wrong with it."""
    sick = [each["text"] for each in told["judged"]["sick"] if each["source"] == name]
    if sick:
        return False, words("camera.left_out", text="; ".join(sick))
    if name not in told["stamps"]:
        return False, words("camera.no_frame")
    condition = _health(told, name).get("condition")
    if condition is None:
        return True, words("camera.well")
    return condition in WELL, words(f"camera.{condition}")


def _drift(told: Told, words: Words, name: str) -> str:
    health = _health(told, name)
    turn, move = health.get("turn_deg"), health.get("move_mm")
    if turn is None or move is None:
        return words("unknown")
    return words("drift", turn=words.number(float(turn), 2), move=f"{float(move):.0f}")


def _health(told: Told, name: str) -> Mapping[str, Any]:
    return (told["health"] or {}).get(name, {})
