"""What is found out about an input that reads as valid: a unit, a pose, a clock that cannot be meant so."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Finding:
    """One thing that was found, in words for the one who brought the input.

    Args:
        kind: of thing, one or two words that stay the same from version to version: "unit", "sentinel", "pose".
        about: names of the cameras, links or files that it is about; none: all of the input.
        text: one line: what was found, in numbers, what it is most likely, what to do about it.
        stops: whether nothing may be judged by this input. Otherwise it is a warning, and judging goes on.
    """

    kind: str
    about: tuple[str, ...]
    text: str
    stops: bool
