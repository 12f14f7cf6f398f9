"""Images whose memory is taken again once nobody holds them: fresh pages cost more than the work on them."""

import weakref
from collections import deque

import numpy as np
from numpy.typing import NDArray

KEPT = 64
"""Images of one size that wait to be used again, at most."""

_waiting: dict[int, deque[memoryview]] = {}


def zero_image(height: int, width: int) -> NDArray[np.float32]:
    """A float32 image of zeros, shape (height, width), perhaps in memory that an image used before (`spare_image`)."""
    image = spare_image(height, width)
    # byte by byte, which is one call that fills memory; numbers of four bytes are written one at a time
    image.reshape(-1).view(np.uint8).fill(0)
    return image.view(np.float32)


def spare_image(height: int, width: int) -> NDArray[np.uint32]:
    """A uint32 image of whatever is in its memory, shape (height, width), perhaps of an image used before.

    That memory is free again when the image and all views of it are gone, and not before: numpy lets every
    view hold the flat array below, whose own memory comes from a buffer that is no array.
    """
    size = height * width
    waiting = _waiting.setdefault(size, deque(maxlen=KEPT))
    try:
        memory = waiting.pop()
    except IndexError:
        memory = np.empty(size, dtype=np.uint32).data
    flat = np.frombuffer(memory, dtype=np.uint32)
    weakref.finalize(flat, waiting.append, memory).atexit = False
    return flat.reshape(height, width)
