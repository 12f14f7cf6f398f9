"""The report of a stop: a file that opens without network, is asked by clicks, and holds what decided."""

import json
import re
import zlib
from base64 import b64decode

import numpy as np
import pytest

from elbowroom.cli import run
from elbowroom.errors import InputError
from elbowroom.monitor.blackbox.recording import Recording
from elbowroom.page.replay.again import Judge
from elbowroom.page.report.packed import Pack, steps_of
from elbowroom.page.report.span import at_stop, at_time, span_of
from elbowroom.page.report.written import MOST_BYTES, write_report
from elbowroom.page.telling import clock
from elbowroom.page.words import words_of
from reference.browser import SOFTWARE_WEBGL, browsers, is_drawn, pixels_of, serious, tab
from reference.colour import APART, lab
from reference.sample_run import PASSES, sample_run

DEFICIENCIES = ("none", "protanopia", "deuteranopia", "tritanopia")


@pytest.fixture(scope="module")
def recording(tmp_path_factory):
    path = tmp_path_factory.mktemp("report") / "run.mcap"
    path.write_bytes(sample_run())
    with Recording(path) as opened:
        yield opened


@pytest.fixture(scope="module")
def report(recording, tmp_path_factory):
    path = tmp_path_factory.mktemp("report") / "incident.html"
    span = span_of(recording, 6, 60.0)
    written = write_report(path, Judge(recording, recording.configuration()), span, words_of("en"))
    assert (
        written.cycles == PASSES and written.drawn >= 1 and written.size == path.stat().st_size < MOST_BYTES
    )
    return path


def values_of(path) -> dict:
    """What a report holds, as JSON."""
    packed = re.search(r'id="data">([^<]*)<', path.read_text()).group(1)
    whole = zlib.decompress(b64decode(packed))
    length = int.from_bytes(whole[:4], "little")
    return json.loads(whole[4 : 4 + length])


def test_it_holds_the_sum_the_configuration_and_each_moment(report, recording):
    values = values_of(report)
    text = "\n".join(values["facts"])
    assert recording.sum in text and "elbowroom" in text
    assert values["site_file"] == recording.configuration().site_text.decode()
    assert [one["sequence"] for one in values["moments"]] == [recording.at(n).sequence for n in range(PASSES)]
    about = values["moments"][values["about"]]
    assert "near" in about and "depth" in about and len(about["motions"]) == 8
    assert "http" not in re.sub(r"http://www.w3.org\S*", "", report.read_text().partition('id="data"')[0])


@pytest.fixture
def page():
    with browsers() as opened:
        yield from tab(opened(*SOFTWARE_WEBGL), 1000, 700)


def test_it_is_opened_without_network_and_asked_and_every_eye_tells_its_colours_apart(report, page):
    asked = []
    page.context.set_offline(True)
    page.on("request", lambda request: asked.append(request.url))
    page.goto(report.as_uri())
    page.wait_for_selector("#scene[data-drawn=yes]")
    assert asked == [report.as_uri()]
    assert is_drawn(page)
    page.click("#motions tbody tr:nth-child(1) button")
    page.wait_for_selector("#why[data-final=true]")
    before = page.inner_text("#at")
    page.click("#forth")
    assert page.inner_text("#at") != before
    page.click("#cameras tbody tr:nth-child(1) button")
    page.wait_for_selector("#depth:not([hidden])")
    assert serious(page) == []
    # what a person sees who lacks one kind of cones, taken from the screen
    session = page.context.new_cdp_session(page)
    for deficiency in DEFICIENCIES:
        session.send("Emulation.setEmulatedVisionDeficiency", {"type": deficiency})
        shown = [pixels_of(one)[6, 6] for one in page.locator("#legend i").all()[:8]]
        seen = [lab(colour, np.eye(3)) for colour in shown]
        least = min(np.linalg.norm(a - b) for n, a in enumerate(seen) for b in seen[:n])
        assert least > 0.8 * APART, (deficiency, shown)


def test_a_span_is_about_a_moment_by_time_or_stop(recording):
    span = span_of(recording, 6, 0.2)
    assert 0 <= span.first <= 6 <= span.last < PASSES
    when = clock(recording.said_at(5)["wall_ns"] + 100_000_000)
    found = at_time(recording, when)
    assert recording.said_at(found)["wall_ns"] <= recording.said_at(5)["wall_ns"] + 200_000_000
    for wrong in ("12", "25:00:00", "a:b:c", "00:00:00.0" if not when.startswith("00:00") else "12:00:00"):
        with pytest.raises(InputError, match="at: "):
            at_time(recording, wrong)
    assert at_stop([], None) == 0
    with pytest.raises(InputError, match="has 0 stops"):
        at_stop([], 1)


def test_steps_and_arrays_come_out_as_they_went_in():
    index = np.array([[1, 2, 3], [0, 0, 1], [4, 4, 4]], dtype=np.int32)
    numbers = np.cumsum(steps_of(index, (5, 6, 7)))
    assert sorted(numbers) == sorted((index[:, 0] * 6 + index[:, 1]) * 7 + index[:, 2])
    pack = Pack()
    given = [np.array([1, -2, 3], dtype=np.int16), np.array([0.5], dtype=np.float32)]
    assert [pack.add(one) for one in given] == [0, 1]
    whole = zlib.decompress(b64decode(pack.text({"a": "ä"})))
    length = int.from_bytes(whole[:4], "little")
    head = json.loads(whole[4 : 4 + length])
    assert head["a"] == "ä" and length % 4 == 0
    for one, (kind, at, size) in zip(given, head["arrays"], strict=True):
        np.testing.assert_array_equal(np.frombuffer(whole, kind, size, 4 + length + at), one)


def test_a_recording_that_is_cut_off_is_reported_up_to_the_cut(tmp_path, capsys):
    whole = sample_run()
    (tmp_path / "run.mcap").write_bytes(whole[: len(whole) * 3 // 4])
    out = tmp_path / "incident.html"
    assert run(["export", str(tmp_path / "run.mcap"), "--report", str(out), "--language", "de"]) == 0
    values = values_of(out)
    assert "abgeschnitten" in values["hello"]["note"] and 0 < len(values["moments"]) < PASSES
    assert "written:" in capsys.readouterr().out
    assert run(["export", str(tmp_path / "run.mcap")]) != 0
    assert (
        run(["export", str(tmp_path / "run.mcap"), "--report", str(out), "--stop", "1", "--at", "1:2:3"]) != 0
    )
