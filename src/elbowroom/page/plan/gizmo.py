"""The arrows and rings that take a camera, a person or a thing by hand."""

import math
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from elbowroom.page.plan.layout import Layout
from elbowroom.page.plan.planner import Planner
from elbowroom.page.scene.bodies import wxyz_of

SCALE = 0.45
NAME = "/gizmo"


@dataclass(slots=True, eq=False)
class Gizmo:
    """One gizmo, at what was chosen last.

    Args:
        server: the viser server.
        planner: whose deeds a drag does.
        tried: does a deed and says what hinders it.
    """

    server: Any
    planner: Planner
    tried: Callable[[Callable[[Any], Any]], None]
    _handle: Any = field(default=None, init=False)
    _target: tuple[str, str] | None = field(default=None, init=False)
    _is_held: bool = field(default=False, init=False)

    def at_camera(self, name: str) -> None:
        """Goes to a camera: it can be moved and turned each way.

        Args:
            name: of the camera.
        """
        self._go(("camera", name), {})

    def at_body(self, name: str) -> None:
        """Goes to a person or a thing: it can be moved over the floor and turned.

        Args:
            name: of it.
        """
        limits = ((-10.0, 10.0), (-10.0, 10.0), (-10.0, 10.0))
        upright = ((0.0, 0.0), (0.0, 0.0), (-1000.0, 1000.0))
        self._go(
            ("body", name),
            {"active_axes": (True, True, False), "translation_limits": limits, "rotation_limits": upright},
        )

    def follow(self, layout: Layout, camera: str | None) -> None:
        """Goes where its target went, if it was not itself that moved it.

        Args:
            layout: the plan.
            camera: the chosen one, where nothing was taken in hand yet.
        """
        names = {*layout.camera_names, *layout.body_names}
        if self._target is None or self._target[1] not in names:
            self._leave()
            if camera is not None:
                self.at_camera(camera)
            return
        if not self._is_held:
            self._place(layout)

    def _go(self, target: tuple[str, str], options: dict[str, Any]) -> None:
        if self._target == target:
            return
        self._leave()
        self._target = target
        self._handle = self.server.scene.add_transform_controls(
            NAME, scale=SCALE, line_width=3.5, depth_test=False, **options
        )
        self._place(self.planner.layout)
        self._handle.on_update(self._moved)

    def _leave(self) -> None:
        if self._handle is not None:
            self._handle.remove()
        self._handle, self._target, self._is_held = None, None, False

    def _place(self, layout: Layout) -> None:
        """Puts the gizmo where its target is."""
        if self._target is None or self._handle is None:
            return
        kind, name = self._target
        pose = np.eye(4)
        if kind == "camera":
            pose = layout.camera(name).camera.world_from_camera
        elif any(one.name == name for one in layout.people):
            person = layout.person(name)
            pose = _upright(person.x_m, person.y_m, self.planner.ground.floor_m + 0.05, person.heading_rad)
        else:
            thing = layout.thing(name)
            pose = _upright(thing.x_m, thing.y_m, thing.z_m + 0.05, thing.turn_rad)
        self._handle.position, self._handle.wxyz = pose[:3, 3], wxyz_of(pose[:3, :3])

    async def _moved(self, event: Any) -> None:
        """A hand moves it; in the order in which it does."""
        if event.target is not self._handle or self._target is None:
            return
        self._is_held = event.phase != "end"
        self.tried(lambda _: self._carry(event.target))
        if event.phase == "end":
            self.planner.let_go()

    def _carry(self, handle: Any) -> None:
        assert self._target is not None
        kind, name = self._target
        pose = np.eye(4)
        pose[:3, :3], pose[:3, 3] = _rotation(handle.wxyz), handle.position
        if kind == "camera":
            self.planner.place_camera(name, pose)
            return
        turn = math.atan2(pose[1, 0], pose[0, 0])
        self.planner.move(name, (float(pose[0, 3]), float(pose[1, 3])), turn)


def _upright(x: float, y: float, z: float, turn: float) -> np.ndarray:
    c, s = math.cos(turn), math.sin(turn)
    return np.array([[c, -s, 0, x], [s, c, 0, y], [0, 0, 1, z], [0, 0, 0, 1.0]])


def _rotation(wxyz: Any) -> np.ndarray:
    """Shape (3, 3), of length 1 to the last bit that a rotation needs."""
    from scipy.spatial.transform import Rotation

    w, x, y, z = (float(v) for v in wxyz)
    return np.asarray(Rotation.from_quat([x, y, z, w]).as_matrix())
