"""What `--help` says of every command is whole."""

import re

import pytest
import typer

from elbowroom.cli.app import app


def commands(command, words):
    yield words, command
    for name, below in getattr(command, "commands", {}).items():
        yield from commands(below, f"{words} {name}")


EVERY = dict(commands(typer.main.get_command(app), "elbowroom"))


@pytest.mark.parametrize("words", EVERY)
def test_nothing_in_square_brackets_is_taken_for_markup_and_lost(words):
    command = EVERY[words]
    for text in (command.help, command.epilog, *(getattr(p, "help", None) for p in command.params)):
        assert not re.search(r"\[[^\]]*\]", text or ""), f"{words}: {text}"


@pytest.mark.parametrize("words", EVERY)
def test_each_command_and_each_group_shows_an_example(words):
    assert "elbowroom" in (EVERY[words].epilog or ""), words


@pytest.mark.parametrize("words", EVERY)
def test_an_argument_is_named_without_brackets_of_its_own(words):
    for parameter in EVERY[words].params:
        if parameter.param_type_name == "argument":
            assert "[" not in (parameter.metavar or "")
