"""Draws the pictures of docs/planning.md, by hands in a browser: python docs/images/build_planning.py

Needs `elbowroom[page]`, Playwright and Debian's Chromium.
"""

import shutil
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

from PIL import Image

from elbowroom.cli import run
from elbowroom.page.plan.ground import Ground
from elbowroom.page.plan.opened import open_plan
from elbowroom.page.plan.package_room import package_room
from elbowroom.page.plan.session import Session
from elbowroom.page.words import words_of

HERE = Path(__file__).resolve().parent
FLAGS = [
    "--no-sandbox",
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
    "--disable-background-networking",
]
SIZE = {"width": 1360, "height": 880}
WAITS_S = 120.0


def main() -> None:
    """Plans a room, drives a joint, walks a person; then draws what a command draws."""
    from playwright.sync_api import sync_playwright

    browser_path = shutil.which("chromium") or shutil.which("chromium-browser")
    with tempfile.TemporaryDirectory() as folder, sync_playwright() as playwright:
        ground = Ground.of(package_room("simulated"))
        session = open_plan(ground, words_of("en"), Path(folder) / "planned.yaml", port=0, is_fresh=True)
        browser = playwright.chromium.launch(executable_path=browser_path, args=FLAGS)
        tab = browser.new_page(viewport=SIZE)
        tab.set_default_timeout(WAITS_S * 1000)
        assert session.page is not None
        tab.goto(session.page.url)
        panel = tab.frame_locator("iframe")
        panel.get_by_role("button", name="Undo").wait_for()
        # what viser says of drawing by software is no part of the page
        tab.frames[1].add_style_tag(content="[class*=Notifications-root] { display: none }")
        _plan(session)
        _kept(tab, "planning.png")
        _walk(session)
        _kept(tab, "planning_walk.png")
        browser.close()
        session.stop()
        session.page.stop()
    for name, options in PICTURES.items():
        assert run(["view", "--picture", str(HERE / name), "--moment", "4", *options]) == 0


PICTURES = {
    "view_iso.jpg": ["--size", "1280x960"],
    "view_top.jpg": ["--view", "top", "--size", "1000x960", "--hide", "sweeps"],
}


def _plan(session: Session) -> None:
    planner = session.planner
    planner.add_person((0.9, -0.9))
    planner.move("person 1", (0.9, -0.75), 2.2)
    planner.move_joint("larm", 0.35)
    time.sleep(1.0)
    session.choose("cam02")
    _waited(lambda: _is_exact(session))


def _walk(session: Session) -> None:
    session.panel.at["show_invalid"].value = False
    session.panel.at["from"].value, session.panel.at["to"].value = (-1.5, -1.3), (1.5, -1.3)
    planner = session.planner
    for name in planner.layout.camera_names:
        if name not in ("cam00", "cam05", "cam11", "cam16"):
            planner.remove_camera(name)
    planner.remove("person 1")
    for number, (x, y, turn) in enumerate(((-1.1, -0.9, 0.5), (1.2, -0.6, 1.57), (-0.2, 1.3, 0.1)), 1):
        planner.add_thing("partition")
        planner.move(f"partition {number}", (x, y), turn)
    _waited(lambda: _is_exact(session))
    session.errands.floor()
    _waited(lambda: "asked" in session.panel.at["message"].content)


def _is_exact(session: Session) -> bool:
    said = session.newest
    return (
        said is not None
        and said.figures is not None
        and said.figures.is_exact
        and said.layout is session.planner.layout
    )


def _kept(tab: object, name: str) -> None:
    before, until = None, time.monotonic() + WAITS_S
    while time.monotonic() < until:  # software drawing: until nothing changes for a while
        time.sleep(3.0)
        now = tab.screenshot(path=str(HERE / name))  # type: ignore[attr-defined]
        if now == before:
            break
        before = now
    _smaller(HERE / name)


def _smaller(path: Path) -> None:
    """With few colours, so that the repository stays light."""
    picture = Image.open(path).convert("RGB")
    picture.convert("P", palette=Image.Palette.ADAPTIVE, colors=256).save(path, optimize=True)


def _waited(is_so: Callable[[], bool]) -> None:
    until = time.monotonic() + WAITS_S
    while not is_so():
        assert time.monotonic() < until, "it did not come to be"
        time.sleep(0.1)


if __name__ == "__main__":
    main()
