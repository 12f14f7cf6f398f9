"""A file of MCAP, read record by record from its beginning, so that one that was cut off opens up to the cut.

The format is that of mcap.dev, specification, version 0. Index and summary at the end are not needed and not trusted.
"""

import struct
import threading
from collections import OrderedDict, defaultdict
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import BinaryIO, NamedTuple

from elbowroom.errors import BagError
from elbowroom.sources.bags.cdr import HEADER_BYTES, frame_at_head, stamp_at_head
from elbowroom.sources.bags.mcap_chunk import LONGEST_HEAD, Chunk, chunk_of, content_of
from elbowroom.sources.bags.storage import LARGEST_MESSAGE, Stored, Topic
from elbowroom.sources.bags.unpacked import is_zstd, unpacked

MAGIC = b"\x89MCAP0\r\n"
KEPT = 1 << 26
"""Of unpacked chunks the newest are kept, up to so many bytes together, and one at least."""
RECORD = struct.Struct("<BQ")
MESSAGE_HEAD = struct.Struct("<HIQQ")
HEAD_SIZE = MESSAGE_HEAD.size + HEADER_BYTES
"""Of a message so much is looked at: with the time and the frame in its header [bytes]."""
SCHEMA, CHANNEL, MESSAGE, CHUNK, FOOTER, DATA_END = 3, 4, 5, 6, 2, 15
ALONE = -1
"""The chunk of a message that lies in none."""


class _Record(NamedTuple):
    kind: int
    begin: int
    size: int


class McapFile:
    """A file of this format (`Storage`).

    Args:
        path: the file.
        part: its number in the bag.

    Raises:
        BagError: it does not begin as such a file, or has none of its records.
    """

    def __init__(self, path: Path, part: int = 0) -> None:
        self.path, self.part = path, part
        self.notes: list[str] = []
        self._schemas: dict[int, str] = {}
        self._channels: dict[int, Topic] = {}
        self._stored: dict[str, list[Stored]] = defaultdict(list)
        self._chunks: list[Chunk] = []
        self._kept: OrderedDict[int, bytes] = OrderedDict()
        self._cut_at: tuple[int, bool] | None = None
        self._lock = threading.Lock()
        self._file = path.open("rb")
        self._length = path.stat().st_size
        try:
            self._look_through()
        except BaseException:
            self.close()
            raise

    @property
    def topics(self) -> Sequence[Topic]:
        """All topics."""
        return list(dict.fromkeys(self._channels.values()))

    def messages(self, topic: str) -> Sequence[Stored]:
        """The messages of a topic."""
        return self._stored.get(topic, [])

    def read(self, stored: Stored) -> bytes:
        """The bytes of a message; raises as `Storage` says."""
        what = f"{self.path}: message at byte {max(stored.place, 0):,}"
        if stored.within == ALONE:
            with self._lock:
                data = self._at(stored.place, stored.size)
        else:
            data = self._unpacked(stored.place)[stored.within : stored.within + stored.size]
        if len(data) != stored.size:
            raise BagError(f"{what}: no longer there; was the file changed while it is read?")
        return unpacked(data, "zstd", LARGEST_MESSAGE, what) if is_zstd(data) else data

    def close(self) -> None:
        """Lets go of the file."""
        self._file.close()
        self._kept.clear()

    def _look_through(self) -> None:
        if self._at(0, len(MAGIC)) != MAGIC:
            raise BagError(f"{self.path}: not an MCAP file, or cut off in its first bytes")
        for record in self._records():
            if record.kind == CHUNK:
                self._look_into(record)
            elif record.kind == MESSAGE:
                head = self._at(record.begin, min(record.size, HEAD_SIZE))
                self._add_message(head, record.begin, record.size, ALONE)
            elif record.kind in (SCHEMA, CHANNEL):
                self._define(record.kind, self._bounded(record))
        if self._cut_at is not None:
            self.notes.append(self._cut_text(*self._cut_at))

    def _records(self) -> Iterator[_Record]:
        """The records up to the end of the data, or to where the file is cut off or is none any more."""
        at = len(MAGIC)
        while True:
            head = self._at(at, RECORD.size)
            if len(head) < RECORD.size:
                self._cut_at = at, False
                return
            kind, size = RECORD.unpack(head)
            begin = at + RECORD.size
            if kind in (DATA_END, FOOTER):
                return
            if kind == 0 or begin + size > self._length:
                self._cut_at = at, kind == CHUNK
                if kind == CHUNK:
                    yield _Record(CHUNK, begin, self._length - begin)
                return
            yield _Record(kind, begin, size)
            at = begin + size

    def _cut_text(self, at: int, is_chunk: bool) -> str:
        """Where the file ends too early, and how much of it could be read."""
        times = [stored.received_ns for messages in self._stored.values() for stored in messages]
        read = f"{len(times):,} messages are read" + (
            f", {(max(times) - min(times)) / 1e9:.3g} s from the first to the last" if times else ""
        )
        where = f"in the chunk that begins at byte {at:,}" if is_chunk else f"at byte {at:,}"
        return f"{self.path}: cut off or damaged {where} of {self._length:,}; {read}"

    def _look_into(self, record: _Record) -> None:
        """Adds the messages of a chunk, as far as it goes."""
        number = len(self._chunks)
        try:
            chunk = chunk_of(
                self._at(record.begin, min(record.size, LONGEST_HEAD)), record.begin, record.size
            )
            if chunk is None:
                return
            self._chunks.append(chunk)
            content = self._unpacked(number)
        except BagError as error:
            self.notes.append(f"{self.path}: {error}; its messages are left out")
            return
        at = 0
        while at + RECORD.size <= len(content):
            kind, size = RECORD.unpack_from(content, at)
            begin = at + RECORD.size
            at = begin + size
            if at > len(content):
                break
            if kind == MESSAGE:
                head = content[begin : begin + min(size, HEAD_SIZE)]
                self._add_message(head, begin, size, number)
            elif kind in (SCHEMA, CHANNEL):
                self._define(kind, content[begin:at])

    def _unpacked(self, number: int) -> bytes:
        """What a chunk holds; the newest are kept."""
        with self._lock:
            kept = self._kept.get(number)
            if kept is not None:
                self._kept.move_to_end(number)
                return kept
            chunk = self._chunks[number]
            content = content_of(chunk, self._at(chunk.begin, chunk.packed))
            self._kept[number] = content
            while len(self._kept) > 1 and sum(map(len, self._kept.values())) > KEPT:
                self._kept.popitem(last=False)
            return content

    def _define(self, kind: int, content: bytes) -> None:
        """A schema or a channel; what is malformed is left out, and its messages with it."""
        try:
            if kind == SCHEMA:
                (number,) = struct.unpack_from("<H", content)
                self._schemas[number] = _text(content, 2)[0]
                return
            number, schema = struct.unpack_from("<HH", content)
            topic, at = _text(content, 4)
            encoding, _ = _text(content, at)
        except (struct.error, UnicodeDecodeError):
            self.notes.append(f"{self.path}: a malformed record; what it names is left out")
            return
        self._channels[number] = Topic(topic, self._schemas.get(schema, ""), encoding)

    def _add_message(self, head: bytes, begin: int, size: int, chunk: int) -> None:
        if size < MESSAGE_HEAD.size:
            return
        number, _, received, _ = MESSAGE_HEAD.unpack_from(head)
        topic = self._channels.get(number)
        if topic is None or received >= 2**63:
            return
        data_size = size - MESSAGE_HEAD.size
        begin += MESSAGE_HEAD.size
        place, within = (begin, ALONE) if chunk == ALONE else (chunk, begin)
        start = head[MESSAGE_HEAD.size :]
        stamp, frame = stamp_at_head(start), frame_at_head(start)
        self._stored[topic.name].append(Stored(received, stamp, data_size, self.part, place, within, frame))

    def _bounded(self, record: _Record) -> bytes:
        return self._at(record.begin, min(record.size, 1 << 16))

    def _at(self, begin: int, size: int) -> bytes:
        file: BinaryIO = self._file
        file.seek(begin)
        return file.read(size)


def _text(content: bytes, at: int) -> tuple[str, int]:
    """A string and where it ends."""
    (length,) = struct.unpack_from("<I", content, at)
    if at + 4 + length > len(content):
        raise struct.error
    return content[at + 4 : at + 4 + length].decode(), at + 4 + length
