"""A pass in the form in which it is kept: its frames packed, and all else as messages."""

import hashlib
import json
import math
import mmap
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, field
from typing import Any, NamedTuple

from elbowroom.geometry import DepthCamera
from elbowroom.monitor.blackbox.kept_values import kept
from elbowroom.monitor.face import Pass
from elbowroom.monitor.gate.state import Decision
from elbowroom.monitor.gate.told import decision_row
from elbowroom.monitor.health.streams.told import sick_row
from elbowroom.monitor.result import CycleResult
from elbowroom.motion import Distances, Level, Verdict
from elbowroom.reconstruct import FreeSpace
from elbowroom.sensing import DepthFrame, MeantPath
from elbowroom.wire import ros_messages, ros_schemas
from elbowroom.wire.depth_codec import Units, packed_pieces
from elbowroom.wire.mcap_writer import Told
from elbowroom.wire.ros_messages import Lens, Placed, Status

PASS, VERDICTS, STOPS = "/elbowroom/pass", "/elbowroom/verdicts", "/elbowroom/stops"
JOINTS, TF_STATIC = "/joint_states", "/tf_static"
WORLD = "world"
PLANES = ("free", "surface", "blind", "disputed", "body")
"""Of a free space, `<name>_words` each."""
LEVELS = {Level.STOP: ros_messages.ERROR, Level.DECELERATE: ros_messages.WARN}


def depth_topic(camera: str) -> str:
    """Where the images of a camera lie."""
    return f"/{camera}/depth/image"


class KeptFrame(NamedTuple):
    """A frame that is kept.

    Args:
        camera: its name.
        number: among the frames of its camera, from 1.
        told: its message.
    """

    camera: str
    number: int
    told: Told


class KeptPass(NamedTuple):
    """A pass that is kept.

    Args:
        sequence: its number.
        heard_ns: when it was done [ns of `time.monotonic_ns`].
        wall_ns: when, by the computer's calendar [ns].
        time_ns: at which it is logged [ns].
        frames: of its snapshot; those that were in the one before are the same.
        messages: all else.
        stops: what stopped with it, a sentence each.
    """

    sequence: int
    heard_ns: int
    wall_ns: int
    time_ns: int
    frames: tuple[KeptFrame, ...]
    messages: tuple[Told, ...]
    stops: tuple[str, ...]

    @property
    def own_size(self) -> int:
        """But for its frames [bytes]."""
        return sum(len(told.data) for told in self.messages)


class Moment(NamedTuple):
    """A pass that is to be kept.

    Args:
        done: the pass.
        heard_ns, wall_ns: as of `KeptPass`.
        lost: how many before it could not be kept.
    """

    done: Pass
    heard_ns: int
    wall_ns: int
    lost: int


@dataclass(slots=True, eq=False)
class Keeping:
    """Makes passes into what is kept, one after the other.

    What is kept for a minute lies in memory of its own, which the system has back as a whole when the last frame of a
    pass is let go. Between what passes hold for a moment it leaves holes in the heap, which grows by them for hours.

    Args:
        units: by camera, what its whole numbers stand for.
        radial: names of cameras whose depth is the distance from their centre.
    """

    units: Mapping[str, Units]
    radial: frozenset[str] = frozenset()
    _frames: dict[str, tuple[DepthFrame, KeptFrame]] = field(default_factory=dict, init=False)

    def of(self, moment: Moment, stops: Sequence[str]) -> KeptPass:
        """A pass as it is kept.

        Args:
            moment: the pass.
            stops: what stopped with it.

        Raises:
            PackageError: zstandard is not installed.
        """
        done = moment.done
        frames = self._kept(done.snapshot.frames)
        now_ns = done.snapshot.now_ns
        time_ns = moment.wall_ns if now_ns is None else now_ns
        record = pass_record(moment, [(frame.camera, frame.number) for frame in frames])
        number = done.result.sequence
        text = json.dumps(record, separators=(",", ":"), allow_nan=False, ensure_ascii=False)
        messages = [Told(PASS, ros_schemas.STRING, ros_messages.text_message(text), number)]
        if done.snapshot.joints is not None:
            joints = ros_messages.joint_state_message(time_ns, done.snapshot.joints)
            messages.append(Told(JOINTS, ros_schemas.JOINT_STATE, joints, number))
        statuses = [_status(verdict) for verdict in done.result.verdicts]
        told = ros_messages.diagnostics_message(time_ns, statuses)
        messages.append(Told(VERDICTS, ros_schemas.DIAGNOSTICS, told, number))
        for stop in stops:
            log = ros_messages.log_message(time_ns, ros_messages.LOG_ERROR, stop)
            messages.append(Told(STOPS, ros_schemas.LOG, log, number))
        return KeptPass(
            number,
            moment.heard_ns,
            moment.wall_ns,
            time_ns,
            frames,
            messages=tuple(messages),
            stops=tuple(stops),
        )

    def _kept(self, frames: Sequence[DepthFrame]) -> tuple[KeptFrame, ...]:
        """Frames, each packed once however many passes it is part of."""
        new = [frame for frame in frames if not self._is_kept(frame)]
        for frame, data in zip(new, together([self._message(frame) for frame in new]), strict=True):
            _, before = self._frames.get(frame.camera, (None, None))
            number = 1 if before is None else before.number + 1
            told = Told(depth_topic(frame.camera), ros_schemas.COMPRESSED_IMAGE, data, number)
            self._frames[frame.camera] = frame, KeptFrame(frame.camera, number, told)
        return tuple(self._frames[frame.camera][1] for frame in frames)

    def _is_kept(self, frame: DepthFrame) -> bool:
        """Whether the pass before had it."""
        return frame.camera in self._frames and self._frames[frame.camera][0] is frame

    def _message(self, frame: DepthFrame) -> bytes:
        """What a frame is kept as."""
        packed = packed_pieces(frame.depth_m, self.units.get(frame.camera))
        return ros_messages.depth_message(frame.stamp_ns, frame.camera, packed, frame.camera in self.radial)


def together(pieces: Sequence[bytes]) -> list[memoryview]:
    """The same bytes in one stretch of memory that is the system's again when the last of them is let go.

    Args:
        pieces: each is copied.
    """
    size = sum(map(len, pieces))
    if not size:
        return [memoryview(b"") for _ in pieces]
    memory, at = mmap.mmap(-1, size, flags=mmap.MAP_PRIVATE | mmap.MAP_ANONYMOUS), 0
    whole, found = memoryview(memory), list[memoryview]()
    for piece in pieces:
        whole[at : at + len(piece)] = piece
        found.append(whole[at : at + len(piece)].toreadonly())
        at += len(piece)
    return found


def pass_record(moment: Moment, frames: Sequence[tuple[str, int]]) -> dict[str, Any]:
    """All that replaying needs, and what came of the pass, in what JSON knows.

    Args:
        moment: the pass.
        frames: camera and number of each of its frames, in their order.
    """
    snapshot, result, decision = moment.done.snapshot, moment.done.result, moment.done.decision
    stamps = [frame.stamp_ns for frame in snapshot.frames]
    given = {
        "now_ns": snapshot.now_ns,
        "frames": [[*frame, stamp] for frame, stamp in zip(frames, stamps, strict=True)],
        "joints": None if snapshot.joints is None else _positions(snapshot.joints),
        "joints_of": {camera: _positions(joints) for camera, joints in snapshot.joints_of.items()},
        "clock_bounds_ns": dict(snapshot.clock_bounds_ns),
        "joints_ns": snapshot.joints_ns,
        "commanded": None if snapshot.commanded is None else _positions(snapshot.commanded),
        "velocities": _positions(snapshot.velocities),
        **({} if snapshot.path is None else {"path": _path(snapshot.path)}),
    }
    return {
        "sequence": result.sequence,
        "wall_ns": moment.wall_ns,
        "lost": moment.lost,
        "given": given,
        "judged": judged(result),
        "margins": None if moment.done.margins is None else plain(moment.done.margins.row()),
        "gate": None if decision is None else _gate(decision),
    }


def _path(path: MeantPath) -> dict[str, Any]:
    """What the machine means to do, numbers to the last bit."""
    return {
        "joint_names": list(path.joint_names),
        "stamps_ns": path.stamps_ns.tolist(),
        "positions": path.positions.tolist(),
        "velocities": None if path.velocities is None else path.velocities.tolist(),
        "said_ns": path.said_ns,
    }


def judged(result: CycleResult) -> dict[str, Any]:
    """What a pass came to, in what JSON knows, numbers to the last bit."""
    path = {} if result.path is None else {"path": plain(result.path.row())}
    return {
        **path,
        **({} if result.off_path is None else {"off_path": result.off_path}),
        "verdicts": [plain(verdict.row()) for verdict in result.verdicts],
        "stopping": None if result.stopping is None else plain(result.stopping.row()),
        "space": None if result.space is None else space_sum(result.space),
        "fault": result.fault,
        "late": result.late,
        "stopped_by": result.stopped_by,
        "given": None if result.given is None else list(result.given),
        "sick": [plain(sick_row(each)) for each in result.sick],
        "findings": [asdict(finding) for finding in result.findings],
        "stage_ms": plain(dict(result.stage_ms)),
        "distances": None if result.distances is None else _distances(result.distances),
        "oldest_age_ms": plain(result.oldest_age_ms),
        "skew_ms": plain(result.skew_ms),
    }


def _distances(distances: Distances) -> dict[str, Any]:
    """Of each link, to what was seen and to what nobody saw."""
    links = [
        {"link": each.link, "seen": plain(each.seen.row()), "unseen": plain(each.unseen.row())}
        for each in distances.links
    ]
    return {"up_to_m": plain(distances.up_to_m), "slack_m": plain(distances.slack_m), "links": links}


def space_sum(space: FreeSpace) -> str:
    """SHA-256 of all planes of a free space."""
    total = hashlib.sha256()
    for name in PLANES:
        total.update(getattr(space, f"{name}_words").data)
    return total.hexdigest()


def plain(value: Any) -> Any:
    """The same in what JSON knows; a number that is not finite is a word."""
    if isinstance(value, Mapping):
        return {str(key): plain(item) for key, item in value.items()}
    if isinstance(value, tuple | list):
        return [plain(item) for item in value]
    if hasattr(value, "item"):
        value = value.item()
    return repr(value) if isinstance(value, float) and not math.isfinite(value) else value


def lens_of(camera: DepthCamera) -> Lens:
    """What a CameraInfo says of a camera."""
    of = camera.intrinsics
    return Lens((camera.width, camera.height), (of.fx, of.fy, of.cx, of.cy), of.distortion)


def placed_in_world(camera: DepthCamera) -> Placed:
    """Where a camera is."""
    from scipy.spatial.transform import Rotation

    rotation = Rotation.from_matrix(camera.world_from_camera[:3, :3]).as_quat()
    place = camera.world_from_camera[:3, 3]
    return Placed(WORLD, ros_messages.optical_frame(camera.name), place.tolist(), rotation.tolist())


def still_messages(cameras: Sequence[DepthCamera]) -> list[Told]:
    """What is said once: each camera's lens, and where it is."""
    told = [
        Told(
            f"/{camera.name}/depth/camera_info",
            ros_schemas.CAMERA_INFO,
            ros_messages.camera_info_message(0, camera.name, lens_of(camera)),
        )
        for camera in cameras
    ]
    placed = ros_messages.transforms_message(0, [placed_in_world(camera) for camera in cameras])
    return [*told, Told(TF_STATIC, ros_schemas.TF, placed)]


def _positions(joints: Mapping[str, float]) -> Any:
    return {name: kept(float(value)) for name, value in joints.items()}


def _gate(decision: Decision) -> dict[str, Any]:
    """A decision, with what a person asked for."""
    return {
        **plain(decision_row(decision)),
        "reset_answer": decision.answer,
        "is_reset": decision.is_reset,
        "held_until_ns": decision.held_until_ns,
    }


def _status(verdict: Verdict) -> Status:
    """A verdict as a line of diagnostics."""
    row = verdict.row()
    keys = ("free_travel", "free_travel_unit", "braking_distance", "cause", "link", "place_m")
    values = {key: str(row[key]) for key in keys}
    where = "" if verdict.link is None else f", {verdict.link}"
    message = f"{verdict.level.name.lower()} ({verdict.cause.name.lower()}{where})"
    return Status(LEVELS.get(verdict.level, ros_messages.OK), verdict.motion.name, message, values)
