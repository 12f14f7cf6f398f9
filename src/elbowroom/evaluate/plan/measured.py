"""From a drag to its figures, in rooms of the package: the first answer, and the exact one."""

import threading
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from elbowroom.evaluate.due import Due
from elbowroom.page.plan.figures import Reckoner
from elbowroom.page.plan.ground import Ground
from elbowroom.page.plan.layout import Layout, PlacedCamera
from elbowroom.page.plan.package_room import package_room
from elbowroom.page.plan.planner import Planner
from elbowroom.page.plan.worker import Said, Worker
from elbowroom.placement import even_cameras

DUE = (
    Due("coarse_ms", "≤", 300.0, words="drag to the first figures"),
    Due("exact_ms", "≤", 1000.0, words="drag to the exact figures"),
)
ROOMS = ("simulated", "thesis")
TIMES = 12
CAMERAS = 21
WAITS_S = 120.0
DRAG_M = 0.02

Tell = Callable[[str], None]
Deed = Callable[[Planner, int], None]


@dataclass(slots=True, eq=False)
class Hand:
    """A plan that is changed, and whose figures are waited for.

    Args:
        ground: the room.
        layout: to begin with.
    """

    ground: Ground
    layout: Layout
    planner: Planner = field(init=False)
    worker: Worker = field(init=False)
    _said: list[Said] = field(default_factory=list, init=False)
    _news: threading.Condition = field(default_factory=threading.Condition, init=False)

    def __post_init__(self) -> None:
        self.worker = Worker(Reckoner(self.ground, False), Reckoner(self.ground, True), self._hear)
        self.planner = Planner(self.ground, self.layout, self.worker.give)
        self.worker.start()
        self.worker.give(self.layout)
        self._waited(self.layout)

    def after(self, deed: Deed, number: int) -> tuple[float, float]:
        """How long the first and the exact figures take [ms].

        Args:
            deed: what is done.
            number: of how often it was done before.
        """
        begun_s = time.perf_counter()
        deed(self.planner, number)
        handed_ms = 1e3 * (time.perf_counter() - begun_s)
        coarse, exact = self._waited(self.planner.layout)
        return coarse.seconds * 1e3 + handed_ms, exact.seconds * 1e3 + handed_ms

    def _hear(self, said: Said) -> None:
        with self._news:
            self._said.append(said)
            self._news.notify()

    def _waited(self, layout: Layout) -> tuple[Said, Said]:
        """The two answers of a layout.

        Raises:
            RuntimeError: it has no figures, or they do not come.
        """
        until_s = time.monotonic() + WAITS_S
        with self._news:
            while True:
                own = [said for said in self._said if said.layout is layout]
                for said in own:
                    if said.figures is None:
                        raise RuntimeError(f"no figures: {said.trouble}")
                if len(own) == 2:
                    self._said.clear()
                    return own[0], own[1]
                if not self._news.wait(max(0.0, until_s - time.monotonic())):
                    raise RuntimeError("no figures came")


def plan_rows(times: int, tell: Tell) -> Iterator[dict[str, Any]]:
    """A row for each room and deed: medians and worst [ms].

    Args:
        times: how often each deed is done.
        tell: told what is being done.
    """
    for name in ROOMS:
        ground = Ground.of(package_room(name))
        tell(f"{name}: the first figures")
        hand = Hand(ground, _begun(ground))
        for deed, does in DEEDS.items():
            if deed == "joint" and ground.machine is None:
                continue
            tell(f"{name}: {deed}")
            took = np.array([hand.after(does, number) for number in range(times)])
            yield {
                "kind": "plan",
                "room": name,
                "deed": deed,
                "cameras": len(hand.planner.layout.cameras),
                "voxel_size_m": hand.worker.exact.grid.voxel_size_m,
                "times": times,
                "coarse_ms": float(np.median(took[:, 0])),
                "coarse_worst_ms": float(took[:, 0].max()),
                "exact_ms": float(np.median(took[:, 1])),
                "exact_worst_ms": float(took[:, 1].max()),
            }
        hand.worker.stop()


def _begun(ground: Ground) -> Layout:
    """The room's cameras; where it has none, as many along its walls."""
    layout = ground.first_layout()
    if layout.cameras:
        return layout
    sensor = ground.sensors[0]
    cameras = even_cameras(ground.box_m, sensor, CAMERAS, heights_m=(2.4, 0.4))
    return replace(layout, cameras=tuple(PlacedCamera(camera, sensor.name) for camera in cameras))


def _drag_camera(planner: Planner, number: int) -> None:
    placed = planner.layout.cameras[number % len(planner.layout.cameras)]
    pose = placed.camera.world_from_camera.copy()
    away = planner.ground.box_m.mean(axis=0) - pose[:3, 3]
    # so little that it is not dragged into furniture
    pose[:3, 3] += DRAG_M * away / np.linalg.norm(away)
    planner.place_camera(placed.name, pose)


def _move_person(planner: Planner, number: int) -> None:
    if not planner.layout.people:
        planner.add_person((0.9, -0.9))
        return
    planner.move("person 1", (0.9 - 0.02 * number, -0.9), 0.1 * number)


def _move_joint(planner: Planner, number: int) -> None:
    machine = planner.ground.machine
    assert machine is not None
    joint = machine.joint(machine.joint_names[number % len(machine.joint_names)])
    here = planner.layout.joints[joint.name]
    planner.move_joint(joint.name, min(max(here + 0.02, joint.lower), joint.upper))


DEEDS: dict[str, Deed] = {"camera": _drag_camera, "person": _move_person, "joint": _move_joint}
"""What is done: a camera dragged, a person moved, a joint moved."""
