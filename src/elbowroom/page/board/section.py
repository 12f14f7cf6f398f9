"""A place in shared memory where one process writes and another reads: newest wins, nobody waits.

Two slots take turns. A slot begins and ends with the number of what is in it: where both are the same before and after
it was copied, nobody wrote into it meanwhile. The writer never looks at what a reader does.

A processor that shows one core's writes to another in another order (ARM) could show the numbers before the bytes: so
what is read is compared with a sum of its bytes, too, where it is no longer than `SUMMED`.
"""

import struct
import zlib
from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

HEAD = struct.Struct("<QQQQ")
"""Of a slot: number, length, sum, number again."""
PUBLISHED = struct.Struct("<Q")
SUMMED = 1 << 22
"""What is longer is not summed up [bytes]."""
TRIES = 8


def space_for(capacity: int) -> int:
    """How many bytes a section takes.

    Args:
        capacity: of one slot [bytes].
    """
    return 64 + 2 * (64 + _up(capacity))


def _up(size: int) -> int:
    return -(-size // 64) * 64


@dataclass(slots=True, eq=False)
class Section:
    """A section of shared memory.

    Args:
        memory: its bytes, `space_for(capacity)` of them, zero at first.
        capacity: the most that is written at once [bytes].
    """

    memory: memoryview
    capacity: int
    _number: int = field(default=0, init=False)

    def put(self, parts: Sequence[bytes | memoryview]) -> bool:
        """Writes; what was written before last is gone. Whether it fitted.

        Args:
            parts: bytes, one after the other.
        """
        views = [memoryview(part).cast("B") for part in parts]
        length = sum(len(view) for view in views)
        if length > self.capacity:
            return False
        self._number += 1
        slot = self._slot(self._number)
        total = 0
        # begun, and not ended: whoever reads now sees two numbers
        HEAD.pack_into(slot, 0, self._number, length, 0, 0)
        at = 64
        for view in filter(len, views):
            # NumPy lets go of the interpreter's lock while it copies, and so does the sum
            np.copyto(np.frombuffer(slot[at : at + len(view)], np.uint8), np.frombuffer(view, np.uint8))
            at += len(view)
            if length <= SUMMED:
                total = zlib.crc32(view, total)
        HEAD.pack_into(slot, 0, self._number, length, total, self._number)
        PUBLISHED.pack_into(self.memory, 0, self._number)
        return True

    @property
    def number(self) -> int:
        """Of what was written last; 0: nothing."""
        return int(PUBLISHED.unpack_from(self.memory, 0)[0])

    def get(self) -> tuple[int, bytes] | None:
        """Number and bytes of what was written last; None: nothing, or the writer is always faster."""
        for _ in range(TRIES):
            number = self.number
            if number == 0:
                return None
            slot = self._slot(number)
            begun, length, total, ended = HEAD.unpack_from(slot, 0)
            if begun != number or ended != number or length > self.capacity:
                continue
            content = bytes(slot[64 : 64 + length])
            if HEAD.unpack_from(slot, 0)[0] != number:
                continue
            if length > SUMMED or zlib.crc32(content) == total:
                return number, content
        return None

    def _slot(self, number: int) -> memoryview:
        size = 64 + _up(self.capacity)
        begin = 64 + (number & 1) * size
        return self.memory[begin : begin + size]
