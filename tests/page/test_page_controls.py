"""Reset and hold-to-override on the page, by clicks, with the real service and gate."""

import re
import time
from itertools import pairwise
from pathlib import Path

import pytest

from elbowroom.guard.control import ask
from reference.browser import NO_WEBGL, browsers, serious, tab
from reference.page_controls import PASS_S, controlled_page

pytest.importorskip("h11")
COUNTS_S = 0.2
"""A held signal counts for so long."""


@pytest.fixture(scope="module")
def browser():
    with browsers() as opened:
        yield opened


@pytest.fixture(scope="module")
def run():
    with controlled_page() as running:
        yield running


@pytest.fixture
def page(browser, run):
    run.failing = False
    run.until(lambda: len(run.held) > 2)
    ask(run.gate.folder, "reset")  # the first run wants one, and so does one after silence
    for made in tab(browser(*NO_WEBGL)):
        made.goto(run.url)
        made.wait_for_selector("#controls:not([hidden])")
        made.wait_for_selector("#use:not([disabled])")
        yield made


def give(page, token: str) -> None:
    page.fill("#token", token)
    page.click("#use")


def said(page, text: str) -> None:
    page.wait_for_selector(f"#controlsaid:has-text({text!r})")


def hold(page, run) -> None:
    """Presses the button until the machine creeps, and goes on pressing it."""
    page.hover("#hold")
    page.mouse.down()
    run.until(lambda: run.creeps)


def ends_in_time(run, since_s: float) -> bool:
    """Whether nothing creeps any more once the last signal before a moment has ceased to count.

    A signal may be on its way at that moment, for no longer than a pass takes: on a loaded computer that is more.
    """
    run.until(lambda: not run.creeps)
    time.sleep(0.5)
    crept = [at_s for at_s, is_held in run.held if is_held and at_s > since_s]
    times = [at_s for at_s, _ in run.held if at_s > since_s - COUNTS_S]
    longest_s = max((later - at_s for at_s, later in pairwise(times)), default=0.0)
    return max(crept, default=since_s) - since_s <= COUNTS_S + max(PASS_S, longest_s)


def test_a_reset_is_asked_refused_and_done_in_words(page, run):
    give(page, run.token)
    assert page.input_value("#token") == ""
    run.until(lambda: run.held)
    run.failing = True
    page.wait_for_selector("#gatesaid:has-text('a fault is there')")
    page.click("#reset")
    said(page, "what stopped is still there")
    assert "made to fail" in page.inner_text("#controlsaid")
    run.failing = False
    page.wait_for_selector("#gatesaid:has-text('a person has to reset')")
    page.click("#reset")
    said(page, "Reset: the machine stays stopped")
    page.wait_for_selector("#gatesaid:has-text('verdicts decide')")
    page.click("#reset")
    said(page, "nothing is latched")
    assert serious(page) == []


def test_a_wrong_token_resets_nothing_and_is_forgotten(page, run):
    before = len(run.resets)
    give(page, "short")
    said(page, "no token")
    give(page, "0" * 64)
    page.click("#reset")
    said(page, "the token is wrong")
    assert page.is_visible("#token") and not page.is_visible("#reset")
    assert len(run.resets) == before


def test_it_creeps_while_the_button_is_pressed_and_no_longer(page, run):
    give(page, run.token)
    hold(page, run)
    said(page, "These may creep: long +")
    time.sleep(0.6)  # longer than a signal counts
    assert run.creeps
    page.mouse.up()
    assert ends_in_time(run, time.monotonic())
    said(page, "Let go")
    page.focus("#hold")
    page.keyboard.down("Space")
    run.until(lambda: run.creeps)
    page.keyboard.up("Space")
    assert ends_in_time(run, time.monotonic())


def test_the_page_may_ask_by_each_of_its_names(page, run):
    page.goto(run.url.replace("127.0.0.1", "localhost"))
    page.wait_for_selector("#use:visible:not([disabled])")
    give(page, run.token)
    hold(page, run)
    page.mouse.up()


def test_it_ends_when_the_tab_closes(page, run, browser):
    give(page, run.token)
    hold(page, run)
    page.close()
    assert ends_in_time(run, time.monotonic())


def test_it_ends_when_the_connection_is_lost_and_when_what_is_shown_is_old(page, run):
    give(page, run.token)
    hold(page, run)
    page.context.set_offline(True)
    assert ends_in_time(run, time.monotonic())
    page.mouse.up()
    said(page, "does not answer")
    page.context.set_offline(False)
    if not page.is_visible("#hold"):  # it may have been away for so long that the token was forgotten
        page.wait_for_selector("#use:visible")
        give(page, run.token)
    hold(page, run)
    with run.standing():
        page.wait_for_selector("body.old")
        said(page, "what is shown is old")
        assert page.is_disabled("#hold") and page.is_disabled("#reset")
    page.mouse.up()


def test_the_token_is_nowhere_but_in_the_tab(page, run):
    give(page, run.token)
    page.click("#reset")
    page.locator("#controlsaid", has_text=re.compile("latched|Reset:")).wait_for()
    kept = page.evaluate(
        "JSON.stringify([{...localStorage}, {...sessionStorage}, document.cookie, location.href])"
    )
    assert run.token not in kept and run.token not in page.content()
    memory = (
        Path(f"/proc/{run.page.pid}/environ").read_bytes()
        + Path(f"/proc/{run.page.pid}/cmdline").read_bytes()
    )
    assert run.token.encode() not in memory
    assert run.token not in (run.page._folder / "page.log").read_text()
    assert not any(run.token.encode() in page_bytes for page_bytes in _memory_of(run.page.pid))
    page.reload()
    page.wait_for_selector("#controls:not([hidden])")
    assert page.is_visible("#token") and page.input_value("#token") == ""


def _memory_of(pid: int):
    """What a process holds in memory that can be written, piece by piece."""
    of = Path(f"/proc/{pid}")
    with (of / "maps").open() as maps, (of / "mem").open("rb", buffering=0) as memory:
        for line in maps:
            span, rights = line.split()[:2]
            begin, end = (int(n, 16) for n in span.split("-"))
            if rights.startswith("rw") and end - begin < 1 << 28:
                try:
                    memory.seek(begin)
                    yield memory.read(end - begin)
                except (OSError, ValueError, OverflowError):
                    continue


def test_without_a_service_there_are_no_controls(page, run):
    give(page, run.token)
    hold(page, run)
    run.serving._process.kill()
    assert ends_in_time(run, time.monotonic())
    page.wait_for_selector("#controls[hidden]", state="attached")
    page.mouse.up()
    with run.standing():
        run.serving._kill()
        run.serving.start()
    page.wait_for_selector("#controls:not([hidden])")
    assert page.is_visible("#token")
