"""The images of one camera of a bag by rising time, and what of them is left out."""

from collections.abc import Sequence
from typing import NamedTuple

from elbowroom.errors import FrameError
from elbowroom.geometry import DepthCamera
from elbowroom.site.site import Site
from elbowroom.sources.bags.axes import frames_named, require_one_frame
from elbowroom.sources.bags.bag import Bag
from elbowroom.sources.bags.depth import METRES, kind_of
from elbowroom.sources.bags.stamps import Stamped
from elbowroom.sources.layouts.bag_image import Message
from elbowroom.sources.layouts.image import Image

MOST_ALIKE = 0.05
"""Where more than this share of a camera's images has the time of another, its stamps are none."""


class Row(NamedTuple):
    """What a camera has.

    Args:
        images: by rising time, no two of one.
        notes: what was left out.
    """

    images: list[Image]
    notes: tuple[str, ...]


def row_of(site: Site, camera: DepthCamera, bag: Bag, topic: str, messages: Sequence[Stamped]) -> Row:
    """The images of a camera. Of two with one time the one that came first is kept.

    Args:
        site: of the camera.
        camera: whose.
        bag: opened.
        topic: of its images.
        messages: of the topic, by rising time, and by receipt where that is the same.

    Raises:
        BagError, FrameError: the first message is no depth image.
        FrameError: images of two frames, or many that have the time of another.
    """
    require_one_frame(f"{camera.name} ({bag.path})", topic, frames_named(bag, (m.stored for m in messages)))
    in_metres = bool(messages) and _encoding(bag, topic, messages[0]) == METRES
    images: list[Image] = []
    alike: list[int] = []
    kept: Message | None = None
    for message in messages:
        stamp, where = message.stamp_ns, f"{bag.path}: {topic} at {message.stamp_ns} ns"
        stored = Message(bag, topic, message.stored, where, in_metres)
        if kept is not None and images[-1].stamp_ns == stamp:
            if kept.content() != stored.content():
                alike.append(stamp)
            continue
        kept = stored
        images.append(Image.of(site, camera, stamp, bag.path / topic.strip("/") / f"{stamp}.png", stored))
    return Row(images, _left_out(f"{bag.path}: {topic}", camera.name, alike, len(messages)))


def _left_out(what: str, camera: str, alike: Sequence[int], count: int) -> tuple[str, ...]:
    """That images were left out for the time of another.

    Raises:
        FrameError: too many were.
    """
    if not alike:
        return ()
    told = (
        f"{what}: {len(alike)} of {count} images of camera {camera} have the time of another, the first "
        f"{alike[0]} ns"
    )
    if len(alike) > max(1, MOST_ALIKE * count):
        raise FrameError(
            f"{told}: its driver stamps two images alike, or two cameras publish on this topic; have the driver stamp "
            "each image by its exposure, or leave this camera out of the site"
        )
    return (f"{told}; of each pair the one that came first is kept, the other left out",)


def _encoding(bag: Bag, topic: str, message: Stamped) -> str:
    """Of a topic's first image."""
    what = f"{bag.path}: {topic} at {message.stamp_ns} ns"
    return kind_of(bag.topics[topic].type, bag.read(message.stored), what).encoding
