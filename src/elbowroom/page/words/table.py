"""A table of words, asked by key."""

from collections.abc import Mapping
from dataclasses import dataclass

from elbowroom.errors import InputError
from elbowroom.page.words.controls_english import CONTROLS_ENGLISH
from elbowroom.page.words.controls_german import CONTROLS_GERMAN
from elbowroom.page.words.english import ENGLISH
from elbowroom.page.words.german import GERMAN
from elbowroom.page.words.plan_english import PLAN_ENGLISH
from elbowroom.page.words.plan_german import PLAN_GERMAN

LANGUAGES: dict[str, Mapping[str, str]] = {
    "en": {**ENGLISH, **CONTROLS_ENGLISH, **PLAN_ENGLISH},
    "de": {**GERMAN, **CONTROLS_GERMAN, **PLAN_GERMAN},
}
"""The tables, by the code of their language (ISO 639-1)."""


@dataclass(frozen=True, slots=True)
class Words:
    """The words of one language.

    Args:
        language: its code.
        table: phrases by key; what stands in braces is filled in.
    """

    language: str
    table: Mapping[str, str]

    def __call__(self, key: str, **values: object) -> str:
        """A phrase, filled in.

        Args:
            key: of the table.
            values: for what stands in braces.
        """
        return self.table[key].format(**values)

    def has(self, key: str) -> bool:
        """Whether there is such a phrase."""
        return key in self.table

    def number(self, value: float, digits: int) -> str:
        """A number as this language writes it.

        Args:
            value: the number.
            digits: how many after the point.
        """
        return f"{value:.{digits}f}".replace(".", self.table["decimal"])


def words_of(language: str) -> Words:
    """The words of a language.

    Args:
        language: its code.

    Raises:
        InputError: there is no such table.
    """
    if language not in LANGUAGES:
        raise InputError(f"language: {language!r} is not there; languages are {', '.join(LANGUAGES)}")
    return Words(language, LANGUAGES[language])
