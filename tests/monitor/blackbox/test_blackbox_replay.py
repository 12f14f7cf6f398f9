"""A recording judged again: identical, or the first difference is shown; cut off or damaged, it is said."""

import json
import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from PIL import Image

from elbowroom.errors import BagError, ElbowroomError
from elbowroom.monitor.blackbox import replay
from elbowroom.monitor.blackbox.configuration import CONFIGURATION, SITE, Configuration
from elbowroom.monitor.blackbox.exported import Export
from elbowroom.monitor.blackbox.recording import Recording
from elbowroom.monitor.blackbox.replay import compared, replayed
from reference.sample_run import PASSES, sample_run

SHARED = settings(suppress_health_check=[HealthCheck.function_scoped_fixture])


@pytest.fixture
def file(tmp_path: Path) -> Path:
    (tmp_path / "run.mcap").write_bytes(sample_run())
    return tmp_path / "run.mcap"


def test_a_run_is_judged_again_to_the_last_bit(file):
    with Recording(file) as recording:
        assert recording.wrong() is None and recording.note is None
        found = list(replayed(recording))
    assert [one.sequence for one in found] == list(range(PASSES))
    assert not any(one.differences for one in found)
    assert all(one.verdicts == 8 and one.by_word is None for one in found)


def test_a_verdict_that_was_another_is_shown(file, monkeypatch):
    with Recording(file) as recording:
        configuration = recording.configuration()
        cycle, figures = configuration.cycle(), configuration.figures()
        one = recording.at(3)
        first = one.judged["verdicts"][0]
        first["free_travel"] = first["free_travel"] + 2**-50
        (difference,) = compared(one, cycle, figures).differences
    assert difference.startswith(f"{first['joint']} {first['direction']}: free_travel was ")


def test_another_image_is_noticed_by_the_space_that_it_makes(file):
    with Recording(file) as recording:
        configuration = recording.configuration()
        cycle, figures = configuration.cycle(), configuration.figures()
        one, other = recording.at(2), recording.at(9)
        wrong = replay.RecordedPass(
            one.number, one.sequence, one.wall_ns, one.lost, other.snapshot, one.judged, one.gate
        )
        assert any(text.startswith("space: was ") for text in compared(wrong, cycle, figures).differences)


@pytest.mark.parametrize(
    "word",
    [
        {"late": "the oldest image is 300 ms old"},
        {"watch": True},
        {"findings": [{"kind": "unit", "about": [], "text": "millimetres", "stops": True}]},
        {"fault": "KeyError: 'the watch'"},
    ],
)
def test_what_was_known_beside_the_images_is_taken_as_it_was_kept(file, word):
    cause = {"late": "stale", "watch": "watch", "findings": "input", "fault": "fault"}[next(iter(word))]
    with Recording(file) as recording:
        configuration = recording.configuration()
        cycle, figures = configuration.cycle(), configuration.figures()
        one = recording.at(0)
        for verdict in one.judged["verdicts"]:
            verdict |= {
                "level": "stop",
                "band": "S",
                "free_travel": 0.0,
                "cause": cause,
                "overridable": False,
                "safe_speed": 0.0,
            }
            verdict |= {
                "link": None,
                "place_m": None,
                "other_link": None,
                "escapes": False,
                "zone": None,
                "creep": None,
            }
        one.judged.update(word)
        one.judged["stopped_by"] = "why"
        found = compared(one, cycle, figures)
    assert found.differences == ()
    assert found.by_word is not None


def test_a_frame_of_an_earlier_pass_is_found_wherever_one_begins(file):
    with Recording(file) as recording:
        whole = [one.snapshot for one in recording.passes()]
    for number in range(PASSES):
        with Recording(file) as recording:
            alone = recording.at(number).snapshot
        due = whole[number]
        assert [frame.camera for frame in alone.frames] == [frame.camera for frame in due.frames]
        for frame, other in zip(alone.frames, due.frames, strict=True):
            assert frame.depth_m.tobytes() == other.depth_m.tobytes()


def test_cycles_are_found_by_their_number(file):
    with Recording(file) as recording:
        assert [recording.number_of(sequence) for sequence in (0, 5, 11)] == [0, 5, 11]
        with pytest.raises(BagError, match="cycle 12 is not there; cycles are 0 to 11"):
            recording.number_of(12)


def test_a_file_that_is_cut_off_is_judged_up_to_there(file):
    content = sample_run()
    file.write_bytes(content[: len(content) // 2])
    with Recording(file) as recording:
        assert recording.note is not None and 0 < len(recording) < PASSES
        assert not any(one.differences for one in replayed(recording))


def test_the_configuration_comes_back_as_it_was(file):
    with Recording(file) as recording:
        configuration = recording.configuration()
    site, said = configuration.attached()
    assert Configuration.read(said.data, site.data, "it").attached() == [site, said]
    assert (site.name, said.name) == (SITE, CONFIGURATION)


def test_a_configuration_of_the_format_before_is_read(file):
    with Recording(file) as recording:
        site, said = recording.configuration().attached()
    before = json.dumps(json.loads(said.data) | {"format": 1}).encode()
    assert Configuration.read(before, site.data, "it").attached() == [site, said]


def value_of(said, name, value):
    """Gives a field of the cycle another value."""
    for pair in said["values"]["map"]:
        if pair[0] == name:
            pair[1] = value


@pytest.mark.parametrize(
    "change",
    [
        lambda said: said.pop("values"),
        lambda said: said.update(format=3),
        lambda said: said.update(format=0),
        lambda said: said.update(format="1"),
        lambda said: said.update(values=[]),
        lambda said: said.update(told=[]),
        lambda said: said.update(values={"map": 3}),
        lambda said: value_of(said, "grid", None),
        lambda said: value_of(said, "cameras", [1]),
        lambda said: value_of(said, "machine", "a machine"),
        lambda said: value_of(said, "terms", {"of": "VoxelGrid", "fields": {}}),
        lambda said: value_of(said, "motions", [["larm", 1]]),
        lambda said: said["values"]["map"].append(["clock_ns", 3]),
    ],
)
def test_a_configuration_that_is_malformed_is_an_error(file, change):
    with Recording(file) as recording:
        said = json.loads(recording.configuration().attached()[1].data)
    change(said)
    with pytest.raises(BagError, match=r"it: configuration\.json"):
        Configuration.read(json.dumps(said).encode(), b"", "it")


@pytest.mark.parametrize(
    "change",
    [
        lambda said: said.update(sequence=10**400, lost=math.inf),
        lambda said: said.update(wall_ns=math.inf),
        lambda said: said["given"].update(joints={"long": 10**400}),
        lambda said: said["given"].update(commanded={"long": -(10**400)}),
        lambda said: said["given"]["velocities"].update(long=10**400),
        lambda said: said["given"]["joints_of"].update(cam00={"long": 10**400}),
        lambda said: said["given"].update(joints={"long": nested(900)}),
        lambda said: said["given"].update(path={"long": 1}),
    ],
)
def test_a_pass_whose_numbers_are_none_is_an_error(file, monkeypatch, change):
    with Recording(file) as recording:
        said, messages = recording._told(0)
        change(said)
        monkeypatch.setattr(Recording, "_told", lambda self, number: (said, messages))
        with pytest.raises(BagError, match="pass 0: malformed"):
            recording.at(0)


def nested(deep):
    return [] if deep == 0 else [nested(deep - 1)]


def test_margins_whose_numbers_are_none_are_an_error(file):
    with Recording(file) as recording:
        configuration = recording.configuration()
    assert configuration.figures() is not None
    configuration.told["separation"]["look_m"] = 10**400
    with pytest.raises(BagError, match="malformed: separation"):
        configuration.figures()


@SHARED
@given(data=st.data())
def test_a_damaged_recording_is_an_error_or_is_read(tmp_path, data):
    content = bytearray(sample_run())
    for at in data.draw(st.lists(st.integers(0, len(content) - 1), min_size=1, max_size=8)):
        content[at] ^= 1 << data.draw(st.integers(0, 7))
    (tmp_path / "run.mcap").write_bytes(content)
    try:
        with Recording(tmp_path / "run.mcap") as recording:
            assert recording.wrong() is not None or recording.note is not None or content == sample_run()
            recording.configuration()
            assert len(list(recording.passes())) == len(recording)
    except ElbowroomError as error:
        assert str(error)


def test_images_come_out_as_they_were_or_never_farther(file, tmp_path):
    with Recording(file) as recording, Export(recording, tmp_path / "out", 0.0002) as export:
        for one in recording.passes():
            export.add(one)
            for frame in one.snapshot.frames:
                path = tmp_path / "out" / frame.camera / f"{frame.stamp_ns}.png"
                units = np.asarray(Image.open(path)).astype(float)
                seen = np.isfinite(frame.depth_m) & (frame.depth_m > 0) & (frame.depth_m < 13)
                assert (units[seen] * 0.0002 <= frame.depth_m[seen] + 1e-6).all()
                assert (frame.depth_m[seen] - units[seen] * 0.0002 < 0.0003).all()
    cameras = json.loads((tmp_path / "out" / "cameras.json").read_text())
    assert [camera["name"] for camera in cameras] == [f"cam{n:02d}" for n in range(5)]
    assert (tmp_path / "out" / "joints.csv").read_text().startswith("stamp_ns,long,larm")


def test_cameras_that_were_left_out_are_left_out_again(file):
    with Recording(file) as recording:
        configuration = recording.configuration()
        cycle, figures = configuration.cycle(), configuration.figures()
        one = recording.at(4)
        assert compared(one, cycle, figures).differences == ()
        one.judged["given"] = one.judged["given"][1:]
        assert any(text.startswith("space: was ") for text in compared(one, cycle, figures).differences)


def test_a_pass_in_which_nothing_was_judged_is_stop_by_word(file):
    stop = {"level": "stop", "band": "S", "free_travel": 0.0, "cause": "input", "overridable": False}
    empty = dict.fromkeys(("link", "place_m", "other_link", "zone", "creep"))
    empty |= {"escapes": False, "safe_speed": 0.0}
    with Recording(file) as recording:
        configuration = recording.configuration()
        cycle, figures = configuration.cycle(), configuration.figures()
        one = replace(recording.at(4), margins=None)
        one.judged.update(given=None, space=None, skew_ms=None, distances=None)
        one.judged["stopped_by"] = "joints: not where they may be"
        for verdict in one.judged["verdicts"]:
            verdict.update(stop | empty)
        found = compared(one, cycle, figures)
        assert found.differences == () and found.by_word == "joints: not where they may be"
        one.judged["verdicts"][0]["level"] = "clear"
        assert compared(one, cycle, figures).differences


def test_distances_and_margins_are_kept_and_compared(file):
    with Recording(file) as recording:
        configuration = recording.configuration()
        cycle, figures = configuration.cycle(), configuration.figures()
        passes = [one for one in recording.passes() if one.margins is not None]
        assert len(passes) > PASSES // 2 and all(one.judged["distances"]["links"] for one in passes)
        assert any(one.margins["standing_margin_m"] is not None for one in passes)
        one = passes[-1]
        assert compared(one, cycle, figures).differences == ()
        assert compared(one, cycle).differences == ("margins: were kept, and cannot be computed",)
        one.margins["person_margin_m"] += 2**-50
        (told,) = compared(one, cycle, figures).differences
        assert told.startswith("margins: person_margin_m was ")
        one.judged["distances"]["links"][0]["seen"]["distance_m"] += 2**-50
        assert compared(one, cycle, figures).differences[0].startswith("distances: was ")


def test_a_recording_of_a_version_that_kept_no_distances_is_judged_as_before(file):
    with Recording(file) as recording:
        cycle = recording.configuration().cycle()
        for one in recording.passes():
            del one.judged["distances"]
            assert compared(replace(one, margins=None), cycle).differences == ()
