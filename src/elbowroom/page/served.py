"""The files of the page, as they are served: its frame in the page's language, its style and its program."""

import html
from importlib import resources

from elbowroom.motion import Level
from elbowroom.page import colours
from elbowroom.page.server import Answer
from elbowroom.page.words import Words

PROGRAM = ("plot.js", "panel.js", "slider.js", "controls.js", "live.js")
"""Files of the page's program, in the order in which they are read."""


def file_of_page(name: str) -> str:
    """The text of a file in `browser/`.

    Args:
        name: of the file.
    """
    return resources.files("elbowroom.page").joinpath("browser", name).read_text(encoding="utf-8")


def answers_of(words: Words, site: str) -> dict[str, Answer]:
    """By path, what is served.

    Args:
        words: of the language.
        site: its name.
    """
    program = "\n".join(file_of_page(name) for name in PROGRAM)
    return {
        "/": Answer("text/html; charset=utf-8", frame_of(words, site).encode()),
        "/page.css": Answer("text/css; charset=utf-8", style().encode()),
        "/page.js": Answer("text/javascript; charset=utf-8", program.encode()),
    }


def frame_of(words: Words, site: str) -> str:
    """The page without its values.

    Args:
        words: of the language.
        site: its name.
    """
    text = file_of_page("page.html").replace("{{controls}}", file_of_page("controls.html"))
    return filled(text, words, title=words("title", site=site))


def filled(text: str, words: Words, **values: str) -> str:
    """A frame with its words; `{{key}}` stands for a word of the table or a value.

    Args:
        text: of the frame.
        words: of the language.
        values: what else stands in braces.
    """
    for key, value in {**words.table, **values, "language": words.language}.items():
        text = text.replace("{{" + key + "}}", html.escape(value))
    return text


def style() -> str:
    """The style sheet, with the colours of levels."""
    names = {f"--{level.name.lower()}": colours.css(colours.LEVELS[level]) for level in Level}
    known = "; ".join(f"{name}: {value}" for name, value in names.items())
    return f":root {{ {known}; }}\n" + file_of_page("page.css")
