"""`elbowroom evaluate cut` and `replay`: whether recordings open, and are judged again to the same bits."""

from typing import Annotated

import typer

from elbowroom.cli.evaluate.options import Seed
from elbowroom.cli.options import JsonFile

QUICK_CUTS, QUICK_CYCLES = 300, 300


def cut(
    times: Annotated[int, typer.Option(min=1, metavar="COUNT", help="How often, of each kind.")] = 10_000,
    quick: Annotated[bool, typer.Option("--quick", help=f"{QUICK_CUTS} times are enough.")] = False,
    seed: Seed = 1,
    json: JsonFile = None,
) -> None:
    """Cut a recording off at each of many bytes, change one bit at each of many, and open it.

    Cut off: it has to open, with all passes but at most one of those that had begun,
    and each as it was. One bit changed: that has to be said.
    """
    from elbowroom.cli.evaluate.measured import watched
    from elbowroom.cli.evaluate.shown import as_table, text
    from elbowroom.evaluate.due import sentence
    from elbowroom.evaluate.recording.cut import DUE, cut_rows, cut_summary
    from elbowroom.files.json_rows import json_rows

    many = QUICK_CUTS if quick else times
    show = as_table(
        {
            "case": "{case}",
            "times": "{times}",
            "not opened": text("{}", "not_opened"),
            "passes lost, at most": text("{}", "most_lost"),
            "passes not as they were": text("{}", "other"),
            "unnoticed": text("{}", "unnoticed"),
        },
        sentence(DUE),
    )
    with json_rows(json) as add:
        summary = cut_summary(list(watched("files", cut_rows(many, seed), 2 * many)))
        for row in summary:
            add(row)
    show(summary)


def replay(
    cycles: Annotated[int, typer.Option(min=1, metavar="COUNT", help="Of the cell's recording.")] = 10_000,
    quick: Annotated[bool, typer.Option("--quick", help=f"{QUICK_CYCLES} cycles are enough.")] = False,
    seed: Seed = 1,
    json: JsonFile = None,
) -> None:
    """Record runs, and judge them again: are all verdicts, distances and margins the same to the last bit?

    Runs are of a cell of eight cameras with a box that slides, and, a tenth of the
    cycles, of the simulated room with its C-arm. They are judged in other processes,
    with one thread and two, and with kernels compiled for any x86-64 processor in
    place of this one. Images are lost, old and without joints at random. What is
    compiled for any processor is compiled first, which takes minutes.
    """
    from elbowroom.cli.evaluate.measured import measured, told
    from elbowroom.cli.evaluate.shown import as_table, text
    from elbowroom.evaluate.due import sentence
    from elbowroom.evaluate.recording.again import DUE, again_rows

    show = as_table(
        {
            "room": "{room}",
            "way": "{way}",
            "cycles": "{cycles}",
            "verdicts": "{verdicts}",
            "different": "{different}",
            "the first": text("{}", "first"),
            "took": "{seconds:.0f} s",
        },
        sentence(DUE),
    )
    many = QUICK_CYCLES if quick else cycles
    measured("ways", told(lambda tell: again_rows(many, seed, tell)), None, json, show)
