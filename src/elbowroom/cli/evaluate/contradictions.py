"""`elbowroom evaluate contradictions`."""

from typing import Annotated

import typer

from elbowroom.cli.options import JsonFile


def contradictions(
    sites: Annotated[
        int, typer.Option("--sites", min=1, help="Random sites, each described wrongly in twenty ways.")
    ] = 20,
    right: Annotated[
        int, typer.Option("--right", min=0, help="Random sites that are described rightly.")
    ] = 200,
    json: JsonFile = None,
) -> None:
    """Describe the cameras of random sites wrongly, in twenty ways, and see whether the wrong ones are named."""
    from elbowroom.cli.evaluate.measured import measured, told
    from elbowroom.cli.evaluate.shown import as_table
    from elbowroom.evaluate.contradictions.rows import DUE, contradiction_rows
    from elbowroom.evaluate.due import sentence

    show = as_table(
        {
            "described wrongly": lambda row: row.get("what", row["kind"]),
            "sites": "{sites}",
            "named": lambda row: str(row.get("named", "")),
            "stopped": "{stopped}",
            "warned": lambda row: str(row.get("warned", "")),
        },
        sentence([due for dues in DUE.values() for due in dues]),
    )
    rows = told(lambda tell: contradiction_rows(tell, sites=sites, right=right))
    measured("ways", rows, None, json, show)
