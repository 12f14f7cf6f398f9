"""A chained MCAP file, read record by record from its beginning, so that one that was cut off opens up to the cut.

Nothing is believed that a link of the chain does not follow, and the summary at the end is not used: it is made again,
and compared. What is held of a step is where it lies, so memory stays below what the file has.
"""

import os
import struct
from array import array
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from types import TracebackType
from typing import NamedTuple, Self

from elbowroom.errors import BagError
from elbowroom.wire import mcap_records as records
from elbowroom.wire.chain import LENGTH, LINK, Chain
from elbowroom.wire.mcap_records import AttachmentPlace, ChunkPlace
from elbowroom.wire.mcap_tail import Tail
from elbowroom.wire.mcap_writer import LIBRARY

HEAD = records.MAGIC + records.header(LIBRARY)
"""How each such file begins."""
PIECE = 1 << 18
"""So much is read at once to add it up [bytes]."""
MOST_TEXT = 256
"""No topic and no name has more letters [bytes]."""


class Record(NamedTuple):
    """Where a record lies.

    Args:
        kind: its number.
        at: where it begins [bytes].
        begin: where its content begins [bytes].
        size: of its content [bytes].
    """

    kind: int
    at: int
    begin: int
    size: int

    @property
    def end(self) -> int:
        """Where the next one begins [bytes]."""
        return self.begin + self.size


class Read(NamedTuple):
    """A message as it was read.

    Args:
        topic: of its channel.
        number: of the message in its channel.
        data: its bytes.
    """

    topic: str
    number: int
    data: memoryview


class ChainedFile:
    """A file, looked through.

    Args:
        path: the file.

    Raises:
        BagError: it cannot be read, or does not begin as such a file.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        self.note: str | None = None
        self.linked = 0
        """Up to here links speak of it [bytes]."""
        self._chunks, self._sizes, self._ends = array("Q"), array("Q"), array("Q")
        self._topics: dict[int, str] = {}
        self._attached: list[Record] = []
        self._end: int | None = None
        self._looked = 0
        try:
            self._file = path.open("rb")
        except OSError as error:
            raise BagError(f"{path}: cannot be read ({error.strerror})") from None
        try:
            self.length = os.fstat(self._file.fileno()).st_size
            self._look_through()
        except BaseException:
            self.close()
            raise

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def close(self) -> None:
        """Lets go of the file."""
        self._file.close()

    def __len__(self) -> int:
        """How many steps there are."""
        return len(self._chunks)

    def step(self, number: int) -> list[Read]:
        """The messages of a step.

        Args:
            number: from 0.

        Raises:
            BagError: it is damaged.
        """
        begin, size = self._chunks[number], self._sizes[number]
        found, topics = list[Read](), self._topics_up_to(number)
        for record in self._within(begin, size):
            if record.kind != records.MESSAGE:
                continue
            content = self._at(record.begin, record.size)
            channel, sequence, _, _ = records.MESSAGE_HEAD.unpack_from(content)
            if channel not in topics:
                raise self._damaged(record.at)
            data = memoryview(content)[records.MESSAGE_HEAD.size :]
            found.append(Read(topics[channel], sequence, data))
        return found

    def attached(self, name: str) -> bytes | None:
        """The content of a file within it; None: there is none of that name.

        Args:
            name: of that file.

        Raises:
            BagError: it is damaged.
        """
        for record in self._attached:
            place = self._attachment(record)
            if place.name == name:
                return self._exactly(record.end - 4 - place.size, place.size)
        return None

    def wrong(self, tell: Callable[[int], None] = lambda done: None) -> str | None:
        """What is not as it was written, in a sentence, every bit of the file looked at; None: nothing.

        A file that was only cut off is not wrong: `note` says that.

        Args:
            tell: told how many bytes have been looked at.
        """
        try:
            return self._wrong(tell)
        except BagError as error:
            return str(error)

    @property
    def ends(self) -> tuple[int, ...]:
        """Where each step ends with its link [bytes]."""
        return tuple(self._ends)

    @property
    def sum(self) -> str:
        """Of the last link; empty: there is none."""
        return self._at(self.linked - LENGTH, LENGTH).decode("ascii", "replace") if self.linked else ""

    def _look_through(self) -> None:
        begin = self._at(0, len(HEAD))
        if begin != HEAD[: len(begin)]:
            raise BagError(
                f"{self.path}: not a recording of `elbowroom monitor`, or damaged in its first bytes"
            )
        if len(begin) < len(HEAD):
            self.note = self._cut(0)
            return
        chunk: Record | None = None
        attached: list[Record] = []
        for record in self._records(len(HEAD)):
            if record.kind == records.CHUNK and chunk is None and self.linked:
                chunk = record
            elif record.kind == records.ATTACHMENT and not self.linked:
                attached.append(record)
            elif self._is_link(record):
                self.linked = record.end
                self._attached, attached = self._attached + attached, []
                if chunk is not None:
                    self._chunks.append(chunk.begin)
                    self._sizes.append(chunk.size)
                    self._ends.append(record.end)
                chunk = None
            elif record.kind == records.DATA_END and record.at == self.linked:
                self._end = record.at
                return
            elif record.kind != records.MESSAGE_INDEX or chunk is None:
                self.note = self._cut(record.at)
                return
        self.note = self._cut(self.linked)

    def _cut(self, at: int) -> str:
        return (
            f"{self.path}: cut off or damaged at byte {max(at, self.linked):,} of {self.length:,}; it is read up to "
            f"byte {self.linked:,}"
        )

    def _wrong(self, tell: Callable[[int], None]) -> str | None:
        chain, tail, begin = Chain(), Tail(), 0
        chunk: Record | None = None
        indexes: list[Record] = []
        for record in self._records(len(HEAD), self.linked):
            if record.kind == records.CHUNK:
                chunk, indexes = record, []
            elif record.kind == records.MESSAGE_INDEX:
                indexes.append(record)
            elif record.kind == records.ATTACHMENT:
                tail.attachments.append(self._attachment(record))
            elif self._is_link(record):
                self._take(chain, begin, record.end - LENGTH, tell)
                if chain.close().encode() != self._at(record.end - LENGTH, LENGTH):
                    return f"{self.path}: bytes {begin:,} to {record.end:,} are not as they were written"
                begin = record.end
                tail.metadata += 1
                if chunk is not None:
                    self._add(tail, chunk, indexes)
                chunk = None
        return self._wrong_tail(tail)

    def _take(self, chain: Chain, begin: int, end: int, tell: Callable[[int], None]) -> None:
        for at in range(begin, end, PIECE):
            chain.take(self._exactly(at, min(PIECE, end - at)))
        tell(end)

    def _add(self, tail: Tail, chunk: Record, indexes: Sequence[Record]) -> None:
        """Gathers what the summary says of a chunk."""
        counts: dict[int, int] = {}
        for record in self._within(chunk.begin, chunk.size):
            if record.kind == records.SCHEMA:
                tail.schemas.append(self._exactly(record.at, record.end - record.at))
            elif record.kind == records.CHANNEL:
                tail.channels.append(self._exactly(record.at, record.end - record.at))
            else:
                number = int.from_bytes(self._exactly(record.begin, 2), "little")
                counts[number] = counts.get(number, 0) + 1
        first, last, size, *_ = records.CHUNK_HEAD.unpack(self._exactly(chunk.begin, records.CHUNK_HEAD.size))
        places = {int.from_bytes(self._exactly(one.begin, 2), "little"): one.at for one in indexes}
        length = sum(one.end - one.at for one in indexes)
        tail.add(ChunkPlace(first, last, chunk.at, chunk.end - chunk.at, places, length, size), counts)

    def _attachment(self, record: Record) -> AttachmentPlace:
        """What a file within the file says of itself."""
        name, at = self._text(record.begin + 16, record.end)
        media_type, at = self._text(at, record.end)
        (size,) = struct.unpack("<Q", self._exactly(at, 8))
        if at + 8 + size + 4 != record.end:
            raise self._damaged(record.at)
        return AttachmentPlace(record.at, record.end - record.at, size, name, media_type)

    def _wrong_tail(self, tail: Tail) -> str | None:
        """What is wrong with the end of the file, of which no link speaks."""
        if self._end is None:
            return None  # `note` says it
        due = tail.content(self._end)
        for at in range(0, max(len(due), self.length - self._end), PIECE):
            found = self._at(self._end + at, PIECE)
            wanted = due[at : at + PIECE]
            if found != wanted:
                if wanted.startswith(found) and self._end + at + len(found) == self.length:
                    self.note = f"{self.path}: cut off in the summary at its end; every pass is there"
                    return None
                return f"{self.path}: the summary at its end, from byte {self._end + at:,}, is not as it was written"
        return None

    def _records(self, at: int, end: int | None = None) -> Iterator[Record]:
        """Records that are whole."""
        end = self.length if end is None else end
        while True:
            head = self._at(at, records.RECORD.size)
            if at + records.RECORD.size > end or len(head) < records.RECORD.size:
                return
            kind, size = records.RECORD.unpack(head)
            begin = at + records.RECORD.size
            if begin + size > end:
                return
            yield Record(kind, at, begin, size)
            at = begin + size

    def _within(self, begin: int, size: int) -> Iterator[Record]:
        """Records of a chunk.

        Raises:
            BagError: it is damaged.
        """
        head = self._exactly(begin, records.CHUNK_HEAD.size)
        _, _, unpacked, _, name, packed = records.CHUNK_HEAD.unpack(head)
        content, end = begin + len(head), begin + size
        if name != 0 or not packed == unpacked == end - content:
            raise self._damaged(begin)
        at = content
        for record in self._records(content, end):
            least = records.MESSAGE_HEAD.size if record.kind == records.MESSAGE else 4
            if record.kind not in (records.SCHEMA, records.CHANNEL, records.MESSAGE) or record.size < least:
                raise self._damaged(record.at)
            at = record.end
            yield record
        if at != end:
            raise self._damaged(at)

    def _topics_up_to(self, number: int) -> dict[int, str]:
        """By channel, the topics that are named up to a step."""
        while self._looked <= number:
            for record in self._within(self._chunks[self._looked], self._sizes[self._looked]):
                if record.kind == records.CHANNEL:
                    channel = int.from_bytes(self._exactly(record.begin, 2), "little")
                    self._topics[channel] = self._text(record.begin + 4, record.end)[0]
            self._looked += 1
        return self._topics

    def _is_link(self, record: Record) -> bool:
        length = len(LINK) + LENGTH
        return (
            record.kind == records.METADATA
            and record.end - record.at == length
            and self._at(record.at, len(LINK)) == LINK
        )

    def _text(self, at: int, end: int) -> tuple[str, int]:
        (length,) = struct.unpack("<I", self._exactly(at, 4))
        if length > MOST_TEXT or at + 4 + length > end:
            raise self._damaged(at)
        try:
            return self._exactly(at + 4, length).decode(), at + 4 + length
        except UnicodeDecodeError:
            raise self._damaged(at) from None

    def _damaged(self, at: int) -> BagError:
        return BagError(f"{self.path}: damaged about byte {at:,}")

    def _exactly(self, at: int, size: int) -> bytes:
        if at + size > self.length:
            raise self._damaged(at)
        found = self._at(at, size)
        if len(found) != size:
            raise BagError(f"{self.path}: no longer what it was; is it being changed while it is read?")
        return found

    def _at(self, at: int, size: int) -> bytes:
        self._file.seek(at)
        return self._file.read(min(size, max(self.length - at, 0)))
