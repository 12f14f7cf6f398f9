"""Debian's Chromium, without a screen, drawing by software."""

import shutil
from collections.abc import Iterator
from contextlib import contextmanager

import pytest

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
