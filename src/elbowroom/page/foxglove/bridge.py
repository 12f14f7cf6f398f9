"""Topics of a room on a Foxglove server: sent where somebody subscribed, and not otherwise."""

import threading
import time
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from elbowroom.extras import package
from elbowroom.monitor.blackbox.configuration import Configuration
from elbowroom.page.foxglove import topics
from elbowroom.page.foxglove.blocked import blocked_of
from elbowroom.page.foxglove.front import Front
from elbowroom.page.scene.bodies import link_points, points_in_world
from elbowroom.page.scene.near import Planes, near_of
from elbowroom.page.story.told import Told
from elbowroom.sensing import Snapshot

BYTES_PER_S = 1_400_000
"""Of blocked space, so much goes to each viewer at most."""
STAYS_S = 2.0
"""What does not move is said again so often, for those who came later [s]."""
BACKLOG = 64
"""So many messages wait for a slow viewer; older ones are dropped."""


@dataclass(slots=True, eq=False)
class Bridge:
    """A server with the topics of a room.

    Args:
        configuration: of the run.
        port: at which viewers come in; 0: any that is free.
        controls: that is asked where a viewer plays, pauses or seeks; None: nobody is.
        span_ns: first and last time of a recording [ns]; None: it is live.

    Raises:
        InputError: the port is taken.
        PackageError: foxglove-sdk is missing.
    """

    configuration: Configuration
    port: int
    controls: Any = None
    span_ns: tuple[int, int] | None = None
    front: Front = field(init=False)
    _server: Any = field(init=False)
    _context: Any = field(init=False)
    _channels: dict[str, Any] = field(default_factory=dict, init=False)
    _wanted: dict[str, int] = field(default_factory=dict, init=False)
    _lock: threading.Lock = field(default_factory=threading.Lock, init=False)
    _points: Any = field(default=None, init=False)
    _blocked_s: float = field(default=0.0, init=False)
    _stays_s: float = field(default=0.0, init=False)

    def __post_init__(self) -> None:
        foxglove, channels = package("foxglove"), package("foxglove.channels")
        # channels live as long as their context does
        context = self._context = foxglove.Context()
        kinds = {
            topics.TF: channels.FrameTransformsChannel,
            topics.JOINTS: channels.JointStatesChannel,
            topics.BLOCKED: channels.VoxelGridChannel,
            topics.MACHINE: channels.SceneUpdateChannel,
        }
        for camera in self.configuration.cameras:
            kinds[topics.depth_topic(camera.name)] = channels.RawImageChannel
            kinds[topics.calibration_topic(camera.name)] = channels.CameraCalibrationChannel
        self._channels = {topic: kind(topic, context=context) for topic, kind in kinds.items()}
        self._channels[topics.VERDICTS] = foxglove.Channel(
            topics.VERDICTS, schema=topics.VERDICT_SCHEMA, message_encoding="json", context=context
        )
        if self.configuration.machine is not None:
            self._points = link_points(self.configuration.machine)
        self.front = Front(self.port)
        self._server = foxglove.start_server(
            name=f"elbowroom: {self.configuration.told.get('site')}",
            host="127.0.0.1",
            port=0,
            context=context,
            server_listener=_Listener(self),
            playback_time_range=self.span_ns,
            message_backlog_size=BACKLOG,
            tls_cert=self.front.certificate,
            tls_key=self.front.key,
        )
        self.front.lead_to(self._server.port)

    @property
    def url(self) -> str:
        """What viewers type in."""
        return f"ws://127.0.0.1:{self.front.port}"

    def is_wanted(self, topic: str) -> bool:
        """Whether anybody subscribed to a topic."""
        return self._wanted.get(topic, 0) > 0

    @property
    def wanted_depth(self) -> tuple[str, ...]:
        """Names of the cameras whose depth images somebody wants."""
        names = (camera.name for camera in self.configuration.cameras)
        return tuple(name for name in names if self.is_wanted(topics.depth_topic(name)))

    def tell(self, told: Told) -> None:
        """Sends a moment, space and images apart.

        Args:
            told: the moment.
        """
        at_ns, machine, joints = int(told["wall_ns"]), self.configuration.machine, told["joints"]
        self._log(topics.VERDICTS, topics.verdicts(told), at_ns)
        links: Mapping[str, Any] = {}
        if machine is not None and joints is not None:
            links = machine.world_from_links(joints)
            self._log(topics.JOINTS, topics.joint_states(at_ns, joints), at_ns)
        self._log(topics.TF, topics.transforms(at_ns, self.configuration.cameras, links), at_ns)
        now_s = time.monotonic()
        if now_s - self._stays_s >= STAYS_S:
            self._stays_s = now_s
            self._tell_what_stays(at_ns)

    def show_space(self, told: Told, planes: Planes) -> bool:
        """Sends blocked space near the machine, unless too much was sent just now; whether it was.

        Args:
            told: the moment.
            planes: of its free space.
        """
        now_s = time.monotonic()
        if not self.is_wanted(topics.BLOCKED) or now_s < self._blocked_s:
            return False
        grid = self.configuration.fields["grid"]
        blocked = blocked_of(grid, near_of(grid, planes, self._machine_at(told)))
        self._blocked_s = now_s + blocked.kinds.size / BYTES_PER_S
        at_ns = int(told["wall_ns"])
        self._log(topics.BLOCKED, topics.voxel_grid(at_ns, grid, blocked), at_ns)
        return True

    def show_images(self, told: Told, snapshot: Snapshot) -> None:
        """Sends depth images to those who want them.

        Args:
            told: the moment.
            snapshot: of it.
        """
        at_ns, wanted = int(told["wall_ns"]), self.wanted_depth
        for frame in snapshot.frames:
            if frame.camera in wanted:
                self._log(topics.depth_topic(frame.camera), topics.depth_image(at_ns, frame), at_ns)

    def playing(self, state: Any) -> None:
        """Tells viewers where a recording is, and whether it plays."""
        self._server.broadcast_playback_state(state)

    def stop(self) -> None:
        """Ends it."""
        self.front.stop()
        self._server.stop()

    def heard(self, topic: str, by: int) -> None:
        """Somebody subscribed, or left.

        Args:
            topic: to what.
            by: +1 or -1.
        """
        with self._lock:
            self._wanted[topic] = max(0, self._wanted.get(topic, 0) + by)
            if by > 0:
                self._stays_s = 0.0

    def _tell_what_stays(self, at_ns: int) -> None:
        machine = self.configuration.machine
        if machine is not None and self.is_wanted(topics.MACHINE):
            self._log(topics.MACHINE, topics.machine_scene(at_ns, machine), at_ns)
        for camera in self.configuration.cameras:
            topic = topics.calibration_topic(camera.name)
            if self.is_wanted(topic):
                self._log(topic, topics.calibration(at_ns, camera), at_ns)

    def _machine_at(self, told: Told) -> Any:
        machine = self.configuration.machine
        if machine is None or told["joints"] is None:
            return np.zeros((0, 3))
        return points_in_world(machine, self._points, told["joints"])

    def _log(self, topic: str, message: Any, at_ns: int) -> None:
        if self.is_wanted(topic):
            self._channels[topic].log(message, log_time=at_ns)


class _Listener:
    """Hears of viewers, in the server's threads.

    Args:
        bridge: that is told.
    """

    def __init__(self, bridge: Bridge) -> None:
        self._bridge = bridge

    def on_subscribe(self, client: Any, channel: Any) -> None:
        """Somebody wants a topic."""
        self._bridge.heard(channel.topic, 1)

    def on_unsubscribe(self, client: Any, channel: Any) -> None:
        """Somebody wants it no more."""
        self._bridge.heard(channel.topic, -1)

    def on_playback_control_request(self, request: Any) -> Any:
        """Somebody plays, pauses or seeks."""
        return None if self._bridge.controls is None else self._bridge.controls.asked(request)

    def __getattr__(self, name: str) -> Any:
        """What is not heard."""
        if name.startswith("on_"):
            return lambda *_: None
        raise AttributeError(name)
