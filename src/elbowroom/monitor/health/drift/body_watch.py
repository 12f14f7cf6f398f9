"""Watches whether the machine is where its joints say."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from elbowroom.geometry import DepthCamera
from elbowroom.geometry.parallel import spread
from elbowroom.machine import Machine
from elbowroom.monitor.health.drift.body_view import BodySpots, BodyView
from elbowroom.monitor.health.drift.link_spots import LinkSpots
from elbowroom.monitor.health.drift.sequential import Tally
from elbowroom.monitor.health.health import LinkHealth
from elbowroom.sensing import DepthFrame

ROUND = 20
"""Passes in which every camera has looked at the machine once, and every link was judged."""
ROUNDS = 2
"""So many more rounds must say that a link is off than say, counted twice, that it is not."""


@dataclass(slots=True, eq=False)
class BodyWatch:
    """Looks through some cameras at each pass, and judges some of the machine's links by what all showed last.

    Args:
        machine: the machine.
        cameras: of the room.
    """

    machine: Machine
    cameras: Sequence[DepthCamera]
    stop: str | None = field(default=None, init=False)
    """Why nothing may move, once it was found; it stays."""
    _links: dict[str, LinkHealth] = field(default_factory=dict, init=False)
    _views: dict[str, BodyView] = field(init=False)
    _seen: dict[str, BodySpots] = field(default_factory=dict, init=False)
    _tallies: list[Tally] = field(init=False)
    _turn: int = field(default=0, init=False)

    def __post_init__(self) -> None:
        self._views = {camera.name: BodyView(camera, self.machine) for camera in self.cameras}
        self._tallies = [Tally(ROUNDS) for _ in self.machine.links]

    def hear(
        self, frames: Mapping[str, DepthFrame], joints_of: Mapping[str, Mapping[str, float]], still: set[str]
    ) -> None:
        """Looks through the cameras whose turn it is.

        Args:
            frames: by camera.
            joints_of: joint positions at each frame's time, by camera [m or rad].
            still: names of the cameras that stand where they were commissioned; others are not believed.

        Raises:
            MachineError: joints that are not possible.
        """
        names = [camera.name for camera in self.cameras][self._turn :: ROUND]
        looking = [name for name in names if name in frames and name in still]
        for name in names:
            self._seen.pop(name, None)
        if looking:
            positions = np.array([self.machine.positions(joints_of[name]) for name in looking])
            placed = self.machine.world_from_link_array(positions)

            def look(number: int) -> BodySpots:
                name = looking[number]
                return self._views[name].look(frames[name].depth_m, placed[number])

            looked = spread(look, range(len(looking)))
            self._seen.update(zip(looking, looked, strict=True))
        for number in range(self._turn, len(self._tallies), ROUND):
            self._judge(number, still)
        self._turn = (self._turn + 1) % ROUND

    @property
    def links(self) -> tuple[LinkHealth, ...]:
        """What was said last of the links that some camera sees, from the base on."""
        return tuple(self._links[link.name] for link in self.machine.links if link.name in self._links)

    def _judge(self, number: int, still: set[str]) -> None:
        name = self.machine.links[number].name
        self._links.pop(name, None)
        seen = {camera: spots for camera, spots in self._seen.items() if camera in still}
        spots = LinkSpots.of(number, seen)
        health = None if spots is None else spots.health(name)
        if health is not None:
            self._links[name] = health
        decided = self._tallies[number].add(None if health is None else health.is_off)
        if decided and self.stop is None:
            self.stop = self._reason()

    def _reason(self) -> str:
        """Names the link nearest to the base that is off: those behind it are carried along."""
        suspects = [
            self._links[link.name]
            for link, tally in zip(self.machine.links, self._tallies, strict=True)
            if tally.score > 0 and link.name in self._links and self._links[link.name].is_off
        ]
        first = suspects[0]
        return (
            f"the machine is not where its joints say: {first.link} is off by {first.off_m * 1e3:.0f} mm, "
            f"as {len(first.cameras)} cameras see it"
        )
