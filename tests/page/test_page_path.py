"""A path that was asked for: its swept volume, its level's colour, its first contact, in a run and in its recording."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from elbowroom.monitor import Pass
from elbowroom.monitor.blackbox.configuration import Configuration, plain_cycle
from elbowroom.monitor.blackbox.recorder import Recorder
from elbowroom.monitor.blackbox.recording import Recording
from elbowroom.monitor.blackbox.sinks import WholeRun
from elbowroom.motion import Level
from elbowroom.page.scene.bodies import points_in_world
from elbowroom.page.scene.ways import CELL_M
from elbowroom.page.stage import Stage
from elbowroom.page.story.path import path_said
from elbowroom.page.story.requested import AHEAD_S, end_of_path, level_of_path, poses_of_path
from elbowroom.page.story.told import told_of, told_of_recorded
from elbowroom.page.words import words_of
from elbowroom.sensing import MeantPath
from elbowroom.site import Site
from elbowroom.sources import open_room
from reference.small_room import SMALL_ROOM

EN = words_of("en")


class Seen:
    """A scene that keeps what it is shown."""

    def __init__(self) -> None:
        self.path, self.contacts, self.ways = None, [], {}

    def show_way(self, number, points, level) -> None:
        self.ways[number] = len(points), level

    def show_path(self, points, level) -> None:
        self.path = points, level

    def show_contacts(self, contacts) -> None:
        self.contacts = contacts


@pytest.fixture(scope="module")
def passes(tmp_path_factory):
    """Passes of a small room: with a path to the left, with one that begins elsewhere, without one; and a recording."""
    folder: Path = tmp_path_factory.mktemp("path")
    (folder / "room.yaml").write_text(SMALL_ROOM)
    room = open_room(Site.load(folder / "room.yaml"))
    snapshot, cycle = next(iter(room.source)), plain_cycle(room)
    assert snapshot.joints is not None
    at_ns, here = (
        snapshot.moment_ns if snapshot.joints_ns is None else snapshot.joints_ns,
        snapshot.joints["long"],
    )
    on = MeantPath(("long",), [at_ns, at_ns + 4_000_000_000], [[here], [here + 0.4]])
    off = MeantPath(("long",), [at_ns, at_ns + 4_000_000_000], [[here + 0.3], [here + 0.4]])
    recorder = Recorder([WholeRun(folder / "run.mcap")])
    recorder.begin(room)
    found = []
    for path in (on, off, None):
        given = replace(snapshot, path=path)
        done = Pass(given, cycle.run(given), 0.0)
        recorder.show(done)
        found.append(told_of(done, 10**18))
    recorder.end()
    assert recorder.troubles == []
    with Recording(folder / "run.mcap") as recording:
        again = [told_of_recorded(recording.at(number)) for number in range(3)]
        yield found, again, recording.configuration()


def shown(told, configuration: Configuration) -> Seen:
    seen = Seen()
    Stage(seen, configuration, "path").show_ways(told)
    return seen


def test_a_recording_says_of_the_path_what_the_run_said(passes):
    found, again, _ = passes
    for told, recorded in zip(found, again, strict=True):
        assert told["path"] == recorded["path"] and path_said(told, EN) == path_said(recorded, EN)
        assert end_of_path(told) == end_of_path(recorded)


def test_the_swept_volume_of_the_path_is_where_the_machine_comes_in_its_levels_colour(passes):
    (told, *_), _, configuration = passes
    seen = shown(told, configuration)
    points, level = seen.path
    assert len(points) > 50 and level is level_of_path(told) is Level[told["judged"]["path"]["level"].upper()]
    machine, own = configuration.machine, Stage(None, configuration)._points
    places = poses_of_path(told)
    first, last = (points_in_world(machine, own, place) for place in (places[0], places[-1]))
    moved = np.linalg.norm(first - last, axis=1) > 0.05
    for due in (last[moved], (first[moved] + last[moved]) / 2):  # the carriage goes straight
        gaps = np.linalg.norm(due[:, None] - points[None], axis=2).min(axis=1)
        assert gaps.max() < np.sqrt(3) * CELL_M + 0.03
    end, reached = end_of_path(told), places[-1]["long"] - places[0]["long"]
    row = told["judged"]["path"]
    until_s = max(row["looked_until_s"] - row["begin_s"], AHEAD_S)
    assert reached == pytest.approx(0.1 * min(until_s, 4.0), abs=1e-9)
    assert end is not None and ("path" in ", ".join(name for name, _ in seen.contacts))


def test_a_path_that_begins_elsewhere_is_drawn_as_a_stop_and_said(passes):
    (_, told, _), _, configuration = passes
    points, level = shown(told, configuration).path
    assert level is Level.STOP and len(points)
    said = path_said(told, EN)
    assert said["level"] == "stop" and "begins" in said["text"]


def test_without_a_path_nothing_is_drawn_or_said_of_one(passes):
    (*_, told), _, configuration = passes
    seen = shown(told, configuration)
    assert not len(seen.path[0]) and path_said(told, EN) is None
    assert all(name != "path" for name, _ in seen.contacts)


def test_clear_ways_are_drawn_where_somebody_asked_and_not_otherwise(passes):
    (*_, told), _, configuration = passes
    rows = [
        {**row, "level": "clear", "free_travel": row["braking_distance"]}
        for row in told["judged"]["verdicts"]
    ]
    told, seen = {**told, "judged": {**told["judged"], "verdicts": rows}}, Seen()
    stage = Stage(seen, configuration)
    stage.show_ways(told)
    assert not any(count for count, _ in seen.ways.values())
    stage.shown_ways = frozenset((1,))
    stage.show_ways(told)
    assert {number for number, (count, _) in seen.ways.items() if count} == {1}
    stage.shows_clear = True
    stage.show_ways(told)
    assert all(count and level is Level.CLEAR for count, level in seen.ways.values())
