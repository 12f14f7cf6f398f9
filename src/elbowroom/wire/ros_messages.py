"""The few messages of ROS 2 that are written (common_interfaces)."""

from collections.abc import Mapping, Sequence
from typing import NamedTuple

from elbowroom.wire.cdr_writer import CdrWriter

PLANAR, RADIAL = "32FC1; elbowroom", "32FC1; elbowroom radial"
"""Formats of a compressed image whose data is a depth image packed by `depth_codec`: metres when it is unpacked, along
the optical axis, or from the camera's centre."""
OK, WARN, ERROR = 0, 1, 2
"""Levels of a status."""
LOG_WARN, LOG_ERROR = 30, 40


class Lens(NamedTuple):
    """What a CameraInfo says of a camera.

    Args:
        size: width and height [px].
        pinhole: fx, fy, cx, cy [px].
        distortion: coefficients, as OpenCV has them; none, five or eight.
    """

    size: tuple[int, int]
    pinhole: tuple[float, float, float, float]
    distortion: Sequence[float]


class Placed(NamedTuple):
    """Where a frame is in another.

    Args:
        parent, child: names of the frames.
        translation: x, y, z [m].
        rotation: quaternion x, y, z, w.
    """

    parent: str
    child: str
    translation: Sequence[float]
    rotation: Sequence[float]


class Status(NamedTuple):
    """A line of diagnostics.

    Args:
        level: `OK`, `WARN` or `ERROR`.
        name, message: what it is of, and what it says.
        values: what else is known, in words.
    """

    level: int
    name: str
    message: str
    values: Mapping[str, str]


def optical_frame(camera: str) -> str:
    """Name of the frame in whose axes a camera's images are: x right, y down, z forward."""
    return f"{camera}_optical"


def depth_message(
    stamp_ns: int | None, camera: str, packed: Sequence[bytes | memoryview], is_radial: bool = False
) -> bytes:
    """sensor_msgs/msg/CompressedImage of a packed depth image.

    Args:
        stamp_ns: of its exposure [ns]; None: unknown.
        camera: its name.
        packed: as `packed_pieces` gave it.
        is_radial: whether depth is the distance from the camera's centre.
    """
    told = CdrWriter().header(stamp_ns, optical_frame(camera)).text(RADIAL if is_radial else PLANAR)
    return told.done_with(packed)


def camera_info_message(stamp_ns: int | None, camera: str, lens: Lens) -> bytes:
    """sensor_msgs/msg/CameraInfo.

    Args:
        stamp_ns: [ns].
        camera: its name.
        lens: of the camera.
    """
    fx, fy, cx, cy = lens.pinhole
    model = "rational_polynomial" if len(lens.distortion) == 8 else "plumb_bob"
    told = (
        CdrWriter()
        .header(stamp_ns, optical_frame(camera))
        .whole(lens.size[1])
        .whole(lens.size[0])
        .text(model)
    )
    told.reals(lens.distortion or (0.0,) * 5)
    told.reals((fx, 0, cx, 0, fy, cy, 0, 0, 1), counted=False)
    told.reals((1, 0, 0, 0, 1, 0, 0, 0, 1), counted=False)
    told.reals((fx, 0, cx, 0, 0, fy, cy, 0, 0, 0, 1, 0), counted=False)
    for _ in range(6):
        told.whole(0)
    return told.octet(0).done()


def joint_state_message(stamp_ns: int | None, positions: Mapping[str, float]) -> bytes:
    """sensor_msgs/msg/JointState.

    Args:
        stamp_ns: [ns].
        positions: by name [m or rad].
    """
    told = CdrWriter().header(stamp_ns, "").texts(tuple(positions))
    return told.reals([float(value) for value in positions.values()]).reals(()).reals(()).done()


def transforms_message(stamp_ns: int | None, placed: Sequence[Placed]) -> bytes:
    """tf2_msgs/msg/TFMessage.

    Args:
        stamp_ns: [ns].
        placed: a transform each.
    """
    told = CdrWriter().whole(len(placed))
    for one in placed:
        told.header(stamp_ns, one.parent).text(one.child)
        told.reals(one.translation, counted=False).reals(one.rotation, counted=False)
    return told.done()


def diagnostics_message(stamp_ns: int | None, statuses: Sequence[Status]) -> bytes:
    """diagnostic_msgs/msg/DiagnosticArray.

    Args:
        stamp_ns: [ns].
        statuses: a line each.
    """
    told = CdrWriter().header(stamp_ns, "").whole(len(statuses))
    for one in statuses:
        told.octet(one.level).text(one.name).text(one.message).text("").whole(len(one.values))
        for key, value in one.values.items():
            told.text(key).text(value)
    return told.done()


def log_message(stamp_ns: int | None, level: int, text: str) -> bytes:
    """rcl_interfaces/msg/Log.

    Args:
        stamp_ns: [ns].
        level: `LOG_WARN` or `LOG_ERROR`.
        text: one line.
    """
    told = CdrWriter().time(stamp_ns).octet(level).text("elbowroom").text(text)
    return told.text("").text("").whole(0).done()


def text_message(text: str) -> bytes:
    """std_msgs/msg/String."""
    return CdrWriter().text(text).done()


def text_of(message: bytes | memoryview) -> str:
    """What a std_msgs/msg/String holds, as `text_message` wrote it.

    Raises:
        ValueError: it is none.
    """
    length = int.from_bytes(message[4:8], "little")
    if len(message) < 9 or bytes(message[:4]) != b"\x00\x01\x00\x00" or 8 + length != len(message):
        raise ValueError("no text of a message")
    return bytes(message[8 : 7 + length]).decode()
