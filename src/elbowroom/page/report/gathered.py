"""What a report holds: moments in words, and the room at some of them."""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from elbowroom.geometry import DepthCamera, VoxelGrid
from elbowroom.monitor.blackbox.configuration import Configuration
from elbowroom.motion import Level
from elbowroom.page import colours
from elbowroom.page.face import planes_of
from elbowroom.page.live import depth_message
from elbowroom.page.replay.again import Again, Judge
from elbowroom.page.report.packed import Pack, steps_of
from elbowroom.page.report.span import Span
from elbowroom.page.scene.bodies import light_mesh
from elbowroom.page.scene.scene import FRUSTUM_M, KINDS
from elbowroom.page.stage import Stage
from elbowroom.page.story.phrases import level_of
from elbowroom.page.story.requested import end_of_path, level_of_path
from elbowroom.page.story.told import Told
from elbowroom.page.telling import Telling
from elbowroom.view.draw.site import frustum_in_world

MOST_TRIANGLES = 3000
"""Of a link."""
MOST_EXPLAINED = 3
"""Of a moment so many motions that stop are explained by the cameras."""
WAY_EVERY = 3
"""Every so many-th point of a way is kept."""


@dataclass(slots=True, eq=False)
class Gathering:
    """Gathers the moments of a span.

    Args:
        judge: of the recording.
        telling: of its language.
        span: which passes.
        drawn_every_s: the room is drawn so often, and at the moment that it is about [s].
    """

    judge: Judge
    telling: Telling
    span: Span
    drawn_every_s: float
    pack: Pack = field(default_factory=Pack, init=False)
    drawn: int = field(default=0, init=False)
    stage: Stage = field(init=False)
    _drawn_ns: int = field(default=0, init=False)

    def __post_init__(self) -> None:
        self.stage = Stage(None, self.judge.configuration)

    def moments(self, tell: Callable[[int], None]) -> Iterator[dict[str, Any]]:
        """All moments, in words and with what is drawn.

        Args:
            tell: told how many there are by now.
        """
        for number in range(self.span.first, self.span.last + 1):
            told, one = self.judge.told(number)
            self.telling.rates.hear(told)
            said = self.telling.moment(told, self.telling.cameras(told))
            is_about = number == self.span.about
            said |= {"index": number - self.span.first, "wall_s": told["wall_ns"] / 1e9}
            said["poses"] = self._poses(told)
            if is_about or told["wall_ns"] - self._drawn_ns >= 1e9 * self.drawn_every_s:
                self._drawn_ns = told["wall_ns"]
                said |= self._room(told, self.judge.again(told, one))
            if is_about:
                frames = one.snapshot.frames
                said["depth"] = [depth_message(frame.camera, frame.depth_m) for frame in frames]
            tell(said["index"] + 1)
            yield said

    def _room(self, told: Told, again: Again) -> dict[str, Any]:
        """What is drawn of a moment, and why its motions stop."""
        self.drawn += 1
        rows = told["judged"]["verdicts"]
        found: dict[str, Any] = {"whys": self._whys(told, again), "near": None}
        if again.space is not None:
            near, shape = self.stage.near(told, planes_of(again.space)), self.stage.grid.shape
            found["near"] = {kind: self.pack.add(steps_of(getattr(near, kind), shape)) for kind in KINDS}
        ways = ((number, self.stage.way(told, number)[::WAY_EVERY]) for number in range(len(rows)))
        found["ways"] = [
            [level_of(rows[number]).name.lower(), self.pack.add(np.round(100 * way).astype(np.int16))]
            for number, way in ways
            if len(way)
        ]
        path, level = self.stage.path(told)[::WAY_EVERY], level_of_path(told)
        if level is not None and len(path):
            points = self.pack.add(np.round(100 * path).astype(np.int16))
            found["ways"].append([level.name.lower(), points])
        ends = [row["place_m"] for row in rows if level_of(row) is not Level.CLEAR]
        ends += [end["place_m"] for end in (end_of_path(told),) if end is not None]
        found["contacts"] = [place for place in ends if place is not None]
        return found

    def _whys(self, told: Told, again: Again) -> list[dict[str, Any]]:
        rows = told["judged"]["verdicts"]
        stops = [number for number, row in enumerate(rows) if row["level"] == "stop"][:MOST_EXPLAINED]
        return [self.telling.why(told, number, self.judge.changes(again, number)) for number in stops]

    def _poses(self, told: Told) -> int | None:
        """Where the links are: turn and place of each, 12 numbers row by row."""
        machine = self.stage.machine
        if machine is None or told["joints"] is None:
            return None
        poses = machine.world_from_links(told["joints"])
        placed = [poses[link.name][:3] for link in machine.links if link.has_geometry]
        return self.pack.add(np.array(placed, dtype=np.float32))


def still_of(configuration: Configuration, pack: Pack) -> dict[str, Any]:
    """What of the room does not change: box, links, cameras, colours.

    Args:
        configuration: of the run.
        pack: that takes the arrays.
    """
    grid: VoxelGrid = configuration.fields["grid"]
    machine = configuration.machine
    links = []
    for link in () if machine is None else machine.links:
        if link.has_geometry:
            vertices, faces = light_mesh(link.vertices, link.faces, MOST_TRIANGLES)
            links.append(pack.add(vertices[faces].astype(np.float32)))
    shades: Mapping[str, colours.Colour] = {
        **KINDS,
        "contact": colours.CONTACT,
        "machine": colours.MACHINE,
        "box": colours.BOX,
        "camera": colours.CAMERA_WELL,
        "ill": colours.CAMERA_ILL,
        **{level.name.lower(): colour for level, colour in colours.LEVELS.items()},
    }
    return {
        "grid": {"origin": list(grid.origin_m), "shape": list(grid.shape), "voxel": grid.voxel_size_m},
        "links": links,
        "frusta": [_frustum(camera) for camera in configuration.cameras],
        "colours": {name: list(colour) for name, colour in shades.items()},
    }


def _frustum(camera: DepthCamera) -> list[list[float]]:
    """Centre and corners of a camera's frustum [m]."""
    corners: list[list[float]] = frustum_in_world(camera, FRUSTUM_M).round(3).tolist()
    return corners
