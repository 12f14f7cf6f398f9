"""The page, opened by a run: its process, its board and the face that tells it."""

import contextlib
import json
import shutil
import threading
from collections.abc import Iterator
from dataclasses import dataclass, field
from importlib.util import find_spec
from pathlib import Path
from types import TracebackType
from typing import Any, Self
from urllib.parse import urlsplit

from elbowroom.extras import install_command
from elbowroom.monitor.blackbox.configuration import Configuration, plain_cycle
from elbowroom.page.board.board import Board, Sizes
from elbowroom.page.early import PAGE, Early
from elbowroom.page.face import PageFace
from elbowroom.page.server.door import HOSTS
from elbowroom.page.words import words_of
from elbowroom.sources import Room

OPENS_S = 90.0
"""So long it may take until the page says where it is [s]."""


def missing() -> str | None:
    """What to install so that there is a page; None: all is there."""
    if find_spec("viser") is not None:
        return None
    return f"no page: it needs viser; install it with {install_command('page')}"


@dataclass(slots=True, eq=False)
class OpenedPage:
    """A page in its own process; whatever becomes of it, the run goes on. As a context, it ends with it.

    Args:
        room: that is watched.
        port: at which; None: 8137, or where that is taken any that is free.
        language: of its words.
        name: what it is called when something is said of it.
        program: the module that runs in its process.
        service: port of the control service, which browsers ask themselves; None: it is not started.
        early: its process, where it was begun before; None: it is begun when this is entered.

    Raises:
        InputError: no such language.
    """

    room: Room
    port: int | None = None
    language: str = "en"
    name: str = "page"
    program: str = PAGE
    service: int | None = None
    early: Early | None = None
    face: PageFace = field(init=False)
    _folder: Path = field(init=False)
    _process: Any = field(default=None, init=False)
    _answer: dict[str, str] = field(default_factory=dict, init=False)
    _heard: threading.Event = field(default_factory=threading.Event, init=False)

    def __post_init__(self) -> None:
        words_of(self.language)

    def __enter__(self) -> Self:
        room = self.room
        board = Board.made(Sizes.of(room.grid, room.cameras))
        self.face = PageFace(board)
        early = Early.begun(self.program) if self.early is None else self.early
        self._folder, self._process = early.folder, early.process
        for part in Configuration.of(room, plain_cycle(room)).attached():
            (self._folder / part.name).write_bytes(part.data)
        said: dict[str, Any] = {"board": board.said(), "folder": str(self._folder), "language": self.language}
        said |= {"port": self.port, "service": self.service}
        with contextlib.suppress(OSError):
            self._process.stdin.write(json.dumps(said) + "\n")
            self._process.stdin.flush()
        threading.Thread(target=self._listen, daemon=True).start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        with contextlib.suppress(OSError):
            self._process.stdin.close()
        threading.Thread(target=self._process.wait, daemon=True).start()
        self.face.board.forget()
        shutil.rmtree(self._folder, ignore_errors=True)

    @property
    def pid(self) -> int:
        """Number of its process."""
        return int(self._process.pid)

    def said(self, waits_s: float = OPENS_S) -> str:
        """Where the page is, or why there is none, a line.

        Args:
            waits_s: for so long it is waited for [s].
        """
        self._heard.wait(waits_s)
        if "url" in self._answer:
            return f"{self.name}: {self._answer['url']}"
        return f"no {self.name}: {self._answer.get('error', 'its process does not answer')}"

    @property
    def origins(self) -> tuple[str, ...]:
        """What browsers call this page when it asks the control service, by exact name; none: it is not open."""
        url = self._answer.get("url", "")
        at = urlsplit(url)
        return tuple(f"http://{host}:{at.port}" for host in HOSTS) if at.scheme == "http" else ()

    @property
    def troubles(self) -> Iterator[str]:
        """What the page suffered, a line each."""
        if self.face.fault is not None:
            yield f"{self.name}: was not told all ({self.face.fault})"
        if self._process.poll() not in (None, 0):
            yield f"{self.name}: its process ended by itself ({self._process.returncode}); the monitor went on"

    def _listen(self) -> None:
        with self._process.stdout as lines, contextlib.suppress(ValueError):
            self._answer = json.loads(lines.readline())
        self._heard.set()
