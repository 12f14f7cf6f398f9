"""What operators read: no more travel than there is, a word and a shape for each level, faults and limits."""

import io
import math
import re
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from rich.console import Console

from elbowroom.finding import Finding
from elbowroom.geometry import VoxelGrid
from elbowroom.monitor import CameraHealth, Condition, CycleResult, Health, LinkHealth, Pass, Shift
from elbowroom.monitor.health.streams.cause import HealthCause, Sick
from elbowroom.motion import Cause, Level, Motion, Verdict
from elbowroom.sensing import Snapshot
from elbowroom.view.screen.run_log import RunLog
from elbowroom.view.screen.terminal import STYLES, TerminalView
from elbowroom.view.screen.watched import Watched
from elbowroom.view.screen.words import (
    LEVEL_WORDS,
    MARKS,
    NOT_CERTIFIED,
    health_text,
    plain_line,
    travel_bar,
    travel_text,
)

GRID = VoxelGrid(origin_m=(-2, -2, 0), shape=(80, 80, 50), voxel_size_m=0.05)
WATCHED = Watched("a room", GRID, "21 cameras 64x48", "three", "pixel", "simulator", ("rail", "carriage"))
PLACE = (0.314, -0.2, 1.05)
VERDICTS = (
    Verdict(Motion("long", +1, 0.0375), Level.STOP, 0.0329, "m", "detector", PLACE, Cause.SURFACE),
    Verdict(Motion("long", -1, 0.0375), Level.CLEAR, 0.1875, "m", None, None, Cause.NONE),
    Verdict(Motion("larm", +1, 0.0524), Level.DECELERATE, 0.0999, "rad", "source", PLACE, Cause.UNSEEN),
    Verdict(Motion("larm", -1, 0.0524), Level.CLEAR, 0.01, "rad", None, None, Cause.NONE),
)


def a_result(fault: str | None = None) -> CycleResult:
    return CycleResult(7, 3_200_000_000, None, VERDICTS, {"reconstruct": 30.0, "motion": 5.0}, 12.0, fault)


def a_pass(result: CycleResult) -> Pass:
    return Pass(Snapshot(()), result, 33.0)


def shown(width: int, fault: str | None = None, *, terminal: bool = True) -> str:
    console = Console(file=io.StringIO(), width=width, force_terminal=terminal, color_system=None)
    with TerminalView(console) as view:
        view.open(WATCHED)
        view.show(a_pass(a_result(fault)))
    view.end()
    return console.file.getvalue()


@given(st.floats(0, 10), st.sampled_from(["m", "rad"]))
def test_shown_travel_is_never_more_than_the_verdict(distance, unit):
    number, mark = travel_text(distance, unit).replace("°", " °").split()
    factor = {"mm": 1e-3, "cm": 1e-2, "°": math.pi / 180}[mark]
    assert float(number) * factor <= distance + 1e-8
    assert float(number) * factor >= distance - 0.0101


@pytest.mark.parametrize(
    ("distance", "unit", "text"),
    [
        (0.062, "m", "62 mm"),
        (1.239, "m", "123 cm"),
        (math.radians(3.4), "rad", "3.4°"),
        (0.0, "rad", "0.0°"),
        (0.5, "m or rad", "0.500 m or rad"),
    ],
)
def test_travel_is_written_in_the_unit_of_its_joint(distance, unit, text):
    assert travel_text(distance, unit) == text


@given(st.floats(0, 6))
def test_bar_fills_with_the_travel_and_keeps_its_width(braking_distances):
    verdict = Verdict(Motion("j", 1, 0.1), Level.STOP, braking_distances * 0.1, "m", None, None, Cause.NONE)
    filled, rest = travel_bar(verdict)
    assert len(filled) + len(rest) == 20
    assert len(filled) == min(20, math.floor(braking_distances * 4 + 1e-5))


def test_bar_marks_where_the_braking_distances_end():
    nothing_free = Verdict(Motion("j", 1, 0.1), Level.STOP, 0.0, "m", None, None, Cause.NONE)
    assert travel_bar(nothing_free)[1] == "···│···│············"


def test_levels_differ_in_word_and_in_shape():
    assert len(set(MARKS.values())) == len(set(LEVEL_WORDS.values())) == len(Level)


@pytest.mark.parametrize("width", [80, 100, 120])
def test_screen_says_all_that_it_must(width):
    text = shown(width)
    for words in ("STOP", "32 mm", "surface", "detector", "≥ 187 mm", "5.7°", "unseen", "21 cameras 64x48"):
        assert words in text, words
    assert "joint limit" in text
    assert "rail, carriage" in text
    assert "Not a certified safety function" in " ".join(text.split())
    assert "simulator apart: 33 ms" in " ".join(text.split())


def test_screen_fits_its_width():
    printed = re.sub(r"\x1b\[[0-9;?]*[A-Za-z]", "\n", shown(80))
    assert max(len(line) for line in printed.splitlines()) <= 80


@pytest.mark.parametrize("terminal", [True, False])
def test_a_fault_is_shown_with_its_reason(terminal):
    assert "FrameError: cam07 is too small" in shown(120, "FrameError: cam07 is too small", terminal=terminal)


def test_without_a_terminal_there_are_plain_lines_and_a_summary():
    text = shown(80, terminal=False)
    assert "\x1b" not in text
    assert (
        "long + STOP 32 mm (surface, detector) | long - CLEAR | larm + DECELERATE 5.7° (unseen, source)"
        in text
    )
    assert NOT_CERTIFIED.split(":")[0] in text


def test_plain_lines_come_about_once_a_second():
    console = Console(file=io.StringIO(), width=200, force_terminal=False)
    with TerminalView(console) as view:
        view.open(WATCHED)
        for _ in range(50):
            view.show(a_pass(a_result()))
    assert console.file.getvalue().count("long + STOP") == 1
    assert view.log.cycles == 50


def test_a_clear_motion_needs_no_distance_in_a_plain_line():
    assert plain_line(VERDICTS[1]) == "long - CLEAR"


def test_log_counts_levels_faults_and_times():
    log = RunLog("simulator", ("rail",), ("logo",))
    for fault in (None, "late", "late"):
        log.add(a_result(fault), 20.0)
    assert log.cycles == 3
    assert log.levels["long +"][Level.STOP] == 3
    assert log.faults["late"] == 2
    assert log.recent_stage_ms == {"reconstruct": 30.0, "motion": 5.0}
    assert log.recent(log.age_ms) == 47.0
    console = Console(file=io.StringIO(), width=100)
    console.print(log.summary())
    for words in (
        "3 cycles",
        "100%",
        "late",
        "rail",
        "simulator",
        "Without a body, by the site's word: logo",
        "Not a certified",
    ):
        assert words in console.file.getvalue(), words


def test_an_empty_log_says_that_there_was_no_verdict():
    console = Console(file=io.StringIO(), width=100)
    console.print(RunLog().summary())
    assert "no verdict" in console.file.getvalue()
    assert RunLog().rate_hz == 0
    assert np.isnan(RunLog().recent([]))


def of_health(stops: dict[str, str], condition: Condition = Condition.STILL) -> CycleResult:
    shift = Shift(np.radians([0.0, 0.9, 0.0]), np.zeros(3), np.diag([1e-8] * 3 + [1e-6] * 3))
    cameras = (
        CameraHealth("cam03", condition, shift, 0.9, 0.05),
        CameraHealth("cam04", Condition.SILENT, None, 0.0, 1.0),
    )
    health = Health(cameras, (LinkHealth("l_arm", 0.031, ("a", "b", "c"), True),), stops)
    return CycleResult(7, 3_200_000_000, None, VERDICTS, {"watch": 3.0}, 12.0, None, health)


def test_the_health_line_says_how_cameras_and_machine_are():
    text = health_text(of_health({}).health)
    assert "1 of 2 cameras stand still" in text and "1 silent" in text
    assert "cam03 by 0.90°" in text and "l_arm" in text and "31 mm" in text
    assert "unnoticed" in health_text(None)
    hidden = of_health({}, Condition.HIDDEN).health
    assert "1 hidden (cam03 5 %), 1 silent (cam04)" in health_text(hidden)


@pytest.mark.parametrize("terminal", [True, False])
def test_a_stop_of_the_watch_is_shown_with_its_reason_and_stays_in_the_summary(terminal):
    console = Console(file=io.StringIO(), width=140, force_terminal=terminal, color_system=None)
    with TerminalView(console) as view:
        view.open(WATCHED)
        view.show(a_pass(of_health({"cam03": "camera cam03 has turned by 0.9 degrees"})))
    assert "camera cam03 has turned by 0.9 degrees" in console.file.getvalue()
    view.end()
    assert "Every motion was stopped: camera cam03 has turned" in console.file.getvalue()


def test_a_run_without_a_watch_says_so():
    assert "were not watched" in shown(120)


def test_the_age_is_that_of_when_the_verdicts_are_out():
    assert " cycle 35 ms age 47 ms " in shown(120, terminal=False)


def test_a_pass_that_came_too_late_is_said_and_its_age_shown():
    late = replace(a_result(), late="its verdicts are out when the oldest image is 47 ms old")
    for terminal in (True, False):
        console = Console(file=io.StringIO(), width=120, force_terminal=terminal, color_system=None)
        view = TerminalView(console)
        view.open(WATCHED)
        view.show(a_pass(late))
        view.end()
        said = console.file.getvalue()
        assert late.late in said and "47 ms" in said
        assert "1 of 1 cycles said stop, as images were past max_frame_age_ms" in said
        assert view.log.row()["late"] == 1


def test_the_age_turns_red_where_it_is_past_its_limit():
    console = Console(file=io.StringIO(), width=120, force_terminal=True, color_system="truecolor")
    with TerminalView(console) as view:
        view.open(WATCHED)
        view.log.add(a_result(), 1.0)
        for result, red in ((a_result(), False), (replace(a_result(), late="late"), True)):
            spans = [span.style for span in view._speed(result).spans]
            assert (str(STYLES[Level.STOP]) in map(str, spans)) is red


def test_what_was_found_about_the_input_is_shown():
    mild = Finding("gap", (), "nothing was recorded for 60 min", False)
    grave = Finding("skew", ("north",), "camera north is 2 s behind", True)
    found = replace(a_result(), findings=(mild, grave))
    for terminal in (True, False):
        console = Console(file=io.StringIO(), width=120, force_terminal=terminal, color_system=None)
        view = TerminalView(console)
        view.open(WATCHED)
        for _ in range(3):
            view.show(a_pass(found))
        said = console.file.getvalue()
        view.end()
        assert mild.text in said and grave.text in said
        assert terminal or said.count(mild.text) == 1


@pytest.mark.parametrize("terminal", [True, False])
def test_what_is_sick_is_shown_with_what_ends_it_and_stays_in_the_summary(terminal):
    text = "camera cam03 gives the image before again"
    sick = Sick(
        HealthCause.CAMERA_FROZEN, "cam03", text, "3 images in a row that are not the one before", 2.0
    )
    console = Console(file=io.StringIO(), width=140, force_terminal=terminal, color_system=None)
    view = TerminalView(console)
    view.open(WATCHED)
    view.show(a_pass(replace(a_result(), sick=(sick,), blind="no camera gives anything that counts")))
    view.end()
    said = console.file.getvalue()
    assert f"Left out: {text} (until 3 images" in said
    assert "no camera gives anything that counts" in said
    assert "cam03: frozen in 1 of 1 cycles" in said
