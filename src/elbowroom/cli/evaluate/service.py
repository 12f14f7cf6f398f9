"""`elbowroom evaluate service`: what attacks on the control service come to."""

from typing import Annotated

import typer

from elbowroom.cli.options import JsonFile


def service(
    rounds: Annotated[
        int, typer.Option(min=1, metavar="COUNT", help="How often left alone and attacked.")
    ] = 6,
    seconds: Annotated[float, typer.Option(min=1, max=60, metavar="S", help="How long each.")] = 5.0,
    rate: Annotated[
        float, typer.Option(min=1, max=10_000, metavar="A_SECOND", help="Requests of the attack.")
    ] = 1000.0,
    json: JsonFile = None,
) -> None:
    """Attack the control service of a running monitor, and look what is let in and how much later passes are.

    A small room of eight cameras at 15 Hz, its gate and its service, by turns left
    alone and attacked from another process with wrong tokens, foreign origins and
    hosts, replayed, oversized and broken requests, 1,000 a second. Times are from
    a snapshot to its decision. The attacker takes processor time as well, which is
    measured apart: in turn the same requests go to a server that only closes. Let
    the computer do nothing else.
    """
    from elbowroom.cli.evaluate.measured import telling, watched
    from elbowroom.cli.evaluate.shown import as_table, text
    from elbowroom.cli.interrupt import asked_to_end
    from elbowroom.evaluate.due import sentence
    from elbowroom.evaluate.service.rows import DUE, service_rows, service_summary
    from elbowroom.files.json_rows import json_rows

    show = as_table(
        {
            "attack": "{case}",
            "requests": "{requests}",
            "let in": "{let_in}",
            "answered": text("{}", "answered"),
            "p99 alone": text("{:.1f} ms", "alone_p99_ms"),
            "closing": text("{:.1f} ms", "closing_p99_ms"),
            "attacked": text("{:.1f} ms", "attacked_p99_ms"),
            "worst alone": text("{:.1f} ms", "alone_worst_ms"),
            "closing ": text("{:.1f} ms", "closing_worst_ms"),
            "attacked ": text("{:.1f} ms", "attacked_worst_ms"),
        },
        sentence(DUE),
    )
    rows = []
    with (
        json_rows(json) as add,
        asked_to_end("what was measured until now is shown and written") as is_over,
        telling() as tell,
    ):
        for row in watched("stretches", service_rows(rounds, seconds, rate, tell), 3 * rounds):
            rows.append(row)
            add(row)
            if is_over():
                break
        summary = service_summary(rows)
        for row in summary:
            add(row)
    show(summary)
