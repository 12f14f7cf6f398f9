"""Numbers in attributes: so many, finite, written as XML writes them."""

import math
import re

from lxml import etree

from elbowroom.machine.description.report import Report

_NUMBER = re.compile(r"[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?$")
_NOT_FINITE = re.compile(r"[+-]?(nan|inf|infinity)$", re.IGNORECASE)
WORDS = {1: "one number", 2: "two numbers", 3: "three numbers", 4: "four numbers"}


def numbers(element: etree._Element, name: str, count: int, report: Report) -> tuple[float, ...]:
    """Numbers that an attribute must have.

    Args:
        element: that has the attribute.
        name: of the attribute.
        count: how many numbers it holds.
        report: names the place.

    Raises:
        MachineError: no such attribute, another count, a word that is no finite number.
    """
    text = element.get(name)
    if text is None:
        raise report.error(element, f"{name} is missing; it holds {WORDS[count]}")
    words = text.split()
    if len(words) == count and any(word.endswith(",") for word in words[:-1]):
        report.warn(
            "numbers", element, f"{name}: numbers are parted by blanks; commas after them are passed over"
        )
        words = [word.removesuffix(",") for word in words]
    for word in words:
        if not _NUMBER.match(word):
            raise report.error(element, f"{name}: {_wrong(word)}")
    if len(words) != count:
        raise report.error(element, f"{name} holds {len(words)} numbers; expected {WORDS[count]}")
    return tuple(float(word) for word in words)


def number(element: etree._Element, name: str, report: Report, otherwise: float | None = None) -> float:
    """One number; where the attribute is missing, another, if one is given. Infinite is a number here, NaN is none.

    Args:
        element: that has the attribute.
        name: of the attribute.
        report: names the place.
        otherwise: what holds where it is missing; None: it must be there.
    """
    text = (element.get(name) or "").strip()
    if not text and otherwise is not None:
        return otherwise
    if _NOT_FINITE.match(text) and not math.isnan(float(text)):
        return float(text)
    return numbers(element, name, 1, report)[0]


def _wrong(word: str) -> str:
    if "," in word:
        return f"{word!r} holds a comma; numbers are parted by blanks, their decimals by a dot"
    if _NOT_FINITE.match(word):
        return f"{word!r} is not finite"
    return f"{word!r} is no number"
