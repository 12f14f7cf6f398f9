"""What can be done with a layout: each deed makes a new one, can be undone, and changes nothing if it fails."""

import math
import threading
from collections.abc import Callable
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from elbowroom.errors import InputError
from elbowroom.geometry import looking_at
from elbowroom.page.plan.furniture import thing_of, thing_of_file
from elbowroom.page.plan.ground import Ground
from elbowroom.page.plan.history import History
from elbowroom.page.plan.layout import Layout, PlacedCamera, PlacedPerson, PlacedThing
from elbowroom.page.plan.sensor_choice import Choice, of_kind, tuned
from elbowroom.placement.even import FROM_WALL_M
from elbowroom.placement.sensor import Sensor

CAMERA_HEIGHT_SHARE = 0.83
"""A new camera hangs at this share of the room's height."""
AIM_SHARE = 0.38
"""And looks at the middle at this one."""
MOST_CAMERAS = 255
BEYOND_M = 20.0
"""Nothing is dragged farther than this from the room [m]."""


@dataclass(slots=True, eq=False)
class Planner:
    """A layout, its history, and the deeds. Any thread may call it.

    Args:
        ground: the room.
        first: the layout to begin with; None: the site's.
        on_change: told after each deed, undo and redo.
    """

    ground: Ground
    first: Layout | None = None
    on_change: Callable[[Layout], None] = lambda layout: None
    history: History = field(init=False)
    _lock: threading.RLock = field(default_factory=threading.RLock, init=False)

    def __post_init__(self) -> None:
        self.history = History(self.ground.first_layout() if self.first is None else self.first)

    @property
    def layout(self) -> Layout:
        """The one that holds."""
        return self.history.now

    def undo(self) -> None:
        """Goes back by one deed."""
        with self._lock:
            self.history.undo()
        self.on_change(self.layout)

    def redo(self) -> None:
        """Does again what was undone last."""
        with self._lock:
            self.history.redo()
        self.on_change(self.layout)

    def let_go(self) -> None:
        """A drag has ended."""
        with self._lock:
            self.history.let_go()

    def place_camera(self, name: str, world_from_camera: NDArray[np.float64]) -> None:
        """Drags or turns a camera; a drag is one step of the history.

        Args:
            name: of the camera.
            world_from_camera: shape (4, 4).

        Raises:
            InputError: no such camera, or a place far from the room.
        """
        self._require_near(world_from_camera[:3, 3])
        self._do(lambda now: now.having(now.camera(name).at(world_from_camera)), f"camera {name}")

    def aim_camera(self, name: str, at_m: tuple[float, float, float]) -> None:
        """Turns a camera to a point.

        Args:
            name: of the camera.
            at_m: the point, world frame [m].

        Raises:
            InputError: no such camera, or the point is where it hangs.
        """
        self._do(lambda now: now.having(now.camera(name).looking(at_m)))

    def add_camera(self, sensor: str) -> str:
        """Hangs one more camera where others are farthest away, looking at the middle; its name.

        Args:
            sensor: the name of its kind.

        Raises:
            InputError: no such kind, or too many cameras.
        """
        kind = self._sensor(sensor)
        if len(self.layout.cameras) >= MOST_CAMERAS:
            raise InputError(f"plan: {MOST_CAMERAS} cameras are the most that can be verified")
        name = self.layout.free_name("camera", "_")
        pose = looking_at(self._lonely_place().tolist(), self._middle().tolist())
        self._do(lambda now: now.having(PlacedCamera(kind.at(name, pose), kind.name)))
        return name

    def remove_camera(self, name: str) -> None:
        """Takes a camera away.

        Raises:
            InputError: no such camera.
        """
        self._do(lambda now: now.without(now.camera(name)))

    def choose_sensor(self, name: str, sensor: str) -> None:
        """Makes a camera one of another kind.

        Args:
            name: of the camera.
            sensor: of the kind.

        Raises:
            InputError: no such camera or kind.
        """
        kind = self._sensor(sensor)
        self._do(lambda now: now.having(of_kind(now.camera(name), kind)))

    def tune_camera(self, name: str, choice: Choice) -> None:
        """Gives a camera other noise, another resolution or field of view.

        Args:
            name: of the camera.
            choice: all of it.

        Raises:
            InputError: no such camera, or what no camera can have.
        """
        self._do(lambda now: now.having(tuned(now.camera(name), choice)), f"tune {name}")

    def move_joint(self, name: str, value: float) -> None:
        """Moves a joint of the machine.

        Args:
            name: of the joint.
            value: within its limits [m or rad].

        Raises:
            InputError: no machine, no such joint, or beyond its limits.
        """
        machine = self.ground.machine
        if machine is None:
            raise InputError("plan: the site has no machine")

        def moved(layout: Layout) -> Layout:
            joints = {**layout.joints, machine.joint(name).name: float(value)}
            machine.positions(joints)
            return replace(layout, joints=joints)

        self._do(moved, f"joint {name}")

    def add_person(self, at_m: tuple[float, float] | None = None) -> str:
        """Somebody comes in; the name.

        Args:
            at_m: where, x and y [m]; None: beside the middle of the room.
        """
        name, middle = self.layout.free_name("person"), self._middle()
        x, y = (float(middle[0]) + 0.9, float(middle[1]) - 0.9) if at_m is None else at_m
        self._do(lambda now: now.having(PlacedPerson(name, x, y, math.pi / 2)))
        return name

    def add_thing(self, kind: str) -> str:
        """Furniture comes in; its name.

        Args:
            kind: of `furniture.kinds`.

        Raises:
            InputError: no such kind.
        """
        return self._put(thing_of(kind, self.layout.free_name(kind)))

    def add_file(self, file_name: str, content: bytes) -> str:
        """What a file holds comes in; its name.

        Args:
            file_name: by whose ending it is read.
            content: of the file.

        Raises:
            InputError: it cannot be placed.
        """
        stem = file_name.rpartition("/")[2].rpartition(".")[0][:40] or "thing"
        return self._put(thing_of_file(file_name, content, self.layout.free_name(stem)))

    def move(self, name: str, place: tuple[float, float], turn_rad: float) -> None:
        """Moves somebody or something over the floor.

        Args:
            name: of a person or a thing.
            place: x and y [m].
            turn_rad: about z [rad].

        Raises:
            InputError: neither, or a place far from the room.
        """
        self._require_near(np.array([*place, self.ground.floor_m]))

        def moved(layout: Layout) -> Layout:
            x, y = (float(value) for value in place)
            if any(one.name == name for one in layout.people):
                return layout.having(replace(layout.person(name), x_m=x, y_m=y, heading_rad=turn_rad))
            return layout.having(replace(layout.thing(name), x_m=x, y_m=y, turn_rad=turn_rad))

        self._do(moved, f"move {name}")

    def remove(self, name: str) -> None:
        """Somebody leaves, or something is carried out.

        Raises:
            InputError: neither is there.
        """

        def left(layout: Layout) -> Layout:
            if any(one.name == name for one in layout.people):
                return layout.without(layout.person(name))
            return layout.without(layout.thing(name))

        self._do(left)

    def _put(self, thing: PlacedThing) -> str:
        """Places a thing; what came from elsewhere stands in the middle of the floor."""
        middle = self._middle()
        if thing.z_m <= self.ground.floor_m + 0.5:
            thing = replace(thing, z_m=self.ground.floor_m)
        thing = replace(thing, x_m=float(middle[0]) - 1.0, y_m=float(middle[1]) - 1.0)
        self._do(lambda now: now.having(thing))
        return thing.name

    def _do(self, deed: Callable[[Layout], Layout], during: str | None = None) -> None:
        with self._lock:
            self.history.become(deed(self.layout), during)
        self.on_change(self.layout)

    def _sensor(self, name: str) -> Sensor:
        for sensor in self.ground.sensors:
            if sensor.name == name:
                return sensor
        known = ", ".join(sensor.name for sensor in self.ground.sensors)
        raise InputError(f"sensor: {name!r} is unknown, known are {known}")

    def _middle(self) -> NDArray[np.float64]:
        lower, upper = self.ground.box_m
        return np.array([*((lower + upper) / 2)[:2], lower[2] + AIM_SHARE * (upper[2] - lower[2])])

    def _lonely_place(self) -> NDArray[np.float64]:
        """Of places along the walls, the one that is farthest from all cameras."""
        lower, upper = self.ground.box_m
        z = lower[2] + CAMERA_HEIGHT_SHARE * (upper[2] - lower[2])
        low, high, share = lower[:2] + FROM_WALL_M, upper[:2] - FROM_WALL_M, np.linspace(0.0, 1.0, 9)
        ends = [(low[0] + share * (high[0] - low[0]), low[1] + share * (high[1] - low[1]))]
        ring = [(x, y) for x in ends[0][0] for y in (low[1], high[1])]
        ring += [(x, y) for x in (low[0], high[0]) for y in ends[0][1]]
        places = np.array([(x, y, z) for x, y in ring])
        hung = [placed.camera.centre_in_world for placed in self.layout.cameras]
        if not hung:
            return np.asarray(places[0])
        away = np.linalg.norm(places[:, None] - np.array(hung)[None], axis=2).min(axis=1)
        return np.asarray(places[int(away.argmax())])

    def _require_near(self, place_m: NDArray[np.float64]) -> None:
        lower, upper = self.ground.box_m
        if not (
            np.isfinite(place_m).all()
            and (place_m > lower - BEYOND_M).all()
            and (place_m < upper + BEYOND_M).all()
        ):
            raise InputError(f"plan: {np.round(place_m, 2).tolist()} m is not near the room")
