"""The run of `elbowroom replay`."""

import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import Any

from rich.console import Console

from elbowroom.cli.check_run import numbers, reasons_of, said, sentence
from elbowroom.cli.evaluate.measured import watched
from elbowroom.cli.progress import Steps
from elbowroom.errors import BagError
from elbowroom.files.json_rows import json_rows
from elbowroom.monitor.blackbox.configuration import Configuration
from elbowroom.monitor.blackbox.recording import Recording
from elbowroom.monitor.blackbox.replay import Compared, replayed
from elbowroom.monitor.cycle import Cycle
from elbowroom.monitor.start.compiling import compile_kernels
from elbowroom.monitor.why.why import why
from elbowroom.motion import Level, Motion
from elbowroom.view.screen.words import NOT_CERTIFIED

MOST_SHOWN = 10
"""So many differences are shown."""


def judge_again(file: Path, begin: int | None, json_file: Path | None) -> bool:
    """Judges a recording again and says what came of it; whether all is as it was.

    Args:
        file: the recording.
        begin: number of the first cycle; None: the first that it holds.
        json_file: where a row for each cycle goes; None: nowhere.

    Raises:
        BagError: it is no recording, or malformed.
    """
    with json_rows(json_file) as add, Recording(file) as recording:
        wrong = checked(recording)
        configuration = recording.configuration()
        for line in _told(configuration, recording):
            print(line)
        compiled(configuration)
        first = 0 if begin is None else recording.number_of(begin)
        found: list[Compared] = []
        rows = watched("cycles", replayed(recording, first), len(recording) - first)
        try:
            for one in rows:
                found.append(one)
                add(_row(one))
        except BagError as error:
            if wrong is None:
                raise
            print(f"Cycles from here on cannot be read: {error}")
        add({"kind": "file", "wrong": wrong, "note": recording.note, "sum": recording.sum})
    for line in _summary(found):
        print(line)
    print(NOT_CERTIFIED)
    return wrong is None and not any(one.differences for one in found)


def explain_cycle(file: Path, sequence: int, json_file: Path | None) -> None:
    """Says of one cycle what ended each motion's way, what each camera saw there, and what would change it.

    Args:
        file: the recording.
        sequence: number of the cycle in its run.
        json_file: where a row for each motion goes; None: nowhere.

    Raises:
        BagError: it is no recording, malformed, or does not hold that cycle.
    """
    with json_rows(json_file) as add, Recording(file) as recording:
        one = recording.at(recording.number_of(sequence))
        configuration = recording.configuration()
        compiled(configuration)
        cycle = configuration.cycle(keeps_images=True)
        given = one.judged["given"] or ()
        frames = tuple(frame for frame in one.snapshot.frames if frame.camera in given)
        result = cycle.run(replace(one.snapshot, frames=frames))
        print(
            f"cycle {sequence}, {_day(one.wall_ns)}, {len(frames)} of {len(one.snapshot.frames)} images were judged"
        )
        if one.judged["stopped_by"] is not None:
            print(f"Every motion was stop: {one.judged['stopped_by']}")
        for finding in one.judged["findings"]:
            if not finding["stops"]:
                print(f"Warning: {finding['text']}")
        if not isinstance(cycle, Cycle) or result.space is None:
            print("No motion was judged." if result.fault is None else f"The cycle fails: {result.fault}")
            return
        for verdict in result.verdicts:
            found = why(result.space, cycle.machine, one.snapshot.joints or {}, verdict)
            row = {"kind": "why", "sequence": sequence, **verdict.row(), "advice": list(found.advice)}
            add({**row, "outside_m": found.outside_m, "explanation": reasons_of(found, verdict)})
            if verdict.level is Level.CLEAR or not isinstance(verdict.motion, Motion):
                print(f"{verdict.motion.name}: {verdict.level.value}")
                continue
            for line in (*said(verdict.motion, verdict), *reasons_of(found, verdict), *numbers(found)):
                print(line)
            for line in map(sentence, found.advice):
                print(line)
    print(NOT_CERTIFIED)


def checked(recording: Recording) -> str | None:
    """Compares every byte with the chain, with a bar; says what is found."""
    with _bar(recording.size) as tell:
        wrong = recording.wrong(tell)
    if recording.note is not None:
        print(sentence(recording.note))
    print(f"Damaged: {wrong}." if wrong else f"Every byte is as it was written; sum {recording.sum}")
    return wrong


@contextmanager
def _bar(size: int) -> Iterator[Any]:
    console = Console(stderr=True)
    with Steps(console, 1) as steps:
        steps.begin("comparing every byte with its sum")
        yield (
            lambda done: steps.counted(done // 1_000_000, size // 1_000_000) if console.is_terminal else None
        )


def _told(configuration: Configuration, recording: Recording) -> Iterator[str]:
    told = configuration.told
    cameras, text = len(configuration.cameras), str(told.get("site_sha256"))[:16]
    yield f"{told.get('site')}: {len(recording)} cycles, {cameras} cameras, site file {text}"
    versions = told.get("versions") or {}
    yield f"recorded by elbowroom {versions.get('elbowroom')} ({told.get('commit')}) on {told.get('processor')}"


def compiled(configuration: Configuration) -> None:
    """Compiles what judging by a configuration needs."""
    console = Console(stderr=True)
    compile_kernels(
        console,
        machine=configuration.machine is not None,
        motion=bool(configuration.motions),
        simulator=False,
    )


def _summary(found: list[Compared]) -> Iterator[str]:
    verdicts, lost = sum(one.verdicts for one in found), sum(one.lost for one in found)
    other = [one for one in found if one.differences]
    if not other:
        yield f"identical: {len(found)} cycles, {verdicts} verdicts"
    else:
        yield f"different: {len(other)} of {len(found)} cycles; the first is cycle {other[0].sequence}:"
        yield from (f"  {text}" for text in other[0].differences[:MOST_SHOWN])
    by_word = [one for one in found if one.by_word is not None]
    if by_word:
        yield (
            f"in {len(by_word)} of them all was stop by what was recorded beside the images, first in cycle "
            f"{by_word[0].sequence}: {by_word[0].by_word}"
        )
    if lost:
        yield f"{lost} cycles of the run were not kept"


def _row(one: Compared) -> dict[str, Any]:
    return {
        "kind": "cycle",
        "sequence": one.sequence,
        "verdicts": one.verdicts,
        "lost": one.lost,
        "by_word": one.by_word,
        "identical": not one.differences,
        "differences": list(one.differences),
    }


def _day(wall_ns: int) -> str:
    return time.strftime("%Y-%m-%d %H:%M:%S UTC", time.gmtime(wall_ns / 1e9))
