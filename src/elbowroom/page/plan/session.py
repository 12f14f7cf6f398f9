"""A plan in a browser: what hands do becomes deeds, what deeds change is drawn, reckoned and kept."""

import functools
import threading
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from elbowroom.errors import ElbowroomError, InputError
from elbowroom.page.plan.drawn import Drawn
from elbowroom.page.plan.errands import Errands
from elbowroom.page.plan.figures import Reckoner
from elbowroom.page.plan.gizmo import Gizmo
from elbowroom.page.plan.ground import Ground
from elbowroom.page.plan.layout import Layout
from elbowroom.page.plan.panel import Panel
from elbowroom.page.plan.planner import Planner
from elbowroom.page.plan.saved import keep, kept, save_site
from elbowroom.page.plan.uploads import limited
from elbowroom.page.plan.worker import Said, Worker
from elbowroom.page.server import Guarded
from elbowroom.page.words import Words

PLAN_FILE = ".plan.json"
KEEPS_S = 0.5
"""After so much rest a plan is kept [s]."""


@dataclass(slots=True, eq=False)
class Session:
    """One plan, as all browsers that have the page open see it.

    Args:
        server: a viser server behind its door.
        ground: the room.
        words: of the language.
        out: where the site file goes, if nobody says otherwise; the plan's own file lies beside it.
        is_fresh: begin anew, whatever plan was kept.
    """

    server: Any
    ground: Ground
    words: Words
    out: Path
    is_fresh: bool = False
    planner: Planner = field(init=False)
    panel: Panel = field(init=False)
    drawn: Drawn = field(init=False)
    gizmo: Gizmo = field(init=False)
    errands: Errands = field(init=False)
    worker: Worker = field(init=False)
    page: Guarded | None = field(default=None, init=False)
    """The server's door, where it has one."""
    camera: str | None = field(default=None, init=False)
    other: str | None = field(default=None, init=False)
    newest: Said | None = field(default=None, init=False)
    _doing: threading.RLock = field(default_factory=threading.RLock, init=False)
    """The server hands on what is clicked in threads of its own: one deed is done before the next begins."""
    _drawing: threading.RLock = field(default_factory=threading.RLock, init=False)
    _keeping: threading.Timer | None = field(default=None, init=False)
    _reckoned: Reckoner | None = field(default=None, init=False)

    def __post_init__(self) -> None:
        begun = None if self.is_fresh else kept(self.kept_at, self.ground)
        self.planner = Planner(self.ground, begun, self._changed)
        self.panel = Panel(self.server.gui, self.ground, self.words, self.out.name)
        self.drawn = Drawn(self.server, self.ground, self.choose)
        self.gizmo = Gizmo(self.server, self.planner, self._tried)
        self.errands = Errands(self.planner, self.drawn, self.panel, self.words)
        self.worker = Worker(Reckoner(self.ground, False), Reckoner(self.ground, True), self._heard)
        limited(self.server, self._refused)
        self._wire()
        if begun is not None:
            self.panel.say(self.words("plan.resumed", path=self.kept_at.name))

    @property
    def kept_at(self) -> Path:
        """The plan's own file."""
        return self.out.with_name(self.out.stem + PLAN_FILE)

    def start(self) -> None:
        """Draws and reckons the plan as it is."""
        cameras = self.planner.layout.cameras
        self.camera = cameras[0].name if cameras else None
        self.worker.start()
        self._changed(self.planner.layout)

    def stop(self) -> None:
        """Keeps the plan, and ends."""
        self.errands.stop()
        self.worker.stop()
        if self._keeping is not None:
            self._keeping.cancel()
        self.keep()

    def keep(self) -> None:
        """Writes the plan's own file."""
        keep(self.planner.layout, self.ground.site.path, self.kept_at)

    def choose(self, name: str) -> None:
        """Takes something in hand: the gizmo goes there.

        Args:
            name: of a camera, a person or a thing.
        """
        layout = self.planner.layout
        if name in layout.camera_names:
            self.camera = name
            self.gizmo.at_camera(name)
        else:
            self.other = name
            self.gizmo.at_body(name)
        self._show(layout)

    def _wire(self) -> None:
        planner, panel = self.planner, self.panel
        deeds: dict[str, Callable[[Any], Any]] = {
            "undo": lambda _: planner.undo(),
            "redo": lambda _: planner.redo(),
            "save": lambda _: self._save(),
            "camera": lambda _: self._choose_camera(),
            "sensor": lambda _: planner.choose_sensor(self._camera(), panel.at["sensor"].value),
            "add_camera": lambda _: self.choose(planner.add_camera(panel.at["sensor"].value)),
            "remove_camera": lambda _: planner.remove_camera(self._camera()),
            "aim": lambda _: planner.aim_camera(self._camera(), self._middle()),
            "add_person": lambda _: self.choose(planner.add_person()),
            "add_thing": lambda _: self.choose(planner.add_thing(panel.at["kind"].value)),
            "upload": lambda event: self._upload(event.target.value),
            "chosen": lambda _: self._choose_other(),
            "remove": lambda _: planner.remove(self._other()),
            "walk": lambda _: self.errands.walk(),
            "floor": lambda _: self.errands.floor(),
            "show_invalid": lambda _: self._overlay(),
            "show_blocked": lambda _: self._overlay(),
        }
        for name in ("noise", "resolution", "field"):
            deeds[name] = lambda _: planner.tune_camera(
                self._camera(), panel.choice(planner.layout, self._camera())
            )
        if self.ground.machine is not None:
            deeds["drive"] = lambda _: self.errands.drive()
        for joint in panel.joints:
            deeds[joint] = functools.partial(self._move_joint, joint)
        for name, deed in deeds.items():
            panel.on(name, functools.partial(self._tried, deed))

    def _move_joint(self, joint: str, _: Any) -> None:
        self.planner.move_joint(joint, self.panel.value_of(joint))

    def _tried(self, deed: Callable[[Any], Any], event: Any = None) -> None:
        """Does a deed; what hinders it is said on the page, and the plan stays as it was."""
        try:
            with self._doing:
                deed(event)
        except (ElbowroomError, OSError) as error:
            self.panel.say(self.words("plan.trouble", text=" ".join(str(error).split())))
            self._show(self.planner.layout)

    def _changed(self, layout: Layout) -> None:
        """A deed was done."""
        names = layout.camera_names
        if self.camera not in names:
            self.camera = names[0] if names else None
        if self.other not in layout.body_names:
            self.other = None
        self.worker.give(layout)
        self.errands.forget()
        self._show(layout)
        if self._keeping is not None:
            self._keeping.cancel()
        self._keeping = threading.Timer(KEEPS_S, self._tried, [lambda _: self.keep()])
        self._keeping.daemon = True
        self._keeping.start()

    def _show(self, layout: Layout) -> None:
        with self._drawing:
            self.drawn.draw(layout)
            self.drawn.choose(self.camera)
            self.gizmo.follow(layout, self.camera)
            self.panel.fill(layout, self.camera, self.other)

    def _heard(self, said: Said) -> None:
        """The worker has figures."""
        self.newest = said
        self.panel.show_figures(said)
        if said.figures is not None:
            self._reckoned = self.worker.exact if said.figures.is_exact else self.worker.coarse
            self._overlay()

    def _overlay(self) -> None:
        """Places that are not valid, and blocked space, as far as they shall be shown."""
        reckoned = self._reckoned
        shows_invalid, shows_blocked = (
            self.panel.at[f"show_{name}"].value for name in ("invalid", "blocked")
        )
        self.drawn.show_invalid(reckoned if shows_invalid else None)
        self.drawn.show_blocked(reckoned if shows_blocked else None, self.planner.layout)

    def _save(self) -> None:
        name = self.panel.at["file"].value.strip()
        if not name or Path(name).name != name:
            raise InputError(f"{name!r}: write a file name, without a folder; it goes into {self.out.parent}")
        written = save_site(self.ground, self.planner.layout, self.out.with_name(name))
        self.keep()
        self.panel.say(self.words("plan.saved", path=str(written.path), notes="; ".join(written.notes)))

    def _upload(self, file: Any) -> None:
        self.choose(self.planner.add_file(str(file.name), bytes(file.content)))

    def _refused(self, name: str, size: int, most: int) -> None:
        """A file that is too large is not taken in."""
        sizes = {"size": self.words.number(size / 1e6, 0), "most": self.words.number(most / 1e6, 0)}
        text = self.words("plan.too_large", name=name, **sizes)
        self.panel.say(self.words("plan.trouble", text=text))

    def _choose_camera(self) -> None:
        name = self.panel.at["camera"].value
        if name in self.planner.layout.camera_names:
            self.choose(name)

    def _choose_other(self) -> None:
        name = self.panel.at["chosen"].value
        if name in self.planner.layout.body_names:
            self.choose(name)

    def _camera(self) -> str:
        if self.camera is None:
            raise InputError("no camera is chosen")
        return self.camera

    def _other(self) -> str:
        if self.other is None:
            raise InputError("no person or thing is chosen")
        return self.other

    def _middle(self) -> tuple[float, float, float]:
        lower, upper = self.ground.grid.lower_m, self.ground.grid.upper_m
        x, y, z = (float(v) for v in (lower + upper) / 2 - np.array([0, 0, 0.1 * (upper[2] - lower[2])]))
        return x, y, z
