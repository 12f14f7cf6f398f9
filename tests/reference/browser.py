"""Debian's Chromium, without a screen, drawing by software."""

import shutil
import time
from collections.abc import Iterator
from contextlib import contextmanager
from io import BytesIO

import numpy as np
import pytest
from PIL import Image

CHROMIUM = shutil.which("chromium") or shutil.which("chromium-browser")
FLAGS = [
    "--no-sandbox",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
]
SOFTWARE_WEBGL = ["--use-angle=swiftshader", "--enable-unsafe-swiftshader"]
WAITS_MS = 30_000
SERIOUS = ("serious", "critical")
NO_WEBGL = ["--disable-gpu", "--disable-3d-apis"]


@contextmanager
def browsers() -> Iterator:
    """What opens a browser, given flags besides those that it needs without a screen and without network.

    Where there is no browser the test is skipped.
    """
    if CHROMIUM is None:
        pytest.skip("no chromium is installed (Debian: apt-get install chromium)")
    from playwright.sync_api import sync_playwright

    with sync_playwright() as playwright:
        opened = {}

        def browser(*more: str):
            if more not in opened:
                opened[more] = playwright.chromium.launch(executable_path=CHROMIUM, args=[*FLAGS, *more])
            return opened[more]

        try:
            yield browser
        finally:
            for one in opened.values():
                one.close()


def tab(browser, width: int = 1280, height: int = 800) -> Iterator:
    """A tab, in which no error may happen.

    Args:
        browser: a browser.
        width, height: of what is shown [px].
    """
    context = browser.new_context(viewport={"width": width, "height": height})
    context.set_default_timeout(WAITS_MS)
    made, errors = context.new_page(), []
    made.on("pageerror", lambda error: errors.append(str(error)))
    yield made
    context.close()
    assert errors == []


def frames_go_by(frame, count: int = 2) -> None:
    """Waits until so many pictures were drawn: on a busy computer that takes its time.

    Args:
        frame: a tab, or a frame of one.
        count: of pictures.
    """
    for _ in range(count):
        frame.evaluate("() => new Promise(done => requestAnimationFrame(() => done()))")


def settled(page, locator, waits_s: float = 60.0) -> np.ndarray:
    """What is on the screen once two pictures in turn are alike, shape (height, width, 3).

    Args:
        page: a tab.
        locator: of what is looked at.
        waits_s: it fails after so long [s].
    """
    until_s, before = time.monotonic() + waits_s, None
    while time.monotonic() < until_s:
        frames_go_by(page.frames[-1])
        now = pixels_of(locator)
        if before is not None and before.shape == now.shape and (before == now).all():
            return now
        before = now
    raise AssertionError("pictures go on changing")


def serious(page) -> list[str]:
    """What axe finds that is serious."""
    from axe_core_python.sync_playwright import Axe

    found = Axe().run(page)["violations"]
    return [f"{one['id']}: {one['help']}" for one in found if one["impact"] in SERIOUS]


def pixels_of(locator) -> np.ndarray:
    """What is on the screen where something is, shape (height, width, 3)."""
    return np.asarray(Image.open(BytesIO(locator.screenshot())).convert("RGB"))


def is_drawn(page) -> bool:
    """Whether the scene holds more than paper."""
    pixels = pixels_of(page.locator("#scene"))
    return len(np.unique(pixels[::3, ::3].reshape(-1, 3), axis=0)) > 60
