"""Verdicts beside the truth in the thesis' letters: s safe, ts too safe, tts much too safe, u unsafe."""

from collections.abc import Sequence

BANDS = "SML0"
"""Within S, M or L, or no collision, in order of caution."""


def compared(band: str, truth: str) -> str:
    """The thesis' verdict (5.1.2) by its definition.

    Args:
        band: ours.
        truth: of exact geometry.

    Returns:
        "s" the same band; "ts" too safe by one band or two; "tts" by three; "u" less safe than the truth.
    """
    steps = BANDS.index(truth) - BANDS.index(band)
    if steps < 0:
        return "u"
    return "s" if steps == 0 else "tts" if steps == 3 else "ts"


def counted(verdicts: Sequence[str]) -> dict[str, int]:
    """How many of each."""
    return {verdict: list(verdicts).count(verdict) for verdict in ("s", "ts", "tts", "u")}
