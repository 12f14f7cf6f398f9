"""The one message that has to be taken apart to read a recording again."""

from elbowroom.errors import BagError
from elbowroom.wire.cdr_writer import HEAD
from elbowroom.wire.ros_messages import PLANAR, RADIAL

LONGEST = 4096
"""No name has more letters [bytes]."""


def packed_image_of(message: bytes | memoryview, what: str) -> memoryview:
    """The packed image in a message that `depth_message` wrote.

    Args:
        message: its bytes.
        what: names it in errors.

    Raises:
        BagError: it is none.
    """
    view, at = memoryview(message), len(HEAD) + 8
    if bytes(view[: len(HEAD)]) != HEAD:
        raise BagError(f"{what}: no message of a depth image")
    for is_format in (False, True):
        length = int.from_bytes(view[at : at + 4], "little")
        text = bytes(view[at + 4 : at + 4 + min(length, LONGEST)])
        if is_format and text not in (PLANAR.encode() + b"\x00", RADIAL.encode() + b"\x00"):
            raise BagError(f"{what}: no depth image of a recording")
        at += 4 + length
        at += -(at - len(HEAD)) % 4
    length = int.from_bytes(view[at : at + 4], "little")
    if at + 4 + length != len(view):
        raise BagError(f"{what}: a depth image of {max(len(view) - at - 4, 0):,} bytes, it says {length:,}")
    return view[at + 4 :]
