"""The chain of a recording: after each step the sum of all that was written since, and of the sum before.

A link is a metadata record of MCAP named `elbowroom.chain`, whose last 64 bytes are

    sum = sha256(sum of the link before + all bytes from the end of that link to the beginning of this sum)

in hexadecimal. So a link speaks of every byte before it, its own beginning too; the first one, of all from byte 0 on.
It is no signature: who can write the file can write another one, with another last sum.
"""

import hashlib

from elbowroom.wire.mcap_records import metadata

NAME = "elbowroom.chain"
KEY = "sha256"
LENGTH = 64
"""Of a sum in hexadecimal [bytes]."""
LINK = metadata(NAME, {KEY: "0" * LENGTH})[:-LENGTH]
"""A link but for its sum."""


class Chain:
    """Takes bytes, and says the sum at each link."""

    def __init__(self) -> None:
        self.sum = ""
        self._hash = hashlib.sha256()

    def take(self, piece: bytes | memoryview) -> None:
        """The next bytes of the file."""
        self._hash.update(piece)

    def link(self) -> bytes:
        """The record of a link, whose beginning is taken too; the next step begins after it."""
        self.take(LINK)
        self.close()
        return LINK + self.sum.encode()

    def close(self) -> str:
        """The sum of what was taken; the next step begins."""
        self.sum = self._hash.hexdigest()
        self._hash = hashlib.sha256(self.sum.encode())
        return self.sum
