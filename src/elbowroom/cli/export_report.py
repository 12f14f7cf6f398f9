"""The run of `elbowroom export --report`."""

from pathlib import Path

from elbowroom.cli.replay_page import stops_with_bar
from elbowroom.cli.replay_run import checked, compiled
from elbowroom.errors import InputError
from elbowroom.monitor.blackbox.recording import Recording
from elbowroom.page.replay.again import Judge
from elbowroom.page.report.span import at_stop, at_time, span_of
from elbowroom.page.report.written import write_report
from elbowroom.page.words import words_of
from elbowroom.view.screen.words import NOT_CERTIFIED


def export_report(file: Path, out: Path, about: tuple[str | None, int | None, float], language: str) -> None:
    """Writes the report of a stop.

    Args:
        file: the recording.
        out: where the report goes.
        about: time of day, or number of the stop, of which at most one is named; and how many seconds.
        language: of its words.

    Raises:
        BagError: it is no recording, or malformed.
        InputError: no such stop, time or language, or the file cannot be written.
    """
    words = words_of(language)
    time, number, seconds = about
    if time is not None and number is not None:
        raise InputError("export: --at and --stop name two moments; leave one out")
    with Recording(file) as recording:
        wrong = checked(recording)
        configuration = recording.configuration()
        compiled(configuration)
        moment = at_time(recording, time) if time is not None else at_stop(stops_with_bar(recording), number)
        span = span_of(recording, moment, seconds)
        written = write_report(out, Judge(recording, configuration), span, words, wrong)
    print(f"{written.cycles} cycles, the room drawn {written.drawn} times, {written.size / 1e6:.1f} MB")
    print(f"written: {out}")
    print(NOT_CERTIFIED)
