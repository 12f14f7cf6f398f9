"""Bytes of a ROS 2 message to values: CDR (OMG, DDSI-RTPS 10.2), every length checked before anything is made of it."""

import struct
import sys
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from elbowroom.errors import BagError

ORDERS = {b"\x00\x00": ">", b"\x00\x01": "<"}
"""Plain CDR, by the first two bytes: the more or the less significant byte first. ROS 2 sends no other."""
HEAD = 4
LONGEST_TEXT = 4096
"""Names of frames, joints and encodings are shorter [bytes]."""
HEADER_BYTES = 128
"""Of a message so many bytes are looked at to find the time and the frame in its header."""


class Cdr:
    """A message, read from its beginning; each call takes the next value.

    Args:
        data: the bytes as they were sent, with the four that say how.
        what: names the message in errors.

    Raises:
        BagError: here and in every call: the bytes end before the value, or are of another representation.
    """

    __slots__ = ("_at", "_data", "_order", "_what")

    def __init__(self, data: bytes | memoryview, what: str) -> None:
        self._data, self._what, self._at = memoryview(data), what, HEAD
        order = ORDERS.get(bytes(self._data[:2]))
        if len(self._data) < HEAD or order is None:
            raise BagError(f"{what}: {len(self._data):,} bytes that do not begin as a CDR message does")
        self._order = order

    @property
    def left(self) -> int:
        """How many bytes have not been read."""
        return len(self._data) - self._at

    def whole(self, kind: str) -> int:
        """A whole number.

        Args:
            kind: as of `struct`: "i" or "I", 32 bits.
        """
        return int(self._number(kind, 4))

    def real(self) -> float:
        """A number of 64 bits."""
        return float(self._number("d", 8))

    def flag(self) -> bool:
        """A byte that is 0 or 1."""
        return bool(self._number("B", 1))

    def reals(self, count: int | None = None) -> NDArray[np.float64]:
        """Numbers of 64 bits.

        Args:
            count: how many; None: the message says it.
        """
        count = self.count(8) if count is None else count
        if count == 0:
            return np.zeros(0)
        return np.frombuffer(self._take(8 * count, 8), f"{self._order}f8").astype(np.float64)

    def octets(self) -> memoryview:
        """A sequence of bytes, not copied."""
        return self._take(self.count(1), 1)

    def text(self) -> str:
        """A string."""
        length = self.count(1)
        if length > LONGEST_TEXT:
            raise BagError(f"{self._what}: a text of {length:,} bytes; names have at most {LONGEST_TEXT:,}")
        read = bytes(self._take(length, 1)).rstrip(b"\x00")
        try:
            return read.decode()
        except UnicodeDecodeError:
            raise BagError(f"{self._what}: a text that is not UTF-8: {read[:20]!r}") from None

    def texts(self) -> Sequence[str]:
        """A sequence of strings."""
        return [self.text() for _ in range(self.count(HEAD))]

    def count(self, least: int) -> int:
        """How many values follow; no more than the rest of the message can hold.

        Args:
            least: bytes that each takes at least.
        """
        count = self.whole("I")
        if count * least > self.left:
            raise BagError(
                f"{self._what}: says that {count:,} values follow, and has {self.left:,} bytes left"
            )
        return count

    def _number(self, kind: str, size: int) -> float:
        return struct.unpack(self._order + kind, self._take(size, size))[0]

    def _take(self, size: int, aligned: int) -> memoryview:
        begin = self._at + (HEAD - self._at) % aligned
        if begin + size > len(self._data):
            raise BagError(
                f"{self._what}: ends after {len(self._data):,} bytes, {begin + size - len(self._data):,} too early"
            )
        self._at = begin + size
        return self._data[begin : self._at]


def stamp_at_head(start: bytes | memoryview) -> int | None:
    """The time [ns] in the header with which most messages begin; None: these bytes are too few, or no CDR.

    Args:
        start: of the message, 12 bytes or more.
    """
    order = ORDERS.get(bytes(start[:2]))
    if order is None or len(start) < HEAD + 8:
        return None
    seconds, rest = struct.unpack_from(f"{order}iI", start, HEAD)
    return int(seconds) * 1_000_000_000 + int(rest)


def frame_at_head(start: bytes | memoryview) -> str | None:
    """The name of the frame in that header; None: these bytes end before it, or are no CDR, or no text.

    Args:
        start: of the message, as much as there is of it up to `HEADER_BYTES`.
    """
    order = ORDERS.get(bytes(start[:2]))
    at = HEAD + 12
    if order is None or len(start) < at:
        return None
    (length,) = struct.unpack_from(f"{order}I", start, at - 4)
    if at + length > len(start):
        return None
    try:
        return sys.intern(bytes(start[at : at + length]).rstrip(b"\x00").decode())
    except UnicodeDecodeError:
        return None
