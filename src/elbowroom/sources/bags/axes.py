"""Whose axes the messages of a topic are in: one camera's, or of two that publish on one topic."""

from collections.abc import Iterable

from elbowroom.errors import BagError, FrameError
from elbowroom.sources.bags.bag import Bag
from elbowroom.sources.bags.storage import Stored


def frames_named(bag: Bag, messages: Iterable[Stored]) -> tuple[str, ...]:
    """The frames that headers name, each once, in the order in which they come; one that names none says nothing.

    Args:
        bag: opened.
        messages: each begins with a header; one that is damaged says nothing.
    """
    found: dict[str, None] = {}
    for stored in messages:
        try:
            frame = bag.frame(stored)
        except BagError:
            continue
        if frame:
            found[frame] = None
    return tuple(found)


def require_one_frame(what: str, topic: str, frames: tuple[str, ...]) -> None:
    """Refuses images of two cameras on one topic: half of them would be taken to be where the other camera is.

    Args:
        what: of whose messages they are, in errors: a camera, or a bag.
        topic: its name.
        frames: that its headers name.

    Raises:
        FrameError: there are two or more.
    """
    if len(frames) > 1:
        more = f" and {len(frames) - 2} more" if len(frames) > 2 else ""
        raise FrameError(
            f"{what}: images of two frames, {frames[0]} and {frames[1]}{more}, on one topic, {topic}: do two cameras "
            "publish on it? Give each a topic of its own (remap its driver), and record anew"
        )
