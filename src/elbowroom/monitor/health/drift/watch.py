"""The watch over cameras and machine while the monitor runs: it remembers what it found, until it is made anew."""

from collections.abc import Mapping, Sequence
from dataclasses import replace

from elbowroom.geometry import DepthCamera
from elbowroom.geometry.parallel import spread, thread_count
from elbowroom.machine import Machine
from elbowroom.monitor.health.drift.body_watch import BodyWatch
from elbowroom.monitor.health.drift.camera_watch import CameraWatch
from elbowroom.monitor.health.drift.reference import CameraReference, require_references
from elbowroom.monitor.health.drift.shift import Shift
from elbowroom.monitor.health.drift.tolerance import Tolerance
from elbowroom.monitor.health.health import CameraHealth, Condition, Health
from elbowroom.sensing import DepthFrame, Snapshot

BODY = "machine"
"""The key of what is wrong with the machine among `Health.stops`."""
TURNS = 2
"""At each pass one camera in so many is listened to: their motions last, and reading their images takes time."""


class Watch:
    """Compares each frame with the room as it was commissioned, and the machine's body with its joints.

    This is the one place that latches: what was found stays in `Health.stops`, and whoever wants to go on makes a new
    watch, after a look at what it named.

    Args:
        cameras: all of the room.
        references: one of each camera, in any order.
        machine: whose body is looked at; None: cameras alone.
        tolerance: what is not yet called moved.

    Raises:
        CalibrationError: references of other cameras.
    """

    def __init__(
        self,
        cameras: Sequence[DepthCamera],
        references: Sequence[CameraReference],
        machine: Machine | None = None,
        tolerance: Tolerance | None = None,
    ) -> None:
        require_references(references, cameras)
        by_name = {reference.camera: reference for reference in references}
        given = tolerance or Tolerance()
        self._watches = [CameraWatch(camera, by_name[camera.name], given) for camera in cameras]
        self._body = None if machine is None else BodyWatch(machine, cameras)
        self._stops: dict[str, str] = {}
        self.turn = 0
        """The next pass listens to the cameras from this one on, one in `TURNS`."""

    @property
    def references(self) -> tuple[CameraReference, ...]:
        """What the cameras were commissioned on, in the room's order."""
        return tuple(watch.reference for watch in self._watches)

    def shift_of(self, camera: str) -> Shift | None:
        """By how much a camera had moved when that was found; None: it was not.

        Raises:
            KeyError: no camera of this name.
        """
        return {watch.camera.name: watch.shift for watch in self._watches}[camera]

    def hear(self, snapshot: Snapshot) -> Health:
        """Judges the newest frames; where nothing has a time, nothing lasts.

        Raises:
            InputError: an image of another size, joints that are not possible.
        """
        newest = {frame.camera: frame for frame in snapshot.frames}
        cameras = self._hear_cameras(newest, snapshot.now_ns or 0)
        if self._body is not None and snapshot.joints is not None:
            still = {
                health.camera
                for health, watch in zip(cameras, self._watches, strict=True)
                if health.condition is Condition.STILL and watch.stop is None and health.doubt is None
            }
            joints_of = {name: snapshot.joints_at(name) or {} for name in still}
            self._body.hear(newest, joints_of, still)
        for watch in self._watches:
            if watch.stop is not None:
                self._stops.setdefault(watch.camera.name, watch.stop)
        if self._body is not None and self._body.stop is not None:
            self._stops.setdefault(BODY, self._body.stop)
        return Health(cameras, self._body.links if self._body is not None else (), dict(self._stops))

    def _hear_cameras(self, newest: Mapping[str, DepthFrame], now_ns: int) -> tuple[CameraHealth, ...]:
        """Listens to the cameras whose turn it is; of the others, what they said last."""
        many = thread_count()
        turn, self.turn = self._watches[self.turn :: TURNS], (self.turn + 1) % TURNS

        def hear(share: list[CameraWatch]) -> list[CameraHealth]:
            return [watch.hear(newest.get(watch.camera.name), now_ns) for watch in share]

        shares = [turn[first::many] for first in range(many)]
        heard = {health.camera: health for part in spread(hear, shares) for health in part}
        cameras = tuple(
            heard[name] if name in heard else watch.pass_over(newest.get(name), now_ns)
            for watch in self._watches
            for name in [watch.camera.name]
        )
        shown = self._shown(cameras, newest)
        return tuple(replace(each, shows=shown.get(each.camera)) for each in cameras)

    def _shown(self, cameras: Sequence[CameraHealth], newest: Mapping[str, DepthFrame]) -> dict[str, str]:
        """Whose image the cameras show that may be elsewhere, and those whose image they show in turn."""
        watches = {watch.camera.name: watch for watch in self._watches}
        asked = [
            each.camera for each in cameras if each.doubt is not None or watches[each.camera].stop is not None
        ]
        shown: dict[str, str] = {}
        while asked:
            name = asked.pop()
            if name in shown or name not in newest:
                continue
            others = [watch for watch in self._watches if watch.camera.name != name]
            other = watches[name].shows(newest[name], others)
            if other is not None:
                shown[name] = other
                asked.append(other)
        return shown
