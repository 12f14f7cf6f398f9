"""From the command to the first full picture in a browser without a screen, drawn by software."""

import shutil
import subprocess
import sys
import time
from io import BytesIO
from typing import Any

import numpy as np
from PIL import Image

from elbowroom.errors import PackageError
from elbowroom.page import colours

FLAGS = [
    "--no-sandbox",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
]
LEAST_PX, NEAR_COLOUR = 15, 24
"""So many pixels of blocked space, and of the machine, make a picture full."""
GIVES_UP_S, LOOKS_S = 60.0, 0.1


def first_picture() -> dict[str, Any]:
    """Times from the command until the page is there, says a verdict, and shows machine and blocked space [s].

    Raises:
        PackageError: no Chromium, or no Playwright.
    """
    chromium = shutil.which("chromium") or shutil.which("chromium-browser")
    try:
        from playwright.sync_api import sync_playwright
    except ImportError:
        chromium = None
    if chromium is None:
        raise PackageError(
            "the first picture needs Chromium (Debian: apt-get install chromium) and playwright"
        )
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=chromium, args=FLAGS)
        page = browser.new_page(viewport={"width": 1280, "height": 800})
        begun_s = time.perf_counter()
        command = [sys.executable, "-m", "elbowroom", "monitor", "--page-port", "0"]
        run = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
        try:
            assert run.stdout is not None
            url = next(line.rpartition("page: ")[2].strip() for line in run.stdout if "page: http" in line)
            found = {"part": "picture", "url_s": time.perf_counter() - begun_s}
            page.goto(url)
            page.wait_for_selector("body:not(.waiting)", timeout=1e3 * GIVES_UP_S)
            found["text_s"] = time.perf_counter() - begun_s
            while not _is_full(page.locator("#scene").screenshot()):
                if time.perf_counter() - begun_s > GIVES_UP_S:
                    return {**found, "first_picture_s": None}
                time.sleep(LOOKS_S)  # looking takes processor time as well
            return {**found, "first_picture_s": time.perf_counter() - begun_s}
        finally:
            run.terminate()
            run.wait(30)
            browser.close()


def _is_full(screenshot: bytes) -> bool:
    """Whether a picture holds blocked space and the machine."""
    pixels = np.asarray(Image.open(BytesIO(screenshot)).convert("RGB")).astype(int)
    blocked = sum(_count(pixels, colour) for colour in (colours.SURFACE, colours.UNSEEN, colours.BLIND))
    grey = np.ptp(pixels, axis=2) < 30
    shaded = grey & (pixels.mean(axis=2) > 60) & (pixels.mean(axis=2) < 215)
    return blocked > LEAST_PX and int(shaded.sum()) > 20 * LEAST_PX


def _count(pixels: Any, colour: colours.Colour) -> int:
    return int((np.abs(pixels - np.array(colour)).max(axis=2) < NEAR_COLOUR).sum())
