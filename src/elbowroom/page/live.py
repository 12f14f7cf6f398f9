"""The page of a run: what the monitor's board says, shown; and browsers answered."""

import base64
import io
import queue
import threading
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

from elbowroom.page.asking import changes_at
from elbowroom.page.board.board import Answered, Board
from elbowroom.page.board.reader import Reader, look_until
from elbowroom.page.page import Page
from elbowroom.page.scene.near import Planes
from elbowroom.page.talk import Viewer
from elbowroom.view.draw.depth import depth_picture

TEXT_EVERY_S, WAYS_EVERY_S = 0.1, 0.4
WAITS_S = 3.0
"""For so long images are waited for [s]."""


@dataclass(slots=True, eq=False)
class Live:
    """Feeds a page from a board.

    Args:
        page: that is open.
        board: that the monitor writes.
        is_over: whether to end.
        on_first: called when the first moment comes.
    """

    page: Page
    board: Board
    is_over: Callable[[], bool]
    on_first: Callable[[], None] = lambda: None
    _news: Reader = field(init=False)
    _said_s: float = field(default=0.0, init=False)
    _ways_s: float = field(default=0.0, init=False)
    _is_ended: bool = field(default=False, init=False)
    _is_ready: bool = field(default=False, init=False)

    def __post_init__(self) -> None:
        self._news = Reader(self.board)

    def run(self) -> None:
        """Shows what comes, until it is over; joints by a thread of their own, which nothing else holds up."""
        threading.Thread(target=self._answer, name="answers", daemon=True).start()
        drawing = threading.Thread(
            target=look_until, args=(self.is_over, self._draw), name="space", daemon=True
        )
        drawing.start()
        look_until(self.is_over, self._look)
        drawing.join()

    def _look(self, now_s: float) -> None:
        told = self._news.told()
        if told is not None:
            self._hear(told)

    def _draw(self, now_s: float) -> None:
        """Draws what takes its time: blocked space, and ways."""
        told = self.page.newest
        if told is None or self._is_ended:
            return
        self._news.planes(lambda planes: self._show(told, planes))
        if now_s - self._ways_s >= WAYS_EVERY_S:
            self._ways_s = now_s
            self.page.stage.show_ways(told)

    def _show(self, told: Mapping[str, Any], planes: Planes) -> bool:
        self.page.show_space(self.page.stage.near(told, planes))
        return True

    def _hear(self, told: Mapping[str, Any]) -> None:
        if told.get("ended"):
            self._is_ended = True
            self.page.talk.tell({"type": "ended"})
            return
        if self.page.newest is None:
            self.on_first()
        self.page.hear(told)
        now_s = time.monotonic()
        if now_s - self._said_s >= TEXT_EVERY_S * 0.9:
            self._said_s = now_s
            self.page.say()

    def _answer(self) -> None:
        """Answers browsers, one after the other."""
        while not self.is_over():
            try:
                viewer, asked = self.page.talk.questions.get(timeout=0.2)
            except queue.Empty:
                self._get_ready()
                continue
            try:
                self._answer_one(viewer, asked)
            except (KeyError, TypeError, ValueError, IndexError, OverflowError):
                continue  # no question that this page asks

    def _get_ready(self) -> None:
        """Looks once why something stops, before anybody asks: the first look takes most of a second."""
        told = None if self._is_ready else self.page.newest
        places = [] if told is None else [row["place_m"] for row in told["judged"]["verdicts"]]
        numbers = [number for number, place in enumerate(places) if place is not None]
        if not numbers:
            return
        self._is_ready = True
        answered = self._images()
        if answered is not None:
            changes_at(self.page.configuration, answered.told, answered.snapshot, numbers[0])

    def _answer_one(self, viewer: Viewer, asked: Mapping[str, Any]) -> None:
        told = self.page.newest
        if told is None:
            return
        if asked["type"] == "why":
            number = int(asked["motion"])
            if not 0 <= number < len(told["judged"]["verdicts"]):
                return
            self.page.stage.shown_ways = frozenset((number,))
            self.page.explain(viewer, told, number, None, is_final=False)
            answered = self._images()
            if answered is None:
                self.page.explain(viewer, told, number, None)
            else:
                changes = changes_at(self.page.configuration, answered.told, answered.snapshot, number)
                self.page.explain(viewer, answered.told, number, changes)
                told = answered.told
            self.page.fly(viewer, told["judged"]["verdicts"][number]["place_m"])
        if asked["type"] == "ways":
            self.page.stage.shows_clear = asked["all"] is True
        if asked["type"] == "depth":
            answered, name = self._images(), str(asked["camera"])
            frames = () if answered is None else answered.snapshot.frames
            for frame in frames:
                if frame.camera == name:
                    self.page.talk.answer(viewer, depth_message(name, frame.depth_m))

    def _images(self) -> Answered | None:
        """The images of the newest pass; None: the monitor gave none."""
        number, until_s = self.board.ask(), time.monotonic() + WAITS_S
        while time.monotonic() < until_s and not self.is_over():
            answered = self._news.images()
            if answered is not None and answered.number >= number:
                return answered
            time.sleep(0.002)
        return None


def depth_message(name: str, depth_m: Any) -> dict[str, Any]:
    """A depth image as a browser shows it.

    Args:
        name: of the camera.
        depth_m: shape (height, width) [m].
    """
    step = max(1, depth_m.shape[1] // 320)
    content = io.BytesIO()
    depth_picture(depth_m[::step, ::step]).save(content, format="PNG")
    picture = base64.b64encode(content.getvalue()).decode()
    return {"type": "depth", "camera": name, "picture": f"data:image/png;base64,{picture}"}
