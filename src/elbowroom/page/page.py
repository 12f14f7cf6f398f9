"""The page: a guarded server, the room in it, and what browsers are told; who feeds it is another's matter."""

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
from elbowroom.page.served import answers_of
from elbowroom.page.server import Guarded, guarded
from elbowroom.page.stage import Stage
from elbowroom.page.story.told import Told
from elbowroom.page.talk import Talk, Viewer
from elbowroom.page.telling import Telling
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
        service: port of the control service, which browsers ask themselves; None: there is none.
    """

    configuration: Configuration
    words: Words
    mode: str
    extra: Mapping[str, Any] = field(default_factory=dict)
    service: int | None = None
    talk: Talk = field(init=False)
    telling: Telling = field(init=False)
    stage: Stage = field(init=False)
    server: Guarded = field(init=False)
    newest: Told | None = field(default=None, init=False)
    _thinned: str | None = field(default=None, init=False)

    def __post_init__(self) -> None:
        self.talk = Talk(self._hello)
        self.telling = Telling(self.configuration, self.words, self.mode)

    def open(self, port: int) -> None:
        """Begins to serve, and draws what stays.

        Args:
            port: at which; 0: any that is free.

        Raises:
            InputError: the port is taken.
            PackageError: viser is missing.
        """
        answers = answers_of(self.words, str(self.configuration.told.get("site")))
        reaches = () if self.service is None else (f"http://127.0.0.1:{self.service}",)
        self.server = guarded(Guarded(answers, {TEXT: self.talk.serve}, reaches=reaches), port)
        self.stage = Stage(Scene(self.server.viser), self.configuration, self.words("path.name"))
        self.stage.draw()
        _look_from_aside(self.server.viser, self.stage)

    def hear(self, told: Told) -> None:
        """A moment is there: the machine is moved, and cameras count."""
        self.newest = told
        self.telling.rates.hear(told)
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
        cameras = self.telling.cameras(told)
        self.stage.colour(cameras)
        said = self.telling.moment(told, cameras)
        self.talk.tell({"type": "moment", **said, "thinned": self._thinned, **besides})

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
        said = self.telling.why(told, number, changes)
        self.talk.answer(viewer, {"type": "why", "is_final": is_final, **said})

    def fly(self, viewer: Viewer, place: Any) -> None:
        """Turns a browser's view to a place, if it shows the room.

        Args:
            viewer: which browser.
            place: world frame [m]; None: nowhere.
        """
        client = client_of(self.server, viewer.token) if place is not None else None
        if client is not None:
            fly_to(client, np.array(place, dtype=np.float64))

    def _hello(self) -> Mapping[str, Any]:
        said = hello_of(self.configuration, self.words, self.mode)
        return {**said, "service": self.service, **self.extra}


def _look_from_aside(server: Any, stage: Stage) -> None:
    """Where a view begins: from a corner above, at the middle of the box."""
    lower, upper = stage.grid.lower_m, stage.grid.upper_m
    middle = (lower + upper) / 2
    size = float(np.linalg.norm(upper - lower))
    server.initial_camera.position = tuple(middle + size * np.array([0.4, -0.42, 0.17]))
    server.initial_camera.look_at = tuple(middle - np.array([0.0, 0.0, 0.08 * size]))
    server.initial_camera.up = (0.0, 0.0, 1.0)
