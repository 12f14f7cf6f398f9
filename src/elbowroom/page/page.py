"""The page: a guarded server, the room in it, and what browsers are told; who feeds it is another's matter."""

import time
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from elbowroom.monitor.blackbox.configuration import Configuration
from elbowroom.monitor.why.changes import Change
from elbowroom.page.fly import client_of, fly_to
from elbowroom.page.hello import hello_of
from elbowroom.page.scene.near import Near
from elbowroom.page.scene.scene import Scene
from elbowroom.page.server import Guarded, guarded
from elbowroom.page.served import answers_of
from elbowroom.page.stage import Stage
from elbowroom.page.story.cameras import Rates, camera_rows
from elbowroom.page.story.headline import headline
from elbowroom.page.story.motions import looked_at_of, motion_rows, with_reach
from elbowroom.page.story.told import Told
from elbowroom.page.story.why_text import why_text
from elbowroom.page.talk import Talk, Viewer
from elbowroom.page.words import Words

TEXT = "/text"
"""Path of the WebSocket that texts come by."""


@dataclass(slots=True, eq=False)
class Page:
    """What browsers see of a run or a recording.

    Args:
        configuration: of the run.
        words: of the language.
        mode: "live" or "replay".
        extra: what browsers are told first besides, such as the stops of a recording.
    """

    configuration: Configuration
    words: Words
    mode: str
    extra: Mapping[str, Any] = field(default_factory=dict)
    talk: Talk = field(init=False)
    stage: Stage = field(init=False)
    server: Guarded = field(init=False)
    rates: Rates = field(default_factory=Rates, init=False)
    newest: Told | None = field(default=None, init=False)
    _looked_at: Mapping[str, float] = field(default_factory=dict, init=False)
    _thinned: str | None = field(default=None, init=False)

    def __post_init__(self) -> None:
        self.talk = Talk(self._hello)
        self._looked_at = looked_at_of(self.configuration.motions)

    def open(self, port: int) -> None:
        """Begins to serve, and draws what stays.

        Args:
            port: at which; 0: any that is free.

        Raises:
            InputError: the port is taken.
            PackageError: viser is missing.
        """
        answers = answers_of(self.words, str(self.configuration.told.get("site")))
        self.server = guarded(Guarded(answers, {TEXT: self.talk.serve}), port)
        self.stage = Stage(Scene(self.server.viser), self.configuration)
        self.stage.draw()
        _look_from_aside(self.server.viser, self.stage)

    def hear(self, told: Told) -> None:
        """A moment is there: the machine is moved, and cameras count."""
        self.newest = told
        self.rates.hear(told)
        self.stage.place(told)

    def show_space(self, near: Near) -> None:
        """Blocked space is known anew."""
        assert self.stage.scene is not None
        self.stage.scene.show_near(near, self.stage.grid)
        shown = None if near.thinned is None else {"all": near.thinned, "shown": near.count}
        self._thinned = None if shown is None else self.words("thinned", **shown)

    def say(self, **besides: Any) -> None:
        """Tells browsers of the newest moment.

        Args:
            besides: what is said of it besides, such as its place in a recording.
        """
        told = self.newest
        if told is None:
            return
        cameras = camera_rows(told, self.words, self._camera_names(), self.rates)
        self.stage.colour(cameras)
        self.talk.tell({"type": "moment", **self.moment(told, cameras), "thinned": self._thinned, **besides})

    def moment(self, told: Told, cameras: list[dict[str, Any]]) -> dict[str, Any]:
        """A moment as browsers are told of it.

        Args:
            told: the moment.
            cameras: rows of the table.
        """
        said, motions = headline(told, self.words), motion_rows(told, self.words, self._looked_at)
        judged = told["judged"]
        cycle_ms = sum(judged["stage_ms"].values())
        oldest_ms = judged["oldest_age_ms"]
        level = "unknown" if said.level is None else said.level.name.lower()
        return {
            "sequence": told["sequence"],
            "at": self.words("at", sequence=told["sequence"], time=clock(told["wall_ns"])),
            "age_s": max(0.0, (time.time_ns() - told["wall_ns"]) / 1e9) if self.mode == "live" else 0.0,
            "level": level,
            "word": self.words(f"level.{level}"),
            "sentence": said.sentence,
            "detail": said.detail,
            "motion": said.motion,
            "why": self._why(told, said.motion),
            "motions": motions,
            "cameras": cameras,
            "cycle_ms": cycle_ms,
            "age_ms": None if oldest_ms is None else float(oldest_ms) + cycle_ms,
        }

    def _why(self, told: Told, motion: int | None) -> dict[str, Any] | None:
        """The worst verdict explained, without asking the cameras; None: nothing is to be explained."""
        rows = told["judged"]["verdicts"]
        if not rows or (motion is None and told["judged"]["stopped_by"] is None):
            return None
        row = with_reach(rows[motion or 0], self._looked_at)
        return why_text(told, row, self.words)

    def explain(
        self,
        viewer: Viewer,
        told: Told,
        number: int,
        changes: tuple[Change, ...] | None,
        is_final: bool = True,
    ) -> None:
        """Tells a browser why a motion ends where it does.

        Args:
            viewer: which browser.
            told: the moment.
            number: of the motion.
            changes: what would change it; None: the cameras were not asked.
            is_final: whether nothing more is going to be said.
        """
        row = with_reach(told["judged"]["verdicts"][number], self._looked_at)
        said = why_text(told, row, self.words, changes)
        self.talk.answer(viewer, {"type": "why", "number": number, "is_final": is_final, **said})

    def fly(self, viewer: Viewer, place: Any) -> None:
        """Turns a browser's view to a place, if it shows the room.

        Args:
            viewer: which browser.
            place: world frame [m]; None: nowhere.
        """
        client = client_of(self.server, viewer.token) if place is not None else None
        if client is not None:
            fly_to(client, np.array(place, dtype=np.float64))

    def _camera_names(self) -> list[str]:
        return [camera.name for camera in self.configuration.cameras]

    def _hello(self) -> Mapping[str, Any]:
        return {**hello_of(self.configuration, self.words, self.mode), **self.extra}


def clock(wall_ns: int) -> str:
    """The time of day, to the tenth of a second, as this computer's calendar has it.

    Args:
        wall_ns: since 1970 [ns].
    """
    tenths = wall_ns // 100_000_000 % 10
    return f"{time.strftime('%H:%M:%S', time.localtime(wall_ns / 1e9))}.{tenths}"


def _look_from_aside(server: Any, stage: Stage) -> None:
    """Where a view begins: from a corner above, at the middle of the box."""
    lower, upper = stage.grid.lower_m, stage.grid.upper_m
    middle = (lower + upper) / 2
    size = float(np.linalg.norm(upper - lower))
    server.initial_camera.position = tuple(middle + size * np.array([0.5, -0.5, 0.2]))
    server.initial_camera.look_at = tuple(middle - np.array([0.0, 0.0, 0.08 * size]))
    server.initial_camera.up = (0.0, 0.0, 1.0)
