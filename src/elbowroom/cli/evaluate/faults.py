"""`elbowroom evaluate faults`: whether any fault passes silently."""

from itertools import chain
from typing import Annotated, Any

import typer

from elbowroom.cli.options import JsonFile

DISKS = 5
"""So often a disk is full: each time is a start of the monitor."""
QUICK, QUICK_DEADLINE_MS = 1, 400.0


def faults(
    times: Annotated[
        int,
        typer.Option(
            min=1,
            metavar="COUNT",
            help="How often each kind is thrown; half as often one after which the monitor is started again.",
        ),
    ] = 26,
    quick: Annotated[
        bool,
        typer.Option("--quick", help="Each kind once, on a computer that may be busy: times say nothing."),
    ] = False,
    deadline: Annotated[
        float,
        typer.Option(min=20, max=5000, metavar="MS", help="Of the gate; two without a pass are silence."),
    ] = 60.0,
    seed: Annotated[int, typer.Option(min=0, help="Of the moments and the cameras.")] = 1,
    json: JsonFile = None,
) -> None:
    """Throw every kind of fault at a running monitor, and look whether, when and why the machine stops.

    A small room of eight cameras at 15 Hz and a box that slides, with a gate, its
    watchdog and a Modbus reader, each in its own process or thread. Kinds: of a
    camera, of the joints, of the clock, of the process. Each begins at a random
    moment. After it has stopped it ends, its cause has to clear, and a reset lets
    the machine move again. Times are from when the first wrong thing was handed
    to the monitor to when the reader reads stop.

    The whole of it throws about 1,000 faults in some 20 minutes, and wants a
    computer that does nothing else. After Ctrl-C the fault at hand comes to its
    end, and what was measured is shown and written.
    """
    from elbowroom.cli.evaluate.measured import watched
    from elbowroom.cli.evaluate.shown import as_table, print_, text
    from elbowroom.cli.interrupt import asked_to_end
    from elbowroom.evaluate.due import sentence
    from elbowroom.evaluate.faults.faults import DUE, fault_rows, fault_summary, turns_of
    from elbowroom.evaluate.faults.full_disk import full_disk_rows
    from elbowroom.files.json_rows import json_rows

    many = QUICK if quick else times
    show = as_table(
        {
            "input": "{input}",
            "fault": "{case}",
            "times": "{times}",
            "shown": "{shown}",
            "silent": "{silent}",
            "misnamed": "{misnamed}",
            "median": text("{:.0f} ms", "median_ms"),
            "worst": text("{:.0f} ms", "worst_ms"),
            "noticed by": "{noticed_by}",
            "named": "{causes}",
        },
        sentence(DUE),
    )
    deadline_ms, disks = QUICK_DEADLINE_MS if quick else deadline, min(many, DISKS)
    total, rows = len(turns_of(many)) + disks, []
    # a folder that is not there is said at once
    with (
        json_rows(json) as add,
        asked_to_end("what was measured until now is shown and written") as is_over,
    ):
        found = chain(fault_rows(many, seed, deadline_ms), full_disk_rows(disks, seed, deadline_ms))
        for row in watched("faults", found, total):
            rows.append(row)
            if is_over():
                break
        summary = fault_summary(rows)
        for row in (*filter(_tells, rows), *summary):
            add(row)
    show(summary)
    if len(rows) < total:
        print_(f"Ended after {len(rows)} of {total} faults.")


def _tells(row: dict[str, Any]) -> bool:
    """Whether a fault that was thrown showed, and passed silently or was misnamed."""
    return row["shown"] and not (row["stopped"] and row["named"])
