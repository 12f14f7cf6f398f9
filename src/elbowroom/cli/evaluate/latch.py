"""`elbowroom evaluate latch`: whether the gate's latch is kept."""

from typing import Annotated

import typer

from elbowroom.cli.options import JsonFile

QUICK = 300


def latch(
    times: Annotated[int, typer.Option(min=1, metavar="COUNT", help="How often, of each kind.")] = 10_000,
    quick: Annotated[bool, typer.Option("--quick", help=f"{QUICK} times are enough.")] = False,
    seed: Annotated[int, typer.Option(min=0, help="Of the moments and of what happens.")] = 1,
    json: JsonFile = None,
) -> None:
    """Kill a gate at random moments, cut its latch off at every byte, and count how often it is not latched after.

    Killed: a gate with faults, resets and ends at random, by SIGKILL within 60 ms of
    its start, again and again in one folder. What it had said to have latched has to
    be latched, by name. Cut off, one bit changed: latches of all kinds. Older: each
    file that a run leaves on its way.
    """
    from elbowroom.cli.evaluate.measured import watched
    from elbowroom.cli.evaluate.shown import as_table, text
    from elbowroom.evaluate.due import sentence
    from elbowroom.evaluate.latch.latch import DUE, latch_rows, latch_summary, wrong_rows
    from elbowroom.files.json_rows import json_rows

    many = QUICK if quick else times
    show = as_table(
        {
            "case": "{case}",
            "times": "{times}",
            "kept": "{kept}",
            "lost": "{lost}",
            "causes not named": "{unnamed}",
            "killed after it had latched": text("{}", "after_latching"),
            "killed inside a write": text("{}", "inside_a_write"),
            "unlatched, rightly": text("{}", "unlatched"),
        },
        sentence(DUE),
    )
    with json_rows(json) as add:  # a folder that is not there is said at once
        rows = list(watched("times", latch_rows(many, seed), 4 * many))
        summary = latch_summary(rows)
        for row in (*wrong_rows(rows), *summary):
            add(row)
    show(summary)
