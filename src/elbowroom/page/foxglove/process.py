"""Foxglove's own process, as `page.process` is the page's: `python -m elbowroom.page.foxglove.process`."""

import json
import os
import sys
import threading
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from elbowroom.errors import ElbowroomError

NICE = 10
"""The monitor comes first."""


def main() -> None:
    """Serves viewers until standard input ends."""
    os.environ.setdefault("NUMBA_NUM_THREADS", "1")
    if hasattr(os, "nice"):
        os.nice(NICE)
    said = json.loads(sys.stdin.readline())
    try:
        serve(said)
    except ElbowroomError as error:
        print(json.dumps({"error": str(error)}), flush=True)


def serve(said: Mapping[str, Any]) -> None:
    """Serves the room that was asked for.

    Args:
        said: board, folder with the configuration, port.
    """
    from elbowroom.monitor.blackbox.configuration import CONFIGURATION, SITE, Configuration
    from elbowroom.page.board.board import Board
    from elbowroom.page.foxglove.bridge import Bridge
    from elbowroom.page.foxglove.live import LiveBridge

    folder = Path(said["folder"])
    content, text = ((folder / name).read_bytes() for name in (CONFIGURATION, SITE))
    board = Board.opened(said["board"])
    bridge = Bridge(Configuration.read(content, text, "foxglove"), int(said["port"]))
    print(json.dumps({"url": bridge.url}), flush=True)
    over = threading.Event()
    threading.Thread(target=_wait_for_end, args=(over,), daemon=True).start()
    LiveBridge(bridge, board, over.is_set).run()
    bridge.stop()


def _wait_for_end(over: threading.Event) -> None:
    """Standard input ends with the monitor, however that ends."""
    while sys.stdin.readline():
        pass
    over.set()


if __name__ == "__main__":
    main()
