"""The panel beside the room: figures, and all that can be done without dragging."""

import math
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import Any

from elbowroom.page.plan.figures import SHARE_PCT
from elbowroom.page.plan.furniture import kinds
from elbowroom.page.plan.ground import Ground
from elbowroom.page.plan.layout import Layout
from elbowroom.page.plan.sensor_choice import FIELDS_DEG, OTHER, RESOLUTIONS, choice_of
from elbowroom.page.plan.worker import Said
from elbowroom.page.words import Words
from elbowroom.sensing import NOISE_PRESETS
from elbowroom.sources.cameras import EXACT

Deed = Callable[[Any], None]
SLIDER_STEPS = 240
UNLIMITED = math.pi
"""A joint without limits has a slider so far each way [m or rad]."""


@dataclass(slots=True, eq=False)
class Panel:
    """Handles of the panel's elements, by name; the deeds are set by who has a planner.

    Args:
        gui: of a viser server.
        ground: the room.
        words: of the language.
        file: the name that a site file is saved under at first.
    """

    gui: Any
    ground: Ground
    words: Words
    file: str
    at: dict[str, Any] = field(default_factory=dict, init=False)
    joints: dict[str, Any] = field(default_factory=dict, init=False)
    _is_filling: bool = field(default=False, init=False)
    _is_troubled: bool = field(default=False, init=False)

    def __post_init__(self) -> None:
        words, gui = self.words, self.gui
        self.at["figures"] = gui.add_markdown(words("plan.reckoning"))
        self.at["message"] = gui.add_markdown(words("plan.ready"))
        for name in ("undo", "redo"):
            self._button(name)
        self.at["file"] = gui.add_text(words("plan.file"), self.file)
        self._button("save")
        with gui.add_folder(words("plan.group.camera")):
            self._camera()
        if self.ground.machine is not None:
            with gui.add_folder(words("plan.group.machine"), expand_by_default=False):
                self._machine()
        with gui.add_folder(words("plan.group.things"), expand_by_default=False):
            self._things()
        with gui.add_folder(words("plan.group.walk"), expand_by_default=False):
            self._walk()
        with gui.add_folder(words("plan.group.show"), expand_by_default=False):
            for name in ("show_invalid", "show_blocked"):
                self.at[name] = gui.add_checkbox(words(f"plan.{name}"), name == "show_invalid")

    def on(self, name: str, deed: Deed) -> None:
        """Says what an element does when somebody uses it; not when the panel fills it in itself.

        Args:
            name: of the element.
            deed: told of viser's event.
        """
        handle = self.joints.get(name) or self.at[name]
        if hasattr(handle, "on_click"):
            handle.on_click(deed)
        elif hasattr(handle, "on_upload"):
            handle.on_upload(deed)
        else:
            handle.on_update(lambda event: None if self._is_filling else deed(event))

    def say(self, text: str) -> None:
        """Writes a message."""
        self.at["message"].content = _plain(text)

    def fill(self, layout: Layout, camera: str | None, other: str | None) -> None:
        """Shows what is chosen, and how it is.

        Args:
            layout: the plan.
            camera: name of the one that is chosen; None: there is none.
            other: name of the person or thing that is chosen; None: there is none.
        """
        self._is_filling = True
        try:
            self._fill_camera(layout, camera)
            names = (self.words("plan.nobody"), *layout.body_names)
            _set_options(self.at["chosen"], names, other or names[0])
            for name, slider in self.joints.items():
                _set(slider, self._shown(name, layout.joints[name]))
        finally:
            self._is_filling = False

    def show_figures(self, said: Said) -> None:
        """Writes the figures of a layout, or why it has none.

        Args:
            said: by the worker.
        """
        words, figures = self.words, said.figures
        if figures is None:
            self.say(words("plan.trouble", text=said.trouble))
            self.at["figures"].content = words("plan.no_figures")
            self._is_troubled = True
            return
        if self._is_troubled:
            self.say(words("plan.ready"))
        self._is_troubled = False
        if figures.cameras == 0:
            self.at["figures"].content = words("plan.no_camera")
            return
        quality = words(
            "plan.exact" if figures.is_exact else "plan.coarse",
            edge=words.number(figures.voxel_size_m * 100, 1),
        )
        smallest = words("plan.nowhere")
        if math.isfinite(figures.smallest_mm):
            smallest = words("plan.millimetres", value=words.number(figures.smallest_mm, 0))
        needed = self.ground.requirement
        self.at["figures"].content = words(
            "plan.figures",
            quality=quality,
            cameras=figures.cameras,
            seen=words.number(figures.seen_pct, 1),
            valid=words.number(figures.valid_pct, 1),
            requirement=f"{needed.views} × {needed.angle_deg:g}°",
            share=words.number(SHARE_PCT, 0),
            smallest=smallest,
            free=words.number(figures.free_pct, 1),
            price=words.number(figures.price, 0) if self.ground.has_prices else words("plan.no_price"),
        )

    def value_of(self, joint: str) -> float:
        """Where a slider stands [m or rad].

        Args:
            joint: its name.
        """
        assert self.ground.machine is not None
        of, value = self.ground.machine.joint(joint), float(self.joints[joint].value)
        value = math.radians(value) if of.unit == "rad" else value
        return min(max(value, of.lower), of.upper)  # rounding of degrees may lead beyond a limit

    def _shown(self, joint: str, value: float) -> float:
        """A position as its slider shows it."""
        assert self.ground.machine is not None
        return round(math.degrees(value) if self.ground.machine.joint(joint).unit == "rad" else value, 4)

    def _button(self, name: str) -> None:
        self.at[name] = self.gui.add_button(self.words(f"plan.{name}"))

    def _camera(self) -> None:
        words, gui = self.words, self.gui
        none = words("plan.nobody")
        self.at["camera"] = gui.add_dropdown(words("plan.camera"), (none,))
        sensors = tuple(sensor.name for sensor in self.ground.sensors)
        self.at["sensor"] = gui.add_dropdown(words("plan.sensor"), sensors)
        self.at["noise"] = gui.add_dropdown(words("plan.noise"), (EXACT, *NOISE_PRESETS, OTHER))
        self.at["resolution"] = gui.add_dropdown(
            words("plan.resolution"), tuple(f"{width}x{height}" for width, height in RESOLUTIONS)
        )
        low, high = FIELDS_DEG
        self.at["field"] = gui.add_slider(words("plan.field"), low, high, 1.0, 90.0)
        for name in ("add_camera", "aim", "remove_camera"):
            self._button(name)

    def _machine(self) -> None:
        machine, words = self.ground.machine, self.words
        assert machine is not None
        for name in machine.joint_names:
            joint = machine.joint(name)
            low, high = (max(joint.lower, -UNLIMITED), min(joint.upper, UNLIMITED))
            low, high = self._shown(name, low), self._shown(name, high)
            unit = "°" if joint.unit == "rad" else "m"
            label = words("plan.joint", name=name, unit=unit)
            step = round((high - low) / SLIDER_STEPS, 6)
            self.joints[name] = self.gui.add_slider(label, low, high, step, min(max(0.0, low), high))
        self.at["which_joint"] = self.gui.add_dropdown(words("plan.which_joint"), machine.joint_names)
        self.at["way"] = self.gui.add_dropdown(words("plan.way"), ("+", "-"))
        self._button("drive")

    def _things(self) -> None:
        words, gui = self.words, self.gui
        self._button("add_person")
        self.at["kind"] = gui.add_dropdown(words("plan.kind"), kinds())
        self._button("add_thing")
        self.at["upload"] = gui.add_upload_button(words("plan.upload"))
        self.at["chosen"] = gui.add_dropdown(words("plan.chosen"), (words("plan.nobody"),))
        self._button("remove")

    def _walk(self) -> None:
        words, gui = self.words, self.gui
        lower, upper = self.ground.box_m[:, :2]
        start, end = (lower + 0.2 * (upper - lower), lower + 0.8 * (upper - lower))
        self.at["from"] = gui.add_vector2(words("plan.from"), (round(start[0], 2), round(start[1], 2)))
        self.at["to"] = gui.add_vector2(words("plan.to"), (round(end[0], 2), round(start[1], 2)))
        for name in ("walk", "floor"):
            self._button(name)
        gui.add_markdown(words("plan.legend"))

    def _fill_camera(self, layout: Layout, camera: str | None) -> None:
        none = self.words("plan.nobody")
        _set_options(self.at["camera"], layout.camera_names or (none,), camera or none)
        if camera is None:
            return
        placed = layout.camera(camera)
        choice = choice_of(placed.camera)
        known = tuple(sensor.name for sensor in self.ground.sensors)
        _set_options(
            self.at["sensor"], known if placed.sensor in known else (*known, placed.sensor), placed.sensor
        )
        _set(self.at["noise"], choice.noise)
        sizes = tuple(f"{width}x{height}" for width, height in RESOLUTIONS)
        size = f"{choice.size_px[0]}x{choice.size_px[1]}"
        _set_options(self.at["resolution"], sizes if size in sizes else (*sizes, size), size)
        low, high = FIELDS_DEG
        _set(self.at["field"], min(max(round(choice.field_deg), low), high))

    def choice(self, layout: Layout, camera: str) -> Any:
        """What is chosen of a camera in the panel.

        Args:
            layout: the plan.
            camera: name of the camera.
        """
        was = choice_of(layout.camera(camera).camera)
        width, _, height = self.at["resolution"].value.partition("x")
        shown = round(was.field_deg)
        field_deg = was.field_deg if self.at["field"].value == shown else float(self.at["field"].value)
        return replace(
            was, noise=self.at["noise"].value, size_px=(int(width), int(height)), field_deg=field_deg
        )


def _set(handle: Any, value: Any) -> None:
    if handle.value != value:
        handle.value = value


def _set_options(handle: Any, options: tuple[str, ...], value: str) -> None:
    if tuple(handle.options) != options:
        handle.options = options
    _set(handle, value)


def _plain(text: str) -> str:
    """Text that markdown shows as it is."""
    for sign in "\\`*_{}[]<>#|!":
        text = text.replace(sign, f"\\{sign}" if sign not in "<>" else ("&lt;" if sign == "<" else "&gt;"))
    return text
