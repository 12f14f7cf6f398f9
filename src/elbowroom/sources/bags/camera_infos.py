"""Which CameraInfo belongs to a topic of depth, and what it says of the lens."""

from elbowroom.errors import BagError, FrameError
from elbowroom.sources.bags.axes import frames_named
from elbowroom.sources.bags.bag import Bag
from elbowroom.sources.bags.depth_topics import DepthTopic, camera_name, first_kind
from elbowroom.sources.bags.lenses import Lens, lens_of
from elbowroom.sources.bags.messages import CAMERA_INFO, CameraInfo, camera_info_of

LOOKED_AT = 8
"""So many of the first messages are compared: two cameras on one topic take turns."""


def info_topic(bag: Bag, topic: DepthTopic) -> str:
    """The topic of a depth topic's CameraInfo: beside it, or below it, or else the only one of the same axes.

    Raises:
        BagError: there is none.
    """
    infos = [name for name in bag.of_type(CAMERA_INFO) if bag.messages(name)]
    beside = topic.base.rpartition("/")[0]
    for name in (f"{beside}/camera_info", f"{topic.base}/camera_info"):
        if name in infos:
            return name
    alike = [name for name in infos if _info(bag, name).header.frame == topic.kind.frame]
    if len(alike) == 1:
        return alike[0]
    known = ", ".join(infos) or "none"
    raise BagError(
        f"{bag.path}: no CameraInfo of {topic.name}: expected {beside}/camera_info; there are {known}. Record it too, "
        "or write the site file by hand (`elbowroom site new`)"
    )


def info_of(bag: Bag, name: str) -> CameraInfo:
    """The first CameraInfo of a topic.

    Raises:
        BagError: malformed, of two frames, or a later one says another lens.
    """
    messages = bag.messages(name)
    frames = frames_named(bag, messages)
    if len(frames) > 1:
        raise BagError(
            f"{bag.path}: {name}: CameraInfo of two frames, {frames[0]} and {frames[1]}, on one topic: do two cameras "
            "publish on it? Give each a topic of its own (remap its driver), and record anew"
        )
    first = _info(bag, name)
    for number, stored in enumerate(dict.fromkeys((*messages[:LOOKED_AT], messages[-1]))):
        other = camera_info_of(bag.read(stored), f"{bag.path}: {name}")
        if (first.k != other.k).any() or (first.width, first.height) != (other.width, other.height):
            where = f"of message {number + 1}" if number < LOOKED_AT else "at the end"
            raise BagError(f"{bag.path}: {name}: the lens or the size {where} is not that of the beginning")
    return first


def lens_by(bag: Bag, topic: str) -> Lens:
    """What the CameraInfo of a topic of depth says of the lens.

    Raises:
        BagError, FrameError: there is none, or it is not read, or the topic has no depth.
    """
    kind = first_kind(bag, topic)
    if isinstance(kind, str):
        raise FrameError(kind)
    found = DepthTopic(topic, camera_name(topic), kind, bag.count(topic), None)
    source = info_topic(bag, found)
    return lens_of(info_of(bag, source), kind.size, found.is_rectified, f"{bag.path}: {source}")


def _info(bag: Bag, name: str) -> CameraInfo:
    return camera_info_of(bag.read(bag.messages(name)[0]), f"{bag.path}: {name}")
