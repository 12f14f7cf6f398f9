"""Images whose memory is taken again once nobody holds them: fresh pages cost more than the work on them."""

import weakref
from collections import deque

import numpy as np
from numpy.typing import NDArray

KEPT = 64
"""Images of one size that wait to be used again, at most."""

_waiting: dict[int, deque[memoryview]] = {}


def zero_image(height: int, width: int) -> NDArray[np.float32]:
    """A float32 image of zeros, shape (height, width), perhaps in memory that an image used before.

    That memory is free again when the image and all views of it are gone, and not before: numpy lets every
    view hold the flat array below, whose own memory comes from a buffer that is no array.
    """
    size = height * width
    waiting = _waiting.setdefault(size, deque(maxlen=KEPT))
    try:
        memory = waiting.pop()
        flat = np.frombuffer(memory, dtype=np.float32)
        flat[:] = 0
    except IndexError:
        memory = np.zeros(size, dtype=np.float32).data
        flat = np.frombuffer(memory, dtype=np.float32)
    weakref.finalize(flat, waiting.append, memory).atexit = False
    return flat.reshape(height, width)
