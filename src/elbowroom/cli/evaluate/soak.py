"""`elbowroom evaluate soak`: whether a long run goes on as it begins."""

from typing import Annotated

import typer

from elbowroom.cli.options import JsonFile

QUICK_MINUTES = 0.5


def soak(
    minutes: Annotated[float, typer.Option(min=0.1, metavar="MINUTES", help="How long.")] = 30.0,
    quick: Annotated[bool, typer.Option("--quick", help="Half a minute: no slope is said.")] = False,
    cameras: Annotated[int, typer.Option(min=1, max=255, help="How many cameras.")] = 21,
    size: Annotated[str, typer.Option(help="Of their images: vga, qqvga or thesis.")] = "vga",
    json: JsonFile = None,
) -> None:
    """Run the whole monitor at full rate for long: does its memory grow, is anything lost, what is its worst pass?

    The simulated room from memory, with its watch, gate, distances, a recording of
    all passes and the black box, with 1 GB of memory, which is soon full. The recording
    is begun anew every 30 s and the file before it taken away, so it needs no more than
    20 GB of disk. Memory is looked at
    once a second; its slope is that of Theil and Sen over the medians of 20 s, after
    the first quarter, with its interval of 95 %.
    """
    from elbowroom.cli.evaluate.measured import measured, told
    from elbowroom.cli.evaluate.shown import as_table
    from elbowroom.evaluate.due import sentence
    from elbowroom.evaluate.held_memory import words_of_slope
    from elbowroom.evaluate.soak.soak import DUE, soak_rows, words_of_worst
    from elbowroom.simulate.cameras import SIZES

    show = as_table(
        {
            "cameras": "{cameras} of {width}x{height}",
            "passes": "{passes}",
            "late": "{late}",
            "median": "{median_ms:.0f} ms",
            "99 %": "{p99_ms:.0f} ms",
            "worst": "{max_ms:.0f} ms",
            "the worst": words_of_worst,
            "lost": "{lost}",
            "recorder": "{recorder_core_share:.2f} of a core",
            "holds": "{resident_mb:.0f} MB",
            "memory grows": words_of_slope,
        },
        sentence(DUE),
    )
    seconds = 60 * (QUICK_MINUTES if quick else minutes)
    rows = told(lambda tell: soak_rows(seconds, cameras, SIZES[size][:2], tell))
    measured("runs", rows, None, json, show)
