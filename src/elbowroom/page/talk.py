"""What is told to browsers, and what they ask: the newest text to each of them; who is slow misses some."""

import asyncio
import json
import queue
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

MOST_QUESTIONS = 64
"""So many questions may wait; others are not heard."""
MOST_LENGTH = 2000
"""No question is longer [characters]."""

Message = Mapping[str, Any]


@dataclass(slots=True, eq=False)
class Viewer:
    """One browser.

    Args:
        token: by which its scene is known.
        socket: its WebSocket.
    """

    token: str
    socket: Any
    waiting: dict[str, Message] = field(default_factory=dict)
    news: asyncio.Event = field(default_factory=asyncio.Event)


@dataclass(slots=True, eq=False)
class Talk:
    """All browsers that read.

    Args:
        hello: what each is told first.
    """

    hello: Callable[[], Message]
    questions: "queue.Queue[tuple[Viewer, dict[str, Any]]]" = field(
        default_factory=lambda: queue.Queue(MOST_QUESTIONS), init=False
    )
    """Of whom, and what; whoever answers takes them."""
    _viewers: set[Viewer] = field(default_factory=set, init=False)
    _newest: dict[str, Message] = field(default_factory=dict, init=False)
    _loop: asyncio.AbstractEventLoop | None = field(default=None, init=False)

    @property
    def count(self) -> int:
        """Of browsers that read now."""
        return len(self._viewers)

    async def serve(self, socket: Any) -> None:
        """Talks with one browser until it leaves."""
        self._loop = asyncio.get_running_loop()
        viewer = Viewer("", socket)
        await socket.send(_text(self.hello()))
        viewer.waiting = dict(self._newest)
        viewer.news.set()
        self._viewers.add(viewer)
        pump = asyncio.create_task(self._pump(viewer))
        try:
            async for content in socket:
                self._hear(viewer, content)
        finally:
            self._viewers.discard(viewer)
            pump.cancel()

    def tell(self, message: Message) -> None:
        """Tells all browsers; a message of the same type that a browser has not taken yet is forgotten.

        Args:
            message: of a key `type`.
        """
        self._newest[message["type"]] = message
        if self._loop is not None:
            self._loop.call_soon_threadsafe(self._spread, list(self._viewers), message)

    def answer(self, viewer: Viewer, message: Message) -> None:
        """Tells one browser.

        Args:
            viewer: whom.
            message: of a key `type`.
        """
        if self._loop is not None:
            self._loop.call_soon_threadsafe(self._spread, [viewer], message)

    def _spread(self, viewers: list[Viewer], message: Message) -> None:
        for viewer in viewers:
            viewer.waiting[message["type"]] = message
            viewer.news.set()

    def _hear(self, viewer: Viewer, content: str | bytes) -> None:
        """Notes a question; what is none is not heard."""
        if not isinstance(content, str) or len(content) > MOST_LENGTH:
            return
        try:
            asked = json.loads(content)
            if not isinstance(asked, dict) or not isinstance(asked.get("type"), str):
                return
            if asked["type"] == "scene":
                viewer.token = str(asked.get("token"))[:64]
                return
            self.questions.put_nowait((viewer, asked))
        except (ValueError, RecursionError, queue.Full):
            return

    async def _pump(self, viewer: Viewer) -> None:
        """Sends what is news, as fast as the browser takes it."""
        while True:
            await viewer.news.wait()
            viewer.news.clear()
            waiting, viewer.waiting = viewer.waiting, {}
            for message in waiting.values():
                await viewer.socket.send(_text(message))


def _text(message: Message) -> str:
    return json.dumps(message, separators=(",", ":"), ensure_ascii=False)
