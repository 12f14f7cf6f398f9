"""What a browser is told first: all words, colours and names that do not change."""

from typing import Any

from elbowroom.monitor.blackbox.configuration import Configuration
from elbowroom.motion import Level
from elbowroom.page import colours
from elbowroom.page.scene.near import NEAR_M
from elbowroom.page.words import Words


def hello_of(configuration: Configuration, words: Words, mode: str) -> dict[str, Any]:
    """What a browser is told first.

    Args:
        configuration: of the run.
        words: of the language.
        mode: "live", "replay" or "report".
    """
    return {
        "type": "hello",
        "mode": mode,
        "words": dict(words.table),
        "site": str(configuration.told.get("site")),
        "motions": [motion.name for motion in configuration.motions],
        "cameras": [camera.name for camera in configuration.cameras],
        "legend": legend_of(words),
        "near": words("legend.near", distance=words.number(NEAR_M, 1)),
    }


def legend_of(words: Words) -> list[dict[str, str]]:
    """Colours and what they mean.

    Args:
        words: of the language.
    """
    known = {
        "surface": colours.SURFACE,
        "unseen": colours.UNSEEN,
        "blind": colours.BLIND,
        "contact": colours.CONTACT,
        **{f"way.{level.name.lower()}": colours.LEVELS[level] for level in Level},
        "camera.well": colours.CAMERA_WELL,
        "camera.ill": colours.CAMERA_ILL,
    }
    return [
        {"colour": colours.css(colour), "text": words(f"legend.{name}")} for name, colour in known.items()
    ]
