"""Values to the bytes of a ROS 2 message: plain CDR (OMG, DDSI-RTPS 10.2), little-endian."""

import struct
from collections.abc import Sequence
from typing import Self

HEAD = b"\x00\x01\x00\x00"
SECOND_NS = 1_000_000_000
MOST_SECONDS = 2**31 - 1


class CdrWriter:
    """A message, written from its beginning; each call adds the next value and gives the writer back."""

    __slots__ = ("_bytes",)

    def __init__(self) -> None:
        self._bytes = bytearray(HEAD)

    def done(self) -> bytes:
        """The message."""
        return bytes(self._bytes)

    def octet(self, value: int) -> Self:
        """A byte, or a flag."""
        self._bytes.append(value)
        return self

    def whole(self, value: int) -> Self:
        """A whole number of 32 bits without a sign."""
        return self._add("<I", 4, value)

    def reals(self, values: Sequence[float], counted: bool = True) -> Self:
        """Numbers of 64 bits.

        Args:
            values: in their order.
            counted: whether their number goes before them.
        """
        if counted:
            self.whole(len(values))
        return self._add(f"<{len(values)}d", 8, *values) if len(values) else self

    def text(self, value: str) -> Self:
        """A string."""
        data = value.encode() + b"\x00"
        self.whole(len(data))
        self._bytes += data
        return self

    def texts(self, values: Sequence[str]) -> Self:
        """A sequence of strings."""
        self.whole(len(values))
        for value in values:
            self.text(value)
        return self

    def done_with(self, data: Sequence[bytes | memoryview]) -> bytes:
        """The message, at whose end a sequence of bytes stands, given in pieces."""
        return b"".join((self.whole(sum(map(len, data)))._bytes, *data))

    def time(self, stamp_ns: int | None) -> Self:
        """A time [ns]; 0 where there is none, or none that the type holds."""
        seconds, rest = divmod(stamp_ns or 0, SECOND_NS)
        if not 0 <= seconds <= MOST_SECONDS:
            seconds, rest = 0, 0
        return self._add("<iI", 4, seconds, rest)

    def header(self, stamp_ns: int | None, frame: str) -> Self:
        """A header.

        Args:
            stamp_ns: as of `time`.
            frame: name of the coordinate frame.
        """
        return self.time(stamp_ns).text(frame)

    def _add(self, form: str, aligned: int, *values: float) -> Self:
        self._bytes += b"\x00" * (-(len(self._bytes) - len(HEAD)) % aligned)
        self._bytes += struct.pack(form, *values)
        return self
