"""Where the gate stands, for those who may reset and hold on."""

from typing import Any

from elbowroom.page.story.told import Told
from elbowroom.page.words import Words


def gate_said(told: Told, words: Words) -> dict[str, Any] | None:
    """Where the gate stands, in words; None: there is none.

    Args:
        told: the moment.
        words: of the language.
    """
    gate = told["gate"]
    if gate is None:
        return None
    held = [name for name, may in gate["motions"].items() if may["held"] and may["speed"] > 0]
    text = words("gate.now", phase=words(f"gate.{gate['phase']}"))
    return {"phase": gate["phase"], "text": text, "held": ", ".join(held)}
