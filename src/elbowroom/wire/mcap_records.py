"""Records of MCAP as bytes (mcap.dev, specification, version 0)."""

import struct
from collections.abc import Mapping, Sequence
from typing import NamedTuple

MAGIC = b"\x89MCAP0\r\n"
RECORD = struct.Struct("<BQ")
HEADER, FOOTER, SCHEMA, CHANNEL, MESSAGE, CHUNK, MESSAGE_INDEX, CHUNK_INDEX = range(1, 9)
ATTACHMENT, ATTACHMENT_INDEX, STATISTICS, METADATA, SUMMARY_OFFSET, DATA_END = 9, 10, 11, 12, 14, 15
MESSAGE_HEAD = struct.Struct("<HIQQ")
CHUNK_HEAD = struct.Struct("<QQQIIQ")
"""Of a chunk that is not compressed: first and last time, size, check sum (0: none), an empty name, size again."""


class Message(NamedTuple):
    """A message that is to be written.

    Args:
        channel: its number.
        sequence: number of the message in its channel.
        time_ns: at which it is logged [ns].
        data: its bytes.
    """

    channel: int
    sequence: int
    time_ns: int
    data: bytes | memoryview


class ChunkPlace(NamedTuple):
    """Where a chunk lies, for the index at the end.

    Args:
        first_ns, last_ns: times of its messages [ns].
        begin, length: of its record in the file [bytes].
        indexes: by channel, where the record of its messages' index begins [bytes].
        indexes_length: of all these records together [bytes].
        size: of what it holds [bytes].
    """

    first_ns: int
    last_ns: int
    begin: int
    length: int
    indexes: Mapping[int, int]
    indexes_length: int
    size: int


class AttachmentPlace(NamedTuple):
    """Where a file within the file lies, for the index at the end.

    Args:
        begin, length: of its record in the file [bytes].
        size: of its content [bytes].
        name, media_type: of it.
    """

    begin: int
    length: int
    size: int
    name: str
    media_type: str


def record(kind: int, *pieces: bytes) -> bytes:
    """A record.

    Args:
        kind: its number.
        pieces: of its content.
    """
    content = b"".join(pieces)
    return RECORD.pack(kind, len(content)) + content


def text(value: str) -> bytes:
    """A string."""
    data = value.encode()
    return struct.pack("<I", len(data)) + data


def text_map(values: Mapping[str, str]) -> bytes:
    """Strings by strings."""
    pairs = b"".join(text(key) + text(value) for key, value in values.items())
    return struct.pack("<I", len(pairs)) + pairs


def header(library: str) -> bytes:
    """The first record; messages are those of ROS 2."""
    return record(HEADER, text("ros2"), text(library))


def schema(number: int, name: str, definition: bytes) -> bytes:
    """The definition of a type of messages.

    Args:
        number: of the schema, from 1.
        name: of the type.
        definition: as `ros2msg` has it.
    """
    length = struct.pack("<I", len(definition))
    return record(SCHEMA, struct.pack("<H", number), text(name), text("ros2msg"), length, definition)


def channel(number: int, schema_number: int, topic: str) -> bytes:
    """A topic.

    Args:
        number: of the channel.
        schema_number: of its type.
        topic: its name.
    """
    return record(CHANNEL, struct.pack("<HH", number, schema_number), text(topic), text("cdr"), text_map({}))


def message_head(told: Message) -> bytes:
    """The beginning of a message; its data follows."""
    head = MESSAGE_HEAD.pack(told.channel, told.sequence, told.time_ns, told.time_ns)
    return RECORD.pack(MESSAGE, len(head) + len(told.data)) + head


def chunk_head(size: int, first_ns: int, last_ns: int) -> bytes:
    """The beginning of a chunk that is not compressed; its records follow.

    Args:
        size: of these records together [bytes].
        first_ns, last_ns: times of its messages [ns].
    """
    head = CHUNK_HEAD.pack(first_ns, last_ns, size, 0, 0, size)
    return RECORD.pack(CHUNK, len(head) + size) + head


def message_index(number: int, entries: Sequence[tuple[int, int]]) -> bytes:
    """Where in a chunk the messages of a channel are.

    Args:
        number: of the channel.
        entries: time [ns] and byte within the chunk, of each message.
    """
    pairs = b"".join(struct.pack("<QQ", time, at) for time, at in entries)
    return record(MESSAGE_INDEX, struct.pack("<HI", number, len(pairs)), pairs)


def chunk_index(place: ChunkPlace) -> bytes:
    """Where a chunk lies."""
    offsets = b"".join(struct.pack("<HQ", number, at) for number, at in place.indexes.items())
    return record(
        CHUNK_INDEX,
        struct.pack("<QQQQ", place.first_ns, place.last_ns, place.begin, place.length),
        struct.pack("<I", len(offsets)),
        offsets,
        struct.pack("<Q", place.indexes_length),
        text(""),
        struct.pack("<QQ", place.size, place.size),
    )


def attachment(name: str, media_type: str, data: bytes) -> bytes:
    """A file within the file.

    Args:
        name, media_type: of it.
        data: its content.
    """
    return record(
        ATTACHMENT,
        struct.pack("<QQ", 0, 0),
        text(name),
        text(media_type),
        struct.pack("<Q", len(data)),
        data,
        struct.pack("<I", 0),
    )


def attachment_index(place: AttachmentPlace) -> bytes:
    """Where a file within the file lies."""
    return record(
        ATTACHMENT_INDEX,
        struct.pack("<QQQQQ", place.begin, place.length, 0, 0, place.size),
        text(place.name),
        text(place.media_type),
    )


def metadata(name: str, values: Mapping[str, str]) -> bytes:
    """Words by words.

    Args:
        name: of them all.
        values: by key.
    """
    return record(METADATA, text(name), text_map(values))
