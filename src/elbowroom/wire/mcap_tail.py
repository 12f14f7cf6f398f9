"""The end of an MCAP file: a summary by which others find messages. All of it follows from what goes before it."""

import struct
from collections.abc import Mapping
from dataclasses import dataclass, field

from elbowroom.wire import mcap_records as records
from elbowroom.wire.mcap_records import AttachmentPlace, ChunkPlace

FOOTER_SIZE = 9 + 20


@dataclass(slots=True, eq=False)
class Tail:
    """Gathers what the summary says.

    Args:
        schemas: records of schemas, in their order.
        channels: records of channels, in their order.
        attachments: where files within the file lie.
        metadata: how many records of words there are.
    """

    schemas: list[bytes] = field(default_factory=list)
    channels: list[bytes] = field(default_factory=list)
    attachments: list[AttachmentPlace] = field(default_factory=list)
    metadata: int = 0
    _chunks: bytearray = field(default_factory=bytearray)
    _many: int = 0
    _messages: dict[int, int] = field(default_factory=dict)
    _first_ns: int | None = None
    _last_ns: int = 0

    def add(self, place: ChunkPlace, messages: Mapping[int, int]) -> None:
        """A chunk was written.

        Args:
            place: where it lies.
            messages: how many it holds, by channel.
        """
        self._chunks += records.chunk_index(place)
        self._many += 1
        for number, many in messages.items():
            self._messages[number] = self._messages.get(number, 0) + many
        self._first_ns = place.first_ns if self._first_ns is None else min(self._first_ns, place.first_ns)
        self._last_ns = max(self._last_ns, place.last_ns)

    def content(self, begin: int) -> bytes:
        """All bytes from the end of the data to the end of the file.

        Args:
            begin: how long the file is without them [bytes].
        """
        end_of_data = records.record(records.DATA_END, struct.pack("<I", 0))
        groups = (
            (records.SCHEMA, b"".join(self.schemas)),
            (records.CHANNEL, b"".join(self.channels)),
            (records.STATISTICS, self._statistics()),
            (records.CHUNK_INDEX, bytes(self._chunks)),
            (records.ATTACHMENT_INDEX, b"".join(map(records.attachment_index, self.attachments))),
        )
        start = at = begin + len(end_of_data)
        offsets = []
        for kind, content in groups:
            if content:
                offsets.append(
                    records.record(records.SUMMARY_OFFSET, struct.pack("<BQQ", kind, at, len(content)))
                )
            at += len(content)
        footer = records.record(records.FOOTER, struct.pack("<QQI", start, at, 0))
        summary = b"".join(content for _, content in groups)
        return end_of_data + summary + b"".join(offsets) + footer + records.MAGIC

    def _statistics(self) -> bytes:
        counts = b"".join(struct.pack("<HQ", *pair) for pair in sorted(self._messages.items()))
        return records.record(
            records.STATISTICS,
            struct.pack(
                "<QHIIIIQQ",
                sum(self._messages.values()),
                len(self.schemas),
                len(self.channels),
                len(self.attachments),
                self.metadata,
                self._many,
                self._first_ns or 0,
                self._last_ns,
            ),
            struct.pack("<I", len(counts)),
            counts,
        )
