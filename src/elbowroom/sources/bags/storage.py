"""What both storages of a bag answer: which topics there are, and the messages of each, unread."""

from collections.abc import Sequence
from typing import NamedTuple, Protocol

LARGEST_MESSAGE = 1 << 28
"""No image that is read here is larger [bytes]."""


class Topic(NamedTuple):
    """A topic of a bag.

    Args:
        name: such as "/north/depth/image_rect_raw".
        type: such as "sensor_msgs/msg/Image".
        encoding: how messages are written; "cdr" is read.
    """

    name: str
    type: str
    encoding: str


class Stored(NamedTuple):
    """A message that has not been read.

    Args:
        received_ns: when the recorder got it [ns, the recorder's clock].
        stamp_ns: of the header, if the message begins with one [ns]; None: that is not known without reading it.
        size: of the message as it is stored [bytes].
        part: number of the file.
        place: where in the file: a row, or a chunk and its byte.
        within: byte within the chunk.
        frame: of the header; None: that is not known without reading it.
    """

    received_ns: int
    stamp_ns: int | None
    size: int
    part: int
    place: int
    within: int
    frame: str | None = None


class Storage(Protocol):
    """A file of a bag, looked through: what is wrong in it is in the notes, and what is whole can be read."""

    @property
    def topics(self) -> Sequence[Topic]:
        """All topics, also those without a message."""

    @property
    def notes(self) -> Sequence[str]:
        """What is wrong with the file: where it is cut off, what is damaged; none where it is whole."""

    def messages(self, topic: str) -> Sequence[Stored]:
        """The messages of a topic, in the order in which they lie."""

    def read(self, stored: Stored) -> bytes:
        """The bytes of a message, unpacked.

        Raises:
            BagError: they are damaged, or are not there any more.
        """

    def close(self) -> None:
        """Lets go of the file."""
