"""`elbowroom evaluate page`: what the page costs, how fast it is, and who gets in."""

from collections.abc import Iterator
from typing import Annotated, Any

import typer

from elbowroom.cli.options import JsonFile

QUICK_BLOCKS = 2


def page(
    quick: Annotated[
        bool, typer.Option("--quick", help=f"{QUICK_BLOCKS} blocks of passes are enough, and no picture.")
    ] = False,
    json: JsonFile = None,
) -> None:
    """Measure the page of the simulated room at 2 cm: cost to the cycle, updates, a click, attacks, a report.

    Four viewers read, one never does; those who attack ask with foreign names, from
    foreign pages, with too long and too slow requests, a thousand a second. The first
    picture needs Chromium and playwright.
    """
    from elbowroom.cli.evaluate.measured import measured, told
    from elbowroom.cli.evaluate.shown import print_
    from elbowroom.evaluate.due import sentence
    from elbowroom.evaluate.page.measured import BLOCKS, DUE, page_rows
    from elbowroom.evaluate.page.picture import first_picture

    def rows(tell: Any) -> Iterator[dict[str, Any]]:
        if not quick:
            tell("first picture")
            yield first_picture()
        yield from page_rows(QUICK_BLOCKS if quick else BLOCKS, tell)

    def show(found: Any) -> None:
        for row in found:
            print_(", ".join(f"{key} {_text(value)}" for key, value in row.items()))
        print_(sentence(DUE))

    measured("figures", told(rows), None, json, show)


def _text(value: Any) -> str:
    return f"{value:.3g}" if isinstance(value, float) else str(value)
