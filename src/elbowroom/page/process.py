"""The page's own process, `python -m elbowroom.page.process`: started by the monitor, fed by its board, ended with it.

Read from standard input: one line of JSON that says what to show. Written to standard output: one line that says where.
"""

import contextlib
import importlib
import json
import os
import sys
import threading
import time
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from elbowroom.errors import ElbowroomError, InputError
from elbowroom.garbage import uncollected
from elbowroom.guard.priority import step_back

if TYPE_CHECKING:
    from elbowroom.page.page import Page

STAYS_S = 3.0
"""So long after the monitor it stays, so that browsers hear of the end [s]."""
PORT = 8137
"""At which the page is, if nobody says otherwise and it is free."""
NICE = 10
"""The monitor comes first, once it judges."""


def main() -> None:
    """Serves the page until standard input ends."""
    os.environ.setdefault("NUMBA_NUM_THREADS", "1")
    _get_ready()
    line = sys.stdin.readline()
    if not line:  # whoever began it has ended
        return
    try:
        serve(json.loads(line))
    except ElbowroomError as error:
        _say({"error": str(error)})


def _get_ready() -> None:
    """Imports what is going to be needed, before it is said what to show."""
    with contextlib.suppress(ImportError), uncollected():  # what is missing is said by who needs it
        importlib.import_module("elbowroom.page.live")
        importlib.import_module("viser")


def serve(said: Mapping[str, Any]) -> None:
    """Serves the page that was asked for.

    Args:
        said: board, folder with the configuration, language, port, and port of the control service.
    """
    from elbowroom.monitor.blackbox.configuration import CONFIGURATION, SITE, Configuration
    from elbowroom.page.board.board import Board
    from elbowroom.page.live import Live
    from elbowroom.page.page import Page
    from elbowroom.page.words import words_of

    folder = Path(said["folder"])
    content, text = ((folder / name).read_bytes() for name in (CONFIGURATION, SITE))
    board = Board.opened(said["board"])
    with contextlib.suppress(OSError):  # both have it open: nothing stays behind, however they end
        board.forget()
    configuration, words = Configuration.read(content, text, "page"), words_of(said["language"])
    page = Page(configuration, words, "live", service=said.get("service"))
    _open(page, said["port"])
    _say({"url": page.server.url})
    over = threading.Event()
    threading.Thread(target=_wait_for_end, args=(over,), daemon=True).start()
    Live(page, board, over.is_set, lambda: step_back(NICE)).run()
    page.talk.tell({"type": "ended"})
    time.sleep(STAYS_S)
    page.server.stop()


def _open(page: "Page", port: int | None) -> None:
    """Begins to serve at a port; where none is named and the usual one is taken, at any.

    Raises:
        InputError: the named one is taken.
    """
    if port is not None:
        page.open(port)
        return
    try:
        page.open(PORT)
    except InputError:
        page.open(0)


def _wait_for_end(over: threading.Event) -> None:
    """Standard input ends with the monitor, however that ends."""
    while sys.stdin.readline():
        pass
    over.set()


def _say(what: Mapping[str, Any]) -> None:
    print(json.dumps(what), flush=True)


if __name__ == "__main__":
    main()
