"""The page over a recording: browsers ask for a moment, and see it."""

import queue
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

from elbowroom.errors import ElbowroomError
from elbowroom.page.face import planes_of
from elbowroom.page.live import depth_message
from elbowroom.page.page import Page
from elbowroom.page.replay.again import Again, Judge
from elbowroom.page.replay.stops import Stop
from elbowroom.page.story.headline import headline
from elbowroom.page.talk import Viewer
from elbowroom.page.telling import clock
from elbowroom.page.words import Words

WAITS_S = 0.02
BEFORE = 20
"""Rates of cameras are those of so many passes before."""
LONGEST_STEP_S = 1.0
"""Where a recording has a gap, play goes on after so long [s]."""


def extra_of(stops: list[Stop], count: int, note: str | None, words: Words) -> dict[str, Any]:
    """What browsers are told of a recording.

    Args:
        stops: of it.
        count: of its passes.
        note: that it is cut off; None: it is whole.
        words: of the language.
    """
    marks = [
        {
            "index": stop.index,
            "time": clock(stop.wall_ns),
            "text": stop.text or f"{', '.join(stop.motions)}: {words('level.stop')}",
        }
        for stop in stops
    ]
    return {"count": count, "stops": marks, "note": None if note is None else words("cut", note=f"{note}.")}


@dataclass(slots=True, eq=False)
class Replayed:
    """Feeds a page from a recording.

    Args:
        page: that is open.
        judge: of the recording.
        is_over: whether to end.
    """

    page: Page
    judge: Judge
    is_over: Callable[[], bool]
    _index: int = field(default=0, init=False)
    _shown: Again | None = field(default=None, init=False)
    _plays_since: tuple[float, int] | None = field(default=None, init=False)

    def run(self, begin: int = 0) -> None:
        """Shows what browsers ask for, until it is over.

        Args:
            begin: number of the first pass in the file.
        """
        self._show(begin)
        while not self.is_over():
            wanted: int | None = None
            asked = self._asked()
            while asked is not None:  # of several places that were asked for the last counts
                wanted = self._heard(*asked, wanted)
                asked = self._asked(0.0)
            if wanted is None and self._plays_since is not None:
                wanted = self._due()
            if wanted is not None and wanted != self._index:
                self._show(wanted)

    def _asked(self, waits_s: float = WAITS_S) -> tuple[Viewer, Mapping[str, Any]] | None:
        try:
            return self.page.talk.questions.get(timeout=waits_s) if waits_s else self._asked_now()
        except queue.Empty:
            return None

    def _asked_now(self) -> tuple[Viewer, Mapping[str, Any]]:
        return self.page.talk.questions.get_nowait()

    def _heard(self, viewer: Viewer, asked: Mapping[str, Any], wanted: int | None) -> int | None:
        """Answers a question; the pass that is wanted, if one is."""
        at = self._index if wanted is None else wanted
        last = len(self.judge.recording) - 1
        try:
            if asked["type"] == "seek":
                self._play(False)
                return min(max(int(asked["index"]), 0), last)
            if asked["type"] == "step":
                self._play(False)
                return min(max(at + int(asked["by"]), 0), last)
            if asked["type"] in ("play", "pause"):
                self._play(asked["type"] == "play")
            if asked["type"] == "why":
                self._explain(viewer, int(asked["motion"]))
            if asked["type"] == "ways":
                self.page.stage.shows_clear = asked["all"] is True
                if self._shown is not None:
                    self.page.stage.show_ways(self._shown.told)
            if asked["type"] == "depth":
                self._depth(viewer, str(asked["camera"]))
        except (KeyError, TypeError, ValueError, IndexError, OverflowError):
            pass  # no question that this page asks
        return wanted

    def _play(self, is_playing: bool) -> None:
        last = len(self.judge.recording) - 1
        if is_playing and self._index == last:
            self._show(0)
        self._plays_since = (time.monotonic(), self._index) if is_playing else None
        self.page.talk.tell({"type": "play", "is_playing": is_playing})

    def _due(self) -> int | None:
        """The pass that is to be shown by now, at the pace at which it was recorded."""
        assert self._plays_since is not None
        since_s, index = self._plays_since
        last = len(self.judge.recording) - 1
        gone_s = time.monotonic() - since_s
        while index < last:
            now, then = (self.judge.recording.said_at(n)["wall_ns"] for n in (index, index + 1))
            step_s = min(max((then - now) / 1e9, 0.0), LONGEST_STEP_S)
            if step_s > gone_s:
                break
            gone_s -= step_s
            index += 1
        self._plays_since = time.monotonic() - gone_s, index
        if index == last:
            self._play(False)
        return index

    def _show(self, index: int) -> None:
        """Shows a pass: what is said of it at once, its space as soon as it is judged again."""
        self._index = index
        try:
            told, one = self.judge.told(index)
            self._hear_before(index)
            self.page.hear(told)
            self.page.say(index=index, sequence_s=one.wall_ns / 1e9)
            self.page.stage.show_ways(told)
            self._shown = self.judge.again(told, one)
        except ElbowroomError as error:
            self.page.talk.tell({"type": "trouble", "text": f"{error}"})
            self._play(False)
            return
        scene = self.page.stage.scene
        assert scene is not None
        if self._shown.space is None:
            scene.hide()
        else:
            self.page.show_space(self.page.stage.near(told, planes_of(self._shown.space)))
            why = self._why(self._shown)
            self.page.say(index=index, sequence_s=one.wall_ns / 1e9, **why)

    def _why(self, shown: Again) -> dict[str, Any]:
        """What the sentence of a moment is about, explained by the cameras; nothing where nobody can."""
        motion = headline(shown.told, self.page.words).motion
        if motion is None:
            return {}
        changes = self.judge.changes(shown, motion)
        return {} if changes is None else {"why": self.page.telling.why(shown.told, motion, changes)}

    def _hear_before(self, index: int) -> None:
        """Tells rates of the images that came before a pass."""
        for number in range(max(0, index - BEFORE), index):
            frames = self.judge.recording.said_at(number)["given"]["frames"]
            self.page.telling.rates.hear({"stamps": {camera: stamp for camera, _, stamp in frames}})

    def _explain(self, viewer: Viewer, number: int) -> None:
        shown = self._shown
        if shown is None or not 0 <= number < len(shown.told["judged"]["verdicts"]):
            return
        self.page.stage.shown_ways = frozenset((number,))
        self.page.explain(viewer, shown.told, number, self.judge.changes(shown, number))
        self.page.stage.show_ways(shown.told)
        self.page.fly(viewer, shown.told["judged"]["verdicts"][number]["place_m"])

    def _depth(self, viewer: Viewer, name: str) -> None:
        for frame in self.judge.recording.at(self._index).snapshot.frames:
            if frame.camera == name:
                self.page.talk.answer(viewer, depth_message(name, frame.depth_m))
