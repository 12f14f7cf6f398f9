"""What the page says: why it stopped, for stops of twenty causes, read from its text alone, after being recorded."""

from pathlib import Path

import pytest

from elbowroom.monitor.blackbox.recorder import Recorder
from elbowroom.monitor.blackbox.recording import Recording
from elbowroom.monitor.blackbox.sinks import WholeRun
from elbowroom.motion import Cause
from elbowroom.page.replay.again import Judge
from elbowroom.page.replay.stops import stops_of
from elbowroom.page.telling import Telling, clock
from elbowroom.page.words import words_of
from elbowroom.site import Site
from elbowroom.sources import open_room
from reference.page_stops import clear, stops
from reference.small_room import SMALL_ROOM


@pytest.fixture(scope="module")
def recorded(tmp_path_factory):
    """A recording of a run that stops twenty times, and what is due to be said of each stop."""
    folder: Path = tmp_path_factory.mktemp("stops")
    (folder / "room.yaml").write_text(SMALL_ROOM)
    room = open_room(Site.load(folder / "room.yaml"))
    _, motions = room.machine_and_motions()
    recorder = Recorder([WholeRun(folder / "run.mcap")])
    recorder.begin(room)
    given = stops(motions)
    for number, (_, done, _) in enumerate(given):
        recorder.show(clear(2 * number, motions))
        recorder.show(done)
    recorder.end()
    assert recorder.troubles == []
    with Recording(folder / "run.mcap") as recording:
        yield recording, given


def page_text(recording: Recording, index: int, language: str = "en") -> str:
    """All that the page shows of a moment as text."""
    judge = Judge(recording, recording.configuration())
    telling = Telling(judge.configuration, words_of(language), "replay")
    told, _ = judge.told(index)
    telling.rates.hear(told)
    said = telling.moment(told, telling.cameras(told))
    why = said["why"] or {"sentence": "", "changes": []}
    rows = [f"{row['name']} {row['word']} {row['free']} {row['cause']}" for row in said["motions"]]
    texts = (
        said["at"],
        said["word"],
        said["sentence"],
        said["detail"],
        why["sentence"],
        *why["changes"],
        *rows,
    )
    return "\n".join(texts)


def test_twenty_stops_are_marked_on_the_time(recorded):
    recording, given = recorded
    found = list(stops_of(recording))
    assert len(given) == 20 and len({name for name, _, _ in given}) == 20
    assert [stop.index for stop in found] == [2 * number + 1 for number in range(20)]


@pytest.mark.parametrize("number", range(20))
def test_why_it_stopped_is_read_from_the_page(recorded, number):
    recording, given = recorded
    name, _, due = given[number]
    index = 2 * number + 1
    text = page_text(recording, index)
    assert clock(recording.said_at(index)["wall_ns"]) in text and "STOP" in text
    missing = [piece for piece in due if piece not in text]
    assert not missing, f"{name}: {missing} not in\n{text}"
    # what is due of another stop is not said of this one: the text tells them apart
    alike = [other for other, _, pieces in given if other != name and all(one in text for one in pieces)]
    assert alike in ([], ["unseen"], ["creep"]) or name in ("cannot rest", "all blind"), alike


def test_each_stop_is_said_in_german_too(recorded):
    recording, given = recorded
    for number in range(len(given)):
        text = page_text(recording, 2 * number + 1, "de")
        assert "HALT" in text and "stops" not in text and "meets" not in text


def test_a_clear_moment_says_so(recorded):
    recording, _ = recorded
    text = page_text(recording, 0)
    assert "CLEAR" in text and "STOP" not in text and "All motions are clear." in text


@pytest.mark.parametrize("language", ["en", "de"])
@pytest.mark.parametrize("cause", list(Cause))
def test_each_cause_has_words(language, cause):
    words = words_of(language)
    assert words.has(f"cause.{cause.name.lower()}") and words.has(f"short.{cause.name.lower()}")
