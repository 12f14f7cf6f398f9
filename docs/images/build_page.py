"""Takes the pictures of docs/page.md from the page itself: python docs/images/build_page.py

It needs Chromium, playwright and the extra `page`. The simulated room is judged at moments of its own, and no time goes
by in a pass, so that the pictures do not hang on how fast this computer is.
"""

import io
import os
import shutil
import signal
import socket
import threading
import time
from collections.abc import Iterator
from contextlib import chdir, contextmanager
from dataclasses import replace
from itertools import chain, repeat
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from PIL import Image

from elbowroom.evaluate.page.picture import FLAGS
from elbowroom.monitor import Pass
from elbowroom.monitor.blackbox.configuration import plain_cycle
from elbowroom.monitor.blackbox.recorder import Recorder
from elbowroom.monitor.blackbox.recording import Recording
from elbowroom.monitor.blackbox.sinks import WholeRun
from elbowroom.monitor.gate.gate import Gate
from elbowroom.monitor.gate.state import Rules
from elbowroom.monitor.serving import Serving
from elbowroom.motion import Level
from elbowroom.page.opened import OpenedPage
from elbowroom.page.page import Page
from elbowroom.page.replay.again import Judge
from elbowroom.page.replay.replayed import Replayed, extra_of
from elbowroom.page.replay.stops import stops_of
from elbowroom.page.report.span import span_of
from elbowroom.page.report.written import write_report
from elbowroom.page.words import words_of
from elbowroom.service.token import made_token
from elbowroom.site import Site
from elbowroom.sources import Room, open_room
from elbowroom.sources.simulated import Simulated

HERE = Path(__file__).resolve().parent
TIMES_S = [0.5 + 0.1 * n for n in range(60)]
WIDTH, HEIGHT = 1280, 860
AROUND = 24
"""So many passes about the stop that is looked for are shown."""


def main() -> None:
    """Judges the room, then looks at it."""
    room = open_room(Site.simulated_room())
    passes, about = judged(room)
    with TemporaryDirectory() as folder, browser() as tab:
        live(room, passes, tab)
        path = Path(folder) / "run.mcap"
        record(room, passes, path)
        with Recording(path) as recording:
            replayed(recording, about, tab)
            report = Path(folder) / "incident.html"
            judge = Judge(recording, recording.configuration())
            write_report(report, judge, span_of(recording, about, 20.0), words_of("en"))
            tab.goto(report.as_uri())
            tab.wait_for_selector("#scene[data-drawn=yes]")
            settle(tab)
            keep(tab, "page_report")


def judged(room: Room) -> tuple[list[Pass], int]:
    """Passes up to a stop, and which of them it is."""
    assert isinstance(room.source, Simulated)
    cycle, passes = plain_cycle(room), []
    cycle.clock_ns = lambda: 0
    for snapshot in room.source.at(TIMES_S):
        passes.append(Pass(snapshot, cycle.run(snapshot), 0.0))
        rows = passes[-1].result.verdicts
        if len(passes) > AROUND and any(row.level is Level.STOP for row in rows):
            break
    return passes[-AROUND:], AROUND - 1


def live(room: Room, passes: list[Pass], tab: Any) -> None:
    """The page of a run: as it is, why on a click, its controls, and when it is old."""
    # within the folder, so that no picture shows where it lies
    with TemporaryDirectory() as name, chdir(name), socket.create_server(("127.0.0.1", 0)) as free:
        port, folder = free.getsockname()[1], Path()
        free.close()
        _live(room, passes, tab, (folder, port))


def _live(room: Room, passes: list[Pass], tab: Any, served: tuple[Path, int]) -> None:
    (folder, port), motions = served, passes[0].result.verdicts
    gate = Gate(
        folder / "gate", "room", Rules(tuple(verdict.motion.name for verdict in motions), 5_000_000_000)
    )
    token = made_token(folder / "token")
    with OpenedPage(room, 0, service=port) as page:
        page.face.begin(room)
        over, controlled = threading.Event(), threading.Event()
        url = page.said().removeprefix("page: ")
        gate.begin()
        serving = Serving(gate, port, folder / "token", page.origins)

        def run() -> None:
            given = chain(passes, repeat(passes[-1]))
            while not over.wait(0.1):
                done = next(given)
                if controlled.is_set():
                    done = replace(done, decision=gate.decide(done.result))
                    serving.show(done)
                page.face.show(done)

        thread = threading.Thread(target=run)
        thread.start()
        tab.goto(url)
        tab.wait_for_selector("body:not(.waiting)")
        tab.wait_for_selector("#scene[data-drawn=yes]")
        settle(tab, len(passes) * 0.1)
        tab.wait_for_selector("#old", state="hidden")
        keep(tab, "page_live")
        tab.click("#motions tr:has(.chip.stop) button")
        tab.wait_for_selector("#why[data-final=true]")
        settle(tab)
        tab.wait_for_selector("#old", state="hidden")
        keep(tab, "page_why")
        serving.start()
        controlled.set()
        tab.wait_for_selector("#controls:not([hidden])")
        tab.fill("#token", token)
        tab.click("#use")
        tab.hover("#hold")
        tab.mouse.down()
        tab.wait_for_selector("#controlsaid:has-text('Held')")
        keep(tab.locator("#controls"), "page_controls")
        tab.mouse.up()
        os.kill(page.pid, signal.SIGSTOP)
        time.sleep(2.5)
        keep(tab, "page_old")
        os.kill(page.pid, signal.SIGCONT)
        over.set()
        thread.join()
        serving.end()
        gate.end()
        page.face.end()


def record(room: Room, passes: list[Pass], path: Path) -> None:
    """Keeps passes as a run of 10 Hz."""
    recorder = Recorder([WholeRun(path)])
    recorder.begin(room)
    for done in passes:
        recorder.show(done)
        time.sleep(0.1)
    recorder.end()


def replayed(recording: Recording, about: int, tab: Any) -> None:
    """The page over a recording."""
    words, configuration = words_of("en"), recording.configuration()
    extra = extra_of(list(stops_of(recording)), len(recording), recording.note, words)
    page, over = Page(configuration, words, "replay", extra), threading.Event()
    page.open(0)
    feed = Replayed(page, Judge(recording, configuration), over.is_set)
    thread = threading.Thread(target=feed.run, args=(about,))
    thread.start()
    tab.goto(page.server.url)
    tab.wait_for_selector("body:not(.waiting)")
    tab.wait_for_selector("#scene[data-drawn=yes]")
    tab.wait_for_selector("#changes li")
    settle(tab)
    keep(tab, "page_replay")
    over.set()
    thread.join()
    tab.goto("about:blank")
    page.server.stop()


@contextmanager
def browser() -> Iterator[Any]:
    """A tab of a browser without a screen."""
    from playwright.sync_api import sync_playwright

    with sync_playwright() as playwright:
        opened = playwright.chromium.launch(executable_path=shutil.which("chromium"), args=FLAGS)
        tab = opened.new_page(viewport={"width": WIDTH, "height": HEIGHT})
        tab.set_default_timeout(60_000)
        yield tab
        opened.close()


def settle(tab: Any, waits_s: float = 1.0) -> None:
    """Waits until the room is drawn: three pictures of it in turn are alike.

    Args:
        tab: of the browser.
        waits_s: before that [s].
    """
    time.sleep(waits_s)
    until_s, alike, before = time.monotonic() + 90.0, 0, b""
    while alike < 2 and time.monotonic() < until_s:
        now = tab.locator("#scene").screenshot()
        alike, before = (alike + 1 if now == before else 0), now
        time.sleep(0.7)


def keep(tab: Any, name: str) -> None:
    """Writes what is on the screen."""
    picture = Image.open(io.BytesIO(tab.screenshot())).convert("RGB")
    small = picture.convert("P", palette=Image.Palette.ADAPTIVE, colors=96)
    small.save(HERE / f"{name}.png", optimize=True)


if __name__ == "__main__":
    main()
