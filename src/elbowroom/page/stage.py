"""What a moment looks like: it is brought into the scene, whoever tells it."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from elbowroom.geometry import VoxelGrid
from elbowroom.machine import Machine
from elbowroom.monitor.blackbox.configuration import Configuration
from elbowroom.motion import Level
from elbowroom.page.scene.bodies import link_points, points_in_world
from elbowroom.page.scene.near import Near, Planes, near_of
from elbowroom.page.scene.scene import Scene
from elbowroom.page.scene.ways import swept_points, way_points
from elbowroom.page.story.phrases import level_of, name_of
from elbowroom.page.story.requested import end_of_path, level_of_path, poses_of_path
from elbowroom.page.story.told import Told


@dataclass(slots=True, eq=False)
class Stage:
    """Brings moments of a run into a scene.

    Args:
        scene: that is drawn into; None: nobody looks, as for a report.
        configuration: of the run.
        path_name: what the path that was asked for is called where it first meets something.
    """

    scene: Scene | None
    configuration: Configuration
    path_name: str = "path"
    grid: VoxelGrid = field(init=False)
    machine: Machine | None = field(init=False)
    shown_ways: frozenset[int] = field(default=frozenset(), init=False)
    """Numbers of motions whose way is shown though they are clear."""
    shows_clear: bool = field(default=False, init=False)
    """Whether all ways are shown."""
    _points: dict[str, NDArray[np.float64]] = field(default_factory=dict, init=False)

    def __post_init__(self) -> None:
        self.grid, self.machine = self.configuration.fields["grid"], self.configuration.machine
        if self.machine is not None:
            self._points = link_points(self.machine)

    def draw(self) -> None:
        """Draws what stays."""
        assert self.scene is not None
        self.scene.draw_light()
        self.scene.draw_box(self.grid)
        if self.machine is not None:
            self.scene.draw_machine(self.machine)
        self.scene.draw_cameras(self.configuration.cameras)

    def near(self, told: Told, planes: Planes) -> Near:
        """Blocked space near the machine.

        Args:
            told: the moment.
            planes: of its free space.
        """
        return near_of(self.grid, planes, self._machine_at(told))

    def place(self, told: Told) -> None:
        """Moves the machine to where it is."""
        if self.scene is not None and self.machine is not None and told["joints"] is not None:
            self.scene.place_machine(self.machine.world_from_links(told["joints"]))

    def colour(self, rows: Sequence[dict[str, Any]]) -> None:
        """Shows which cameras are well.

        Args:
            rows: of `story.cameras.camera_rows`.
        """
        assert self.scene is not None
        for row in rows:
            self.scene.colour_camera(row["name"], row["is_well"])

    def show_ways(self, told: Told) -> None:
        """Shows the swept volumes of the motions, and their first contacts."""
        assert self.scene is not None
        rows = told["judged"]["verdicts"]
        for number, row in enumerate(rows):
            self.scene.show_way(number, self.way(told, number), level_of(row))
        self.scene.show_path(self.path(told), level_of_path(told) or Level.CLEAR)
        ends = [row for row in rows if row["place_m"] is not None and level_of(row) is not Level.CLEAR]
        by_place: dict[tuple[float, float, float], list[str]] = {}
        for row in ends:
            x, y, z = row["place_m"]
            by_place.setdefault((x, y, z), []).append(name_of(row))
        end = end_of_path(told)
        if end is not None and end["place_m"] is not None:
            x, y, z = end["place_m"]
            by_place.setdefault((x, y, z), []).append(self.path_name)
        self.scene.show_contacts([(", ".join(names), place) for place, names in by_place.items()])

    def way(self, told: Told, number: int) -> NDArray[np.float64]:
        """The swept volume of a motion as points, shape (n, 3) [m]; none where it is clear and nobody asked.

        Args:
            told: the moment.
            number: of the motion.
        """
        row = told["judged"]["verdicts"][number]
        is_wanted = level_of(row) is not Level.CLEAR or number in self.shown_ways or self.shows_clear
        if self.machine is None or told["joints"] is None or row["direction"] is None or not is_wanted:
            return np.zeros((0, 3))
        by = row["free_travel"] * (1 if row["direction"] == "+" else -1)
        return way_points(self.machine, self._points, told["joints"], (row["joint"], by))

    def path(self, told: Told) -> NDArray[np.float64]:
        """The swept volume of the path that was asked for as points, shape (n, 3) [m]; none: there is none.

        Args:
            told: the moment.
        """
        if self.machine is None or told["joints"] is None or level_of_path(told) is None:
            return np.zeros((0, 3))
        return swept_points(self.machine, self._points, told["joints"], poses_of_path(told))

    def _machine_at(self, told: Told) -> NDArray[np.float64]:
        """Points on the machine where it is, shape (n, 3), world frame [m]; none: there is none, or nobody knows."""
        if self.machine is None or told["joints"] is None:
            return np.zeros((0, 3))
        return points_in_world(self.machine, self._points, told["joints"])
