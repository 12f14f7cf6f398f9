"""An MCAP file, written step by step: each step is a chunk of its own, with its link of the chain."""

import os
from collections import deque
from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path
from typing import NamedTuple

from elbowroom.wire import mcap_records as records
from elbowroom.wire.chain import Chain
from elbowroom.wire.mcap_records import AttachmentPlace, ChunkPlace, Message
from elbowroom.wire.mcap_tail import Tail
from elbowroom.wire.ros_schemas import SCHEMAS

LIBRARY = "elbowroom"
AT_ONCE = 256
"""So many pieces are written by one call; systems allow 1024 or more."""
STRETCH, BEHIND = 1 << 25, 4
"""What is written goes to the disk stretch by stretch [bytes], and out of memory so many stretches later."""

Piece = bytes | memoryview


class Told(NamedTuple):
    """A message that has no channel yet.

    Args:
        topic, type: of its channel.
        data: its bytes.
        number: of the message in its channel.
    """

    topic: str
    type: str
    data: Piece
    number: int = 0


class Attached(NamedTuple):
    """A file within the file.

    Args:
        name, media_type: of it.
        data: its content.
    """

    name: str
    media_type: str
    data: bytes


class McapWriter:
    """A file that is written from its beginning, and can be read up to wherever it ends.

    Args:
        path: of a file that is not there yet.
        attached: what it begins with.

    Raises:
        OSError: it is there already, or cannot be written; here and in every call.
    """

    def __init__(self, path: Path, attached: Sequence[Attached] = ()) -> None:
        self.path = path
        self.steps = 0
        self.length = 0
        self._sent_on = 0
        self._chain = Chain()
        self._tail = Tail()
        self._schemas: dict[str, int] = {}
        self._channels: dict[str, int] = {}
        self._file = path.open("xb", buffering=0)
        try:
            head = [records.MAGIC, records.header(LIBRARY)]
            at = sum(map(len, head))
            for file in attached:
                head.append(records.attachment(*file))
                place = AttachmentPlace(at, len(head[-1]), len(file.data), file.name, file.media_type)
                self._tail.attachments.append(place)
                at += len(head[-1])
            self._write(head)
        except BaseException:
            self._file.close()
            raise

    @property
    def sum(self) -> str:
        """Of the last link."""
        return self._chain.sum

    def step(self, messages: Sequence[Told], time_ns: int) -> None:
        """Writes messages as one chunk, whole or cut off: nobody reads a part of it.

        Args:
            messages: in their order.
            time_ns: at which they are logged [ns].
        """
        new, numbered = self._numbered(messages, max(time_ns, 0))
        pieces, index, size = list[Piece](new), dict[int, list[tuple[int, int]]](), sum(map(len, new))
        for one in numbered:
            head_of_one = records.message_head(one)
            index.setdefault(one.channel, []).append((one.time_ns, size))
            pieces += (head_of_one, one.data)
            size += len(head_of_one) + len(one.data)
        begin, indexes = self.length, [records.message_index(*entry) for entry in index.items()]
        head = records.chunk_head(size, max(time_ns, 0), max(time_ns, 0))
        at, places = begin + len(head) + size, dict[int, int]()
        for number, written in zip(index, indexes, strict=True):
            places[number], at = at, at + len(written)
        self._write([head, *pieces, *indexes])
        place = ChunkPlace(
            max(time_ns, 0),
            max(time_ns, 0),
            begin,
            len(head) + size,
            places,
            indexes_length=sum(map(len, indexes)),
            size=size,
        )
        self._tail.add(place, {number: len(entries) for number, entries in index.items()})
        self.steps += 1
        self._send_on()

    def end(self) -> None:
        """Writes the summary, brings all to the disk and lets go of the file. Twice is as once."""
        if self._file.closed:
            return
        with self._file:
            self._send([self._tail.content(self.length)])
            os.fsync(self._file.fileno())

    def drop(self) -> None:
        """Lets go of the file as it is."""
        self._file.close()

    def _numbered(self, messages: Sequence[Told], time_ns: int) -> tuple[list[bytes], list[Message]]:
        """Records of schemas and channels that are new, and the messages with their numbers."""
        new, numbered = list[bytes](), list[Message]()
        for told in messages:
            if told.topic not in self._channels:
                new += self._added(told)
            numbered.append(Message(self._channels[told.topic], told.number % (1 << 32), time_ns, told.data))
        return new, numbered

    def _added(self, told: Told) -> list[bytes]:
        new = []
        if told.type not in self._schemas:
            self._schemas[told.type] = number = len(self._schemas) + 1
            self._tail.schemas.append(records.schema(number, told.type, SCHEMAS[told.type]))
            new.append(self._tail.schemas[-1])
        self._channels[told.topic] = number = len(self._channels) + 1
        self._tail.channels.append(records.channel(number, self._schemas[told.type], told.topic))
        return [*new, self._tail.channels[-1]]

    def _write(self, pieces: Sequence[Piece]) -> None:
        """Writes a step and its link."""
        for piece in pieces:
            self._chain.take(piece)
        self._tail.metadata += 1
        self._send([*pieces, self._chain.link()])

    def _send(self, pieces: Sequence[Piece]) -> None:
        self.length += sum(map(len, pieces))
        for begin in range(0, len(pieces), AT_ONCE):
            self._send_all(deque(memoryview(piece) for piece in pieces[begin : begin + AT_ONCE]))

    def _send_on(self) -> None:
        """Has each stretch brought to the disk as soon as it is full, so that little is left to do at the end, and then
        let go: a long recording would fill all memory with what nobody reads, and each new page costs time.
        """
        while self.length - self._sent_on >= STRETCH:
            if hasattr(os, "posix_fadvise"):  # where it is not known, the system does as it likes
                for at in (self._sent_on, max(0, self._sent_on - BEHIND * STRETCH)):
                    # pages that are not on disk yet begin to go there, others are let go
                    with suppress(OSError):
                        os.posix_fadvise(self._file.fileno(), at, STRETCH, os.POSIX_FADV_DONTNEED)
            self._sent_on += STRETCH

    def _send_all(self, left: deque[memoryview]) -> None:
        """Writes pieces as they lie: to put them together would copy them all once more."""
        while left:
            written = os.writev(self._file.fileno(), left)
            while left and written >= len(left[0]):
                written -= len(left.popleft())
            if left:
                left[0] = left[0][written:]
