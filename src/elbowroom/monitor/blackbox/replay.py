"""Every verdict of a recording computed again, and compared with what was kept, to the last bit."""

import json
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from typing import Any

from elbowroom.monitor.blackbox.kept_pass import judged, plain
from elbowroom.monitor.blackbox.recording import RecordedPass, Recording
from elbowroom.monitor.cycle import Cycle
from elbowroom.monitor.result import CycleResult
from elbowroom.monitor.separation.figures import Figures
from elbowroom.monitor.separation.margins import Margins
from elbowroom.monitor.space_cycle import SpaceCycle
from elbowroom.motion import Cause, Verdict

COMPARED = ("space", "fault", "skew_ms", "oldest_age_ms", "path", "off_path", "distances")
"""What is compared besides verdicts, as far as it was kept: earlier versions kept no distances."""
MEASURED = "reaction_ms"
"""Of margins what was measured, and is taken as it was kept."""


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
    configuration = recording.configuration()
    cycle, figures = configuration.cycle(), configuration.figures()
    for one in recording.passes(begin):
        yield compared(one, cycle, figures)


def compared(one: RecordedPass, cycle: Cycle | SpaceCycle, figures: Figures | None = None) -> Compared:
    """Judges a pass again, and compares.

    Args:
        one: the pass.
        cycle: of its configuration.
        figures: of its margins; None: there are none.
    """
    found, word = _again(one, cycle)
    now = _plain(judged(found))
    differences = [*_differences(one.judged, now), *_margins(one, found, figures)]
    return Compared(one.number, one.sequence, len(found.verdicts), one.lost, word, tuple(differences))


def _margins(one: RecordedPass, found: CycleResult, figures: Figures | None) -> Iterator[str]:
    """What is not the same of the margins, by the reaction time that was known."""
    if one.margins is None:
        return
    if figures is None or found.distances is None:
        yield "margins: were kept, and cannot be computed"
        return
    kept = one.margins
    now = _plain(plain(Margins(found.distances, figures, None, kept["worst_reaction_ms"]).row()))
    for key in (key for key in now if key != MEASURED):
        if kept.get(key) != now[key]:
            yield f"margins: {key} was {kept.get(key)!r}, is {now[key]!r}"


def _again(one: RecordedPass, cycle: Cycle | SpaceCycle) -> tuple[CycleResult, str | None]:
    """A pass judged again; what was known of it beside what was seen is taken as it was kept."""
    kept = one.judged
    if kept["given"] is None:
        result = cycle.failed(_NotJudged(), one.snapshot)
        is_fault = kept["fault"] is not None
        word = kept["fault"] if is_fault else kept["stopped_by"]
        cause = Cause.FAULT if is_fault else _cause_of(kept) or Cause.FAULT
    else:
        frames = tuple(frame for frame in one.snapshot.frames if frame.camera in kept["given"])
        result = cycle.run(replace(one.snapshot, frames=frames))
        word, found = _word(kept, result)
        if found is None:
            return result, None
        cause = found
    # a fault that does not come again was none of the images'
    is_elsewhere = cause is Cause.FAULT or kept["given"] is None
    verdicts = tuple(_stopped(verdict, cause, is_elsewhere) for verdict in result.verdicts)
    result = replace(result, verdicts=verdicts, fault=kept["fault"] if is_elsewhere else result.fault)
    return (replace(result, space=None, distances=None) if kept["space"] is None else result), word


def _word(kept: Mapping[str, Any], result: CycleResult) -> tuple[str | None, Cause | None]:
    """Why all is stop though the images do not say so, and the cause that was given; None: they decide."""
    if kept["late"] is not None:
        return kept["late"], Cause.STALE
    if kept["fault"] is not None:
        return (kept["fault"], Cause.FAULT) if result.fault is None else (None, None)
    cause = None if kept["stopped_by"] is None else _cause_of(kept)
    return (None, None) if cause is None else (kept["stopped_by"], cause)


def _cause_of(kept: Mapping[str, Any]) -> Cause | None:
    """The one cause by which all motions were stop; None: there are several, or none."""
    causes = {verdict["cause"] for verdict in kept["verdicts"] if verdict["level"] == "stop"}
    alike = len(causes) == 1 and all(verdict["level"] == "stop" for verdict in kept["verdicts"])
    return Cause[causes.pop().upper()] if alike else None


def _stopped(verdict: Verdict, cause: Cause, is_elsewhere: bool) -> Verdict:
    """Stop for the same motion; of a fault of the images themselves it stays one."""
    if verdict.cause is Cause.FAULT and not is_elsewhere:
        return verdict
    return Verdict.stop(verdict.motion, verdict.free_travel_unit, cause)


class _NotJudged(Exception):
    """Nothing was judged in that pass."""


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
        if key in kept and kept[key] != now.get(key):
            yield f"{key}: was {kept.get(key)!r}, is {now.get(key)!r}"


def _plain(value: Any) -> Any:
    """As it is read from a file."""
    return json.loads(json.dumps(value))
