"""The page in a real browser, by clicks: a run, why, what is old, a browser without WebGL, a recording."""

import os
import signal
import threading
import time
from pathlib import Path

import pytest

from elbowroom.monitor.blackbox.recording import Recording
from elbowroom.page.page import Page
from elbowroom.page.replay.again import Judge
from elbowroom.page.replay.replayed import Replayed, extra_of
from elbowroom.page.replay.stops import stops_of
from elbowroom.page.words import words_of
from reference.browser import NO_WEBGL, SOFTWARE_WEBGL, browsers, is_drawn, serious, tab
from reference.page_runs import told_page
from reference.sample_run import PASSES, sample_run


@pytest.fixture(scope="module")
def browser():
    with browsers() as opened:
        yield opened


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    with told_page(tmp_path_factory.mktemp("run")) as told:
        yield told


@pytest.fixture
def page(browser):
    """A tab of a browser without WebGL, which is light."""
    yield from tab(browser(*NO_WEBGL))


@pytest.fixture
def drawn_page(browser):
    """A tab of a browser that draws."""
    yield from tab(browser(*SOFTWARE_WEBGL), 760, 560)


def test_a_run_is_seen_and_a_click_says_why(drawn_page, run):
    page = drawn_page
    page.goto(run.url)
    page.wait_for_selector("body:not(.waiting)")
    page.wait_for_selector("#scene[data-drawn=yes]")
    assert page.locator("#motions tbody tr").count() == 4
    assert page.inner_text("#sentence") and page.inner_text("#word") in page.content()
    until = time.monotonic() + 20
    while not is_drawn(page) and time.monotonic() < until:
        time.sleep(0.3)
    assert is_drawn(page)
    page.click("#motions tbody tr:nth-child(1) button")
    page.wait_for_selector("#why[data-final=true]")
    assert "long +" in page.inner_text("#whysentence")


def test_what_is_old_greys_and_says_how_old(page, run):
    page.goto(run.url)
    page.wait_for_selector("body:not(.waiting):not(.old)")
    run.pauses.set()
    try:
        page.wait_for_selector("body.old")
        assert "s old" in page.inner_text("#old")
        assert "grayscale" in page.evaluate("getComputedStyle(document.querySelector('main')).filter")
    finally:
        run.pauses.clear()
    page.wait_for_selector("body:not(.old)")


def test_without_webgl_there_are_tables_and_a_sentence(page, run):
    page.goto(run.url)
    page.wait_for_selector("#scene[data-drawn=no]")
    assert "no WebGL" in page.inner_text("#noscene")
    page.wait_for_selector("body:not(.waiting)")
    assert page.locator("#motions tbody .chip").first.inner_text()
    page.click("#motions tbody tr:nth-child(1) button")
    page.wait_for_selector("#why[data-final=true]")
    page.click("#cameras tbody tr:nth-child(1) button")
    page.wait_for_selector("#depth:not([hidden]) img[src^='data:image/png']")
    assert serious(page) == []


def test_a_page_whose_process_died_is_old_and_the_run_goes_on(page, run):
    page.goto(run.url)
    page.wait_for_selector("body:not(.waiting):not(.old)")
    os.kill(run.page.pid, signal.SIGKILL)
    # old by its age first, then for want of a connection
    page.wait_for_selector("body.old #old:has-text('No connection')")
    before = run.passes
    time.sleep(1.0)
    assert run.passes > before and run.page.face.fault is None
    assert any("ended by itself" in line for line in run.page.troubles)


@pytest.fixture
def recording(tmp_path: Path):
    """A page over a recording that was cut off, and where it is."""
    whole = sample_run()
    path = tmp_path / "run.mcap"
    path.write_bytes(whole[: len(whole) * 9 // 10])
    over = threading.Event()
    with Recording(path) as file:
        configuration, words = file.configuration(), words_of("en")
        extra = extra_of(list(stops_of(file)), len(file), file.note, words)
        page = Page(configuration, words, "replay", extra)
        page.open(0)
        feed = Replayed(page, Judge(file, configuration), over.is_set)
        thread = threading.Thread(target=feed.run)
        thread.start()
        try:
            yield page, len(file)
        finally:
            over.set()
            thread.join()
            page.server.stop()


def test_a_recording_is_stepped_played_and_asked(page, recording):
    shown, count = recording
    assert 1 < count < PASSES
    page.goto(shown.server.url)
    page.wait_for_selector("body:not(.waiting)")
    assert "cut off" in page.inner_text("#note")
    page.wait_for_selector("#at:has-text('cycle 0,')")
    page.click("#forth")
    page.wait_for_selector("#at:has-text('cycle 1,')")
    page.focus("#slider")
    page.keyboard.press("End")
    page.wait_for_selector(f"#at:has-text('cycle {count - 1},')")
    page.click("#motions tbody tr:nth-child(1) button")
    page.wait_for_selector("#why[data-final=true]")
    page.click("#play")
    page.wait_for_selector("#play:has-text('Pause')")
    page.wait_for_selector(f"#at:has-text('cycle {count - 1},')")
    page.wait_for_selector("#play:has-text('Play')")
    assert serious(page) == []
