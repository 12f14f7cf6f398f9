"""What Pillow raises of a picture that is damaged: not only what it says, also what its decoders run into."""

import struct
import zlib
from typing import BinaryIO

from PIL import Image

SIGNATURE, HEAD, SUM = 8, 8, 4
"""Of a PNG, and of each of its chunks [bytes]."""
DAMAGED: tuple[type[Exception], ...] = (
    OSError,
    SyntaxError,
    ValueError,
    EOFError,
    LookupError,
    TypeError,
    AttributeError,
    ArithmeticError,
    RuntimeError,
    struct.error,
    zlib.error,
    Image.DecompressionBombError,
)


def chunk_beyond_end(file: BinaryIO) -> bool:
    """Whether a chunk of a PNG says that it is longer than what follows: Pillow would make room for all of it.

    Args:
        file: at its beginning, where it is left as well.
    """
    length, at = file.seek(0, 2), SIGNATURE
    while at + HEAD <= length:
        file.seek(at)
        at += HEAD + int.from_bytes(file.read(4), "big") + SUM
        if at > length:
            break
    file.seek(0)
    return at > length
