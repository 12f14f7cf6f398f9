"""A chunk of an MCAP file: many records, compressed together; and what there is of one that is cut off."""

import struct
import zlib
from typing import NamedTuple

from elbowroom.errors import BagError
from elbowroom.sources.bags.storage import LARGEST_MESSAGE
from elbowroom.sources.bags.unpacked import unpacked_as_far

LARGEST_CHUNK = LARGEST_MESSAGE
"""A chunk that unpacks to more is not read [bytes]."""
FIXED = struct.Struct("<QQQI")
"""First and last time, size when it is unpacked, check sum."""
LONGEST_NAME = 32
LONGEST_HEAD = FIXED.size + 4 + LONGEST_NAME + 8
"""What a chunk says of itself is no longer [bytes]."""


class Chunk(NamedTuple):
    """Where a chunk's content lies.

    Args:
        begin: of the packed content in the file [bytes].
        packed: how much of it is there [bytes].
        unpacked: its size when it is unpacked, as it says [bytes].
        crc: its check sum then; 0: it has none.
        kind: how it is compressed.
        is_whole: whether all of it is there.
    """

    begin: int
    packed: int
    unpacked: int
    crc: int
    kind: str
    is_whole: bool


def chunk_of(head: bytes, begin: int, size: int) -> Chunk | None:
    """What a chunk says of itself; None: it is cut off in that.

    Args:
        head: its first bytes, up to `LONGEST_HEAD`.
        begin: where it begins in the file [bytes].
        size: how much of it is there [bytes].

    Raises:
        BagError: it says what cannot be.
    """
    what = f"chunk at byte {begin:,}"
    if len(head) < FIXED.size + 4:
        return None
    _, _, unpacked, crc = FIXED.unpack_from(head)
    (letters,) = struct.unpack_from("<I", head, FIXED.size)
    if letters > LONGEST_NAME:
        raise BagError(f"{what}: damaged (the name of its compression has {letters:,} bytes)")
    at = FIXED.size + 4 + letters
    if len(head) < at + 8:
        return None
    (packed,) = struct.unpack_from("<Q", head, at)
    if max(unpacked, packed) > LARGEST_CHUNK:
        raise BagError(f"{what}: {max(unpacked, packed):,} bytes, at most {LARGEST_CHUNK:,} are read")
    there = size - at - 8
    kind = head[FIXED.size + 4 : at].decode("ascii", "replace")
    return Chunk(begin + at + 8, min(packed, there), unpacked, crc, kind, packed <= there)


def content_of(chunk: Chunk, packed: bytes) -> bytes:
    """The records of a chunk; of one that is cut off, as far as it goes.

    Args:
        chunk: what it says of itself.
        packed: what is there of its content.

    Raises:
        BagError: it is damaged.
        PackageError: the package that unpacks it is not installed.
    """
    what = f"chunk at byte {chunk.begin:,}"
    content, damage = unpacked_as_far(packed, chunk.kind, chunk.unpacked, what)
    if not chunk.is_whole:
        return content
    if damage is not None or len(content) != chunk.unpacked:
        raise BagError(f"{what}: damaged ({damage or f'{len(content):,} bytes of {chunk.unpacked:,}'})")
    if chunk.crc and zlib.crc32(content) != chunk.crc:
        raise BagError(f"{what}: damaged (its check sum is wrong)")
    return content
