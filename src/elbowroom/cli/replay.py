"""`elbowroom replay`: what a recorded run decided, decided again."""

from pathlib import Path
from typing import Annotated

import typer

from elbowroom.cli.options import FoxglovePort, JsonFile, Language, PagePort, use_threads

RecordingPath = Annotated[
    Path, typer.Argument(metavar="FILE", help="A file of `monitor --record`, or of its black box.")
]


def replay(
    file: RecordingPath,
    begin: Annotated[
        int | None, typer.Option("--from", min=0, metavar="CYCLE", help="Begin with this cycle of the run.")
    ] = None,
    why: Annotated[
        int | None,
        typer.Option(min=0, metavar="CYCLE", help="Say of one cycle what ended each motion's way, and why."),
    ] = None,
    page: Annotated[
        bool, typer.Option("--page", help="Show it in a browser: time, stops, play, step, and why.")
    ] = False,
    page_port: PagePort = None,
    language: Language = "en",
    foxglove: Annotated[
        bool, typer.Option("--foxglove", help="Show it in Foxglove, whose controls play, pause and seek.")
    ] = False,
    foxglove_port: FoxglovePort = 8765,
    threads: Annotated[int | None, typer.Option(min=1, help="Cores to use. Default: all.")] = None,
    json: JsonFile = None,
) -> None:
    """Judge a recorded run again, and say whether each verdict is the same to the last bit.

    First every byte of the file is compared with its chain of sums: one bit that is
    another is found. A file that was cut off is judged up to the cut. Ends with 1
    where a verdict or a byte is not as it was.

    What the clock decided (images too old when the verdicts were out), and what the
    drift watch and the looks at the input found, is taken as it was recorded.

    With --page or --foxglove it is not compared, but shown, at 127.0.0.1, until Ctrl-C.
    """
    use_threads(threads)

    from elbowroom.cli.replay_run import explain_cycle, judge_again

    if page:
        from elbowroom.cli.replay_page import show_page

        show_page(file, begin, page_port, language)
    elif foxglove:
        from elbowroom.cli.replay_foxglove import show_foxglove

        show_foxglove(file, begin, foxglove_port)
    elif why is not None:
        explain_cycle(file, why, json)
    elif not judge_again(file, begin, json):
        raise typer.Exit(1)
