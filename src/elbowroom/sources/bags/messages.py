"""The few messages of ROS 2 that are read, field by field as their definitions have them (common_interfaces)."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from elbowroom.errors import BagError
from elbowroom.sources.bags.cdr import Cdr

Array = NDArray[np.float64]
IMAGE = "sensor_msgs/msg/Image"
COMPRESSED = "sensor_msgs/msg/CompressedImage"
CAMERA_INFO = "sensor_msgs/msg/CameraInfo"
JOINT_STATE = "sensor_msgs/msg/JointState"
TF = "tf2_msgs/msg/TFMessage"


class Header(NamedTuple):
    """When and where.

    Args:
        stamp_ns: [ns]; 0: nobody said.
        frame: name of the coordinate frame.
    """

    stamp_ns: int
    frame: str


class RawImage(NamedTuple):
    """sensor_msgs/msg/Image; `data` is a view into the message."""

    header: Header
    height: int
    width: int
    encoding: str
    big_endian: bool
    step: int
    data: memoryview


class CompressedImage(NamedTuple):
    """sensor_msgs/msg/CompressedImage; `data` is a view into the message."""

    header: Header
    format: str
    data: memoryview


class CameraInfo(NamedTuple):
    """sensor_msgs/msg/CameraInfo: `k` and `r` of shape (3, 3), `p` of shape (3, 4); `roi` is x, y, height, width."""

    header: Header
    height: int
    width: int
    model: str
    d: Array
    k: Array
    r: Array
    p: Array
    binning: tuple[int, int]
    roi: tuple[int, int, int, int]


class JointState(NamedTuple):
    """sensor_msgs/msg/JointState without efforts; `positions` and `velocities` may be empty."""

    header: Header
    names: Sequence[str]
    positions: Array
    velocities: Array


class Transform(NamedTuple):
    """geometry_msgs/msg/TransformStamped: where the child's frame is in the parent's, x y z [m], and x y z w."""

    header: Header
    child: str
    translation: Array
    rotation: Array


def image_of(data: bytes | memoryview, what: str) -> RawImage:
    """The image; of what size its data is, is not yet checked.

    Args:
        data: the message.
        what: names it in errors.

    Raises:
        BagError: the message is malformed, as of all of these.
    """
    cdr = Cdr(data, what)
    header, height, width = header_of(cdr), cdr.whole("I"), cdr.whole("I")
    return RawImage(header, height, width, cdr.text(), cdr.flag(), cdr.whole("I"), cdr.octets())


def compressed_of(data: bytes | memoryview, what: str) -> CompressedImage:
    """The image, not decoded; arguments and errors as of `image_of`.

    Args:
        data: the message.
        what: names it in errors.
    """
    cdr = Cdr(data, what)
    return CompressedImage(header_of(cdr), cdr.text(), cdr.octets())


def camera_info_of(data: bytes | memoryview, what: str) -> CameraInfo:
    """The camera; arguments and errors as of `image_of`.

    Args:
        data: the message.
        what: names it in errors.
    """
    cdr = Cdr(data, what)
    header, height, width, model = header_of(cdr), cdr.whole("I"), cdr.whole("I"), cdr.text()
    d, k, r, p = cdr.reals(), cdr.reals(9), cdr.reals(9), cdr.reals(12)
    binning = cdr.whole("I"), cdr.whole("I")
    roi = cdr.whole("I"), cdr.whole("I"), cdr.whole("I"), cdr.whole("I")
    return CameraInfo(
        header,
        height,
        width,
        model,
        d=d,
        k=k.reshape(3, 3),
        r=r.reshape(3, 3),
        p=p.reshape(3, 4),
        binning=binning,
        roi=roi,
    )


def joint_state_of(data: bytes | memoryview, what: str) -> JointState:
    """The joints; arguments and errors as of `image_of`.

    Args:
        data: the message.
        what: names it in errors.
    """
    cdr = Cdr(data, what)
    found = JointState(header_of(cdr), cdr.texts(), cdr.reals(), cdr.reals())
    for told, values in (("positions", found.positions), ("velocities", found.velocities)):
        if len(values) not in (0, len(found.names)):
            raise BagError(f"{what}: {len(found.names)} names of joints and {len(values)} {told}")
    return found


def transforms_of(data: bytes | memoryview, what: str) -> Sequence[Transform]:
    """The transforms of a message; arguments and errors as of `image_of`.

    Args:
        data: the message.
        what: names it in errors.
    """
    cdr = Cdr(data, what)
    least = 8 + 4 + 4 + 56
    return [
        Transform(header_of(cdr), cdr.text(), cdr.reals(3), cdr.reals(4)) for _ in range(cdr.count(least))
    ]


def header_of(cdr: Cdr) -> Header:
    """The header with which most messages begin.

    Args:
        cdr: at its beginning.

    Raises:
        BagError: the message is malformed.
    """
    seconds, rest = cdr.whole("i"), cdr.whole("I")
    return Header(seconds * 1_000_000_000 + rest, cdr.text())
