"""A room whose cameras were commissioned, and the frames that its watch hears."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any

from elbowroom.geometry import DepthCamera
from elbowroom.monitor.health.drift.commission import Commissioning
from elbowroom.monitor.health.drift.reference import CameraReference
from elbowroom.monitor.health.drift.watch import Watch
from elbowroom.sensing import NOISE_PRESETS, DepthFrame, Snapshot
from elbowroom.simulate import InterventionRoom, Moment, Optics, render, wall_cameras
from elbowroom.simulate.inside import hung_clear
from elbowroom.simulate.person import Person, Walk
from elbowroom.simulate.room import STAFF

PERIOD_S = 1 / 30
HEIGHTS_M = (2.4, 0.4)
RANGE = Optics(min_depth_m=0.1, max_depth_m=8.0)
COMMISSION_FRAMES = 20
KNOCKED_FRAMES = 60
"""2 s: by then a knock must have been named."""
BEFORE = 6
"""Frames before the knock."""
VISITORS = (
    Person("visitor 1", Walk((0.0, -1.45), (1.5, 0.25), 16.0, start_rad=0.4), 1.85),
    Person("visitor 2", Walk((-1.6, 0.1), (0.2, 1.3), 13.0, start_rad=2.0), 1.60),
)
"""Who else walks, close to the walls and cameras, where false alarms are looked for."""
Tell = Callable[[str], None]


@dataclass(frozen=True, slots=True, eq=False)
class Commissioned:
    """A room whose cameras have a reference.

    Args:
        room: with people.
        cameras: along its walls.
        references: of these.
        noise: name of the cameras' noise.
    """

    room: InterventionRoom
    cameras: tuple[DepthCamera, ...]
    references: tuple[CameraReference, ...]
    noise: str

    def watch(self) -> Watch:
        """A new watch over it."""
        return Watch(self.cameras, self.references, self.room.machine)

    @property
    def words(self) -> dict[str, Any]:
        """What rows say of it."""
        first = self.cameras[0]
        return {
            "cameras": len(self.cameras), "width": first.width, "height": first.height, "noise": self.noise,
        }  # fmt: skip


def commissioned(
    noise: str, width: int = 160, height: int = 120, count: int = 21, staff: Sequence[Person] = STAFF
) -> Commissioned:
    """The simulated room with cameras at two heights in turn, commissioned over 14 s.

    Args:
        noise: name of the sensors' noise.
        width, height: of the images [px].
        count: how many cameras.
        staff: who walks.
    """
    room = InterventionRoom(staff=staff)
    hung = wall_cameras(count, HEIGHTS_M, width, height, noise=NOISE_PRESETS.get(noise), optics=RANGE)
    return commissioned_by(hung_clear(hung, room.solids), room, noise)


def commissioned_by(cameras: tuple[DepthCamera, ...], room: InterventionRoom, noise: str) -> Commissioned:
    """The simulated room with these cameras, commissioned over 14 s.

    Args:
        cameras: with their noise.
        room: with the people who walk.
        noise: what it is called.
    """
    commissioning = Commissioning(cameras, room.machine, COMMISSION_FRAMES)
    for number in range(COMMISSION_FRAMES):
        moment = room.at(200 + 0.7 * number)
        commissioning.add(Snapshot.taken(render(cameras, moment, seed=number), moment.joints))
    return Commissioned(room, cameras, commissioning.references(), noise)


def frames_of(cameras: Sequence[DepthCamera], moment: Moment, seed: int) -> list[DepthFrame]:
    """Frames with noise of their own, other than those that were commissioned.

    Args:
        cameras: that look.
        moment: what is there.
        seed: of the noise.
    """
    return render(cameras, moment, seed=10_000 + seed)


def joints_of(scene: Commissioned, start_s: float, count: int) -> Iterator[dict[str, float]]:
    """Joint positions of so many moments at 30 Hz [m or rad].

    Args:
        scene: whose machine.
        start_s: of the room's time [s].
        count: how many moments.
    """
    return (scene.room.at(start_s + k * PERIOD_S).joints for k in range(count))
