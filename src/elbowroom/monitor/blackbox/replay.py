"""Every verdict of a recording computed again, and compared with what was kept, to the last bit."""

import json
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from typing import Any

from elbowroom.monitor.blackbox.kept_pass import judged
from elbowroom.monitor.blackbox.recording import RecordedPass, Recording
from elbowroom.monitor.cycle import Cycle
from elbowroom.monitor.result import CycleResult, stopped
from elbowroom.monitor.space_cycle import SpaceCycle
from elbowroom.motion import Cause, Verdict

COMPARED = ("space", "fault", "skew_ms", "oldest_age_ms")
"""What is compared besides verdicts."""


@dataclass(frozen=True, slots=True)
class Compared:
    """A pass that was judged again.

    Args:
        number: in the file, from 0.
        sequence: in its run.
        verdicts: how many there are.
        lost: how many passes before it were not kept.
        by_word: why all is stop by what was kept, and not by what is computed: the time that the pass took, cameras
            that are elsewhere, input that cannot be right; None: it is not.
        differences: what is not the same, a sentence each; none: it is identical.
    """

    number: int
    sequence: int
    verdicts: int
    lost: int
    by_word: str | None
    differences: tuple[str, ...]


def replayed(recording: Recording, begin: int = 0) -> Iterator[Compared]:
    """Judges passes again, one after the other.

    Args:
        recording: whose passes.
        begin: number of the first one in the file.

    Raises:
        BagError: the recording is malformed.
    """
    cycle = recording.configuration().cycle()
    for one in recording.passes(begin):
        yield compared(one, cycle)


def compared(one: RecordedPass, cycle: Cycle | SpaceCycle) -> Compared:
    """Judges a pass again, and compares.

    Args:
        one: the pass.
        cycle: of its configuration.
    """
    found, word = _again(one, cycle.run(one.snapshot))
    now = _plain(judged(found))
    return Compared(
        one.number, one.sequence, len(found.verdicts), one.lost, word, tuple(_differences(one.judged, now))
    )


def _again(one: RecordedPass, result: CycleResult) -> tuple[CycleResult, str | None]:
    """A pass with what was known of it beside what was seen: that is taken as it was kept."""
    kept = one.judged
    checks_failed = kept["fault"] is not None and result.fault is None and kept["space"] is not None
    word, cause = _word(kept, checks_failed)
    if cause is None:
        return result, None
    verdicts = tuple(_stopped(verdict, cause) for verdict in result.verdicts)
    return replace(result, verdicts=verdicts, fault=kept["fault"] if checks_failed else result.fault), word


def _word(kept: Mapping[str, Any], checks_failed: bool) -> tuple[str | None, Cause | None]:
    """Why all is stop though the pass judged, and the cause that was given."""
    if kept["late"] is not None:
        return kept["late"], Cause.STALE
    if checks_failed:
        return kept["fault"], Cause.FAULT
    wrong = "; ".join(finding["text"] for finding in kept["findings"] if finding["stops"])
    if wrong:
        return wrong, Cause.INPUT
    return (kept["watch"], Cause.WATCH) if kept["watch"] is not None else (None, None)


def _stopped(verdict: Verdict, cause: Cause) -> Verdict:
    if cause is Cause.STALE and verdict.cause is not Cause.FAULT:
        return Verdict.stop(verdict.motion, verdict.free_travel_unit, cause)
    return stopped(verdict, cause)


def _differences(kept: Mapping[str, Any], now: Mapping[str, Any]) -> Iterator[str]:
    was, is_ = kept["verdicts"], now["verdicts"]
    if len(was) != len(is_):
        yield f"{len(was)} verdicts were kept, {len(is_)} are computed"
    for before, after in zip(was, is_, strict=False):
        of = f"{before.get('joint')} {before.get('direction') or ''}".strip()
        for key in (*before, *(key for key in after if key not in before)):
            if before.get(key) != after.get(key):
                yield f"{of}: {key} was {before.get(key)!r}, is {after.get(key)!r}"
    for key in COMPARED:
        if kept.get(key) != now.get(key):
            yield f"{key}: was {kept.get(key)!r}, is {now.get(key)!r}"


def _plain(value: Any) -> Any:
    """As it is read from a file."""
    return json.loads(json.dumps(value))
