"""Tables and notes as a command shows them where no terminal says how wide it is."""

import pytest

from elbowroom.cli.noise import noise_named
from elbowroom.cli.screen import note, show
from elbowroom.errors import InputError
from elbowroom.sensing import NOISE_PRESETS
from elbowroom.view.report.blocks import Table


def test_a_table_of_many_columns_keeps_a_line_a_row(capsys):
    columns = [f"column {n}" for n in range(12)]
    show(Table("", columns, [[str(n) for n in range(12)]]))
    lines = capsys.readouterr().out.splitlines()
    assert len(lines) == 2 and all(name in lines[0] for name in columns)


def test_words_stand_to_the_left_and_numbers_to_the_right(capsys):
    show(Table("", ("camera", "spots"), [("a", "1"), ("b", "200")]))
    assert [line.rstrip() for line in capsys.readouterr().out.splitlines()] == [
        "camera  spots",
        "a           1",
        "b         200",
    ]


def test_what_stands_in_brackets_is_shown(capsys):
    show(Table("shares [px]", ("fx [px]",), [("[bold]1[/bold]",)]))
    note("of all [px]")
    out = capsys.readouterr().out
    assert "shares [px]" in out and "fx [px]" in out and "[bold]1[/bold]" in out and "of all [px]" in out


def test_noise_is_exact_or_a_sensor():
    assert noise_named("exact") is None
    assert all(noise_named(name) is NOISE_PRESETS[name] for name in NOISE_PRESETS)
    with pytest.raises(InputError, match="--noise: 'sonar' is unknown, allowed are exact, kinect_v1"):
        noise_named("sonar")
