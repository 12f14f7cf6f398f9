"""Tables of words: alike in keys and in what they leave to be filled in; each phrase is used."""

import re
from importlib import resources
from pathlib import Path

import pytest

from elbowroom.errors import InputError
from elbowroom.monitor.health.health import Condition
from elbowroom.motion import Level
from elbowroom.page.words import LANGUAGES, words_of

PAGE = Path(str(resources.files("elbowroom.page")))
ENGLISH = LANGUAGES["en"]


@pytest.mark.parametrize("language", LANGUAGES)
def test_a_table_has_the_keys_and_gaps_of_the_first(language):
    table = LANGUAGES[language]
    assert list(table) == list(ENGLISH)
    for key, phrase in table.items():
        assert phrase and sorted(re.findall(r"\{(\w+)\}", phrase)) == sorted(
            re.findall(r"\{(\w+)\}", ENGLISH[key])
        ), key


def test_an_unknown_language_is_refused_with_those_that_there_are():
    with pytest.raises(InputError, match="languages are en, de"):
        words_of("xx")


def test_each_phrase_is_used_somewhere():
    text = "\n".join(
        path.read_text(encoding="utf-8")
        for path in PAGE.rglob("*")
        if path.suffix in (".py", ".js", ".html") and "words" not in path.parts
    )
    for key in ENGLISH:
        parts = key.split(".")
        heads = [".".join(parts[:n]) for n in range(1, len(parts))]
        made = [piece for head in heads for piece in (f'f"{head}.{{', f"f'{head}.{{", f'"{head}." +')]
        made += ["{kind}."] if parts[0] in ("cause", "short") else []
        asked = (f'"{key}"', f"'{key}'", f"{{{{{key}}}}}")
        assert any(piece in text for piece in (*asked, *made)), key


def test_levels_and_conditions_have_words():
    for level in Level:
        assert {f"level.{level.name.lower()}", f"verb.{level.name.lower()}"} <= set(ENGLISH)
    assert {f"camera.{condition.name.lower()}" for condition in Condition} <= set(ENGLISH)


def test_numbers_are_written_as_the_language_does():
    assert words_of("en").number(6.25, 1) == "6.2" and words_of("de").number(0.51, 1) == "0,5"
