"""The cell that faults are thrown at, as a source of snapshots at given times."""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass

import numpy as np

from elbowroom.evaluate.faults.scene import at_s, image_of
from elbowroom.sensing import DepthFrame, Snapshot
from elbowroom.sources import Room


@dataclass(frozen=True, slots=True, eq=False)
class Sliding:
    """The cell that faults are thrown at as a source: a box that slides, before eight cameras.

    Args:
        room: the cell.
        seed: of the noise.
    """

    room: Room
    seed: int

    def at(self, times_s: Iterable[float]) -> Iterator[Snapshot]:
        """A snapshot at each time, as `Simulated.at`."""
        noise = np.random.default_rng(self.seed)
        for time_s in times_s:
            (slide_m, speed_m_s), at_ns = at_s(time_s), round(time_s * 1e9)
            frames = [
                DepthFrame(camera.name, at_ns, image_of(camera, slide_m, noise))
                for camera in self.room.cameras
            ]
            yield Snapshot(tuple(frames), {"slide": slide_m}, now_ns=at_ns, velocities={"slide": speed_m_s})
