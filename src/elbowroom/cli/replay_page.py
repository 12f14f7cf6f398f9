"""The run of `elbowroom replay --page`."""

from pathlib import Path

from rich.console import Console

from elbowroom.cli.interrupt import asked_to_end
from elbowroom.cli.progress import Steps
from elbowroom.cli.replay_run import checked, compiled
from elbowroom.monitor.blackbox.recording import Recording
from elbowroom.page.page import Page
from elbowroom.page.replay.again import Judge
from elbowroom.page.replay.replayed import Replayed, extra_of
from elbowroom.page.replay.stops import Stop, stops_of
from elbowroom.page.words import words_of
from elbowroom.view.screen.words import NOT_CERTIFIED

PORT = 8138
"""At which it is, if nobody says otherwise: that of the monitor's page stays free."""


def show_page(file: Path, begin: int | None, port: int | None, language: str) -> None:
    """Shows a recording in a browser, until somebody asks for the end.

    Args:
        file: the recording.
        begin: number of the first cycle in its run; None: the first stop, or the first that it holds.
        port: at which; None: `PORT`.
        language: of the page's words.

    Raises:
        BagError: it is no recording, or malformed.
        InputError: no such language, or the port is taken.
        PackageError: viser is missing.
    """
    words = words_of(language)
    with Recording(file) as recording:
        checked(recording)
        configuration = recording.configuration()
        compiled(configuration)
        stops = stops_with_bar(recording)
        extra = extra_of(stops, len(recording), recording.note, words)
        page = Page(configuration, words, "replay", extra)
        page.open(PORT if port is None else port)
        print(f"page: {page.server.url} (Ctrl-C ends)", flush=True)
        first = stops[0].index if stops else 0
        if begin is not None:
            first = recording.number_of(begin)
        with asked_to_end() as is_over:
            Replayed(page, Judge(recording, configuration), is_over).run(first)
        page.server.stop()
    print(NOT_CERTIFIED)


def stops_with_bar(recording: Recording) -> list[Stop]:
    """The stops of a recording, looked for with a bar."""
    console = Console(stderr=True)
    with Steps(console, 1) as steps:
        steps.begin("looking for stops")
        tell = (
            (lambda done: steps.counted(done, len(recording))) if console.is_terminal else lambda done: None
        )
        return list(stops_of(recording, tell))
