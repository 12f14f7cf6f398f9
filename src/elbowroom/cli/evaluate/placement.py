"""`elbowroom evaluate placement`: the figures of `elbowroom placement`."""

from typing import Annotated

import typer

from elbowroom.cli.options import JsonFile


def placement(
    part: Annotated[
        list[str] | None,
        typer.Option(
            help="Only verify, sweep, optimise, room or setups; may be given more than once. Default: all."
        ),
    ] = None,
    quick: Annotated[bool, typer.Option(help="Few scenes, seconds and layouts: a first impression.")] = False,
    json: JsonFile = None,
) -> None:
    """Time verification and sweep, find fewest cameras, and compare predicted free space with what is found."""
    from elbowroom.cli.evaluate.measured import measured
    from elbowroom.cli.evaluate.placement_shown import show
    from elbowroom.evaluate.placement.effort import FULL, QUICK
    from elbowroom.evaluate.placement.rows import PARTS, ROWS, placement_rows

    parts = tuple(dict.fromkeys(part or PARTS))
    rows = placement_rows(parts, QUICK if quick else FULL)
    measured("figures", rows, sum(ROWS.get(name, 0) for name in parts), json, show)
