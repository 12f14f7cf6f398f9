"""A run of a small room that tells its page, pass after pass, until the test is done with it."""

import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path

from elbowroom.monitor import Pass
from elbowroom.monitor.blackbox.configuration import plain_cycle
from elbowroom.page.opened import OpenedPage
from elbowroom.site import Site
from elbowroom.sources import open_room
from reference.small_room import SMALL_ROOM


@dataclass
class Told:
    """A page that is told of a run.

    Args:
        page: the page.
        url: where it is.
    """

    page: OpenedPage
    url: str
    pauses: threading.Event = field(default_factory=threading.Event)
    passes: int = 0


@contextmanager
def told_page(folder: Path, language: str = "en") -> Iterator[Told]:
    """A page of a small simulated room.

    Args:
        folder: for its site file.
        language: of its words.
    """
    path = folder / "room.yaml"
    path.write_text(SMALL_ROOM)
    room = open_room(Site.load(path))
    cycle, over = plain_cycle(room), threading.Event()
    snapshots = [snapshot for snapshot, _ in zip(room.source, range(6), strict=False)]
    with OpenedPage(room, 0, language) as page:
        page.face.begin(room)
        told = Told(page, page.said().removeprefix("page: "))

        def run() -> None:
            while not over.is_set():
                snapshot = snapshots[told.passes % len(snapshots)]
                if not told.pauses.is_set():
                    page.face.show(Pass(snapshot, cycle.run(snapshot), 0.0))
                    told.passes += 1
                time.sleep(0.1)

        thread = threading.Thread(target=run)
        thread.start()
        try:
            yield told
        finally:
            over.set()
            thread.join()
            page.face.end()
