"""Commands as pages show them: in blocks, word by word, and whether the program takes what is typed."""

import re
import shlex
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import typer

from elbowroom.cli.app import app

STARTS = ("elbowroom ", ".venv/bin/", "python", ".ci/", "pip ", "git ")
"""How a line of a block begins that somebody types."""


def block_commands(page: Path) -> list[str]:
    """The commands of all blocks of a page that somebody types, in their order, without what is said beside them."""
    lines = re.findall(r"^    (\S.*)$", page.read_text(encoding="utf-8"), re.MULTILINE)
    pieces = [piece for line in lines if line.startswith(STARTS) for piece in line.split(" && ")]
    return [shlex.join(typed(piece)) for piece in pieces]


def typed(line: str) -> list[str]:
    """The words of a line, without its comment and without the folder of an environment."""
    return shlex.split(line.removeprefix(".venv/bin/"), comments=True)


def inline_commands(page: Path) -> list[str]:
    """The commands that stand amid the text of a page, with what has to be typed for their variables."""
    text = " ".join(page.read_text(encoding="utf-8").split())
    return re.findall(r"`(elbowroom [^`]+)`", text)


def parse(words: Sequence[str], whole: bool = True) -> None:
    """Asks the program whether it takes these words, without running anything.

    Args:
        words: after the program's name.
        whole: False: what is required may be left out, as where a page only names a command or an option.

    Raises:
        Exception: of click's own: a command, an argument or an option that is not known, or a value not allowed.
    """
    command: Any = typer.main.get_command(app)
    rest = list(words)
    if not whole and rest[0].isupper():
        return
    while hasattr(command, "commands") and rest and not rest[0].startswith("-"):
        command = command.commands[rest.pop(0)]
    if hasattr(command, "commands"):
        return
    try:
        command.make_context(command.name, rest)
    except Exception as error:
        if whole or type(error).__name__ not in ("MissingParameter", "BadOptionUsage"):
            raise
