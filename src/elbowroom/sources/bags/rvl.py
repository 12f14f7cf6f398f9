"""RVL: depth as runs of nothing and differences, in threes of bits.

Wilson, "Fast Lossless Depth Image Compression", ISS 2017.

Nibbles lie in words of 32 bits, the first in the highest place. Each has three bits of a number, the lowest first, and
one that says whether the number goes on. Numbers: how many pixels have no depth, how many have one, and of each of
these what it is more than the one before, even numbers up and odd ones down.
"""

import numpy as np
from numpy.typing import NDArray

from elbowroom.errors import FrameError

MOST_NIBBLES = 11
"""A number of 32 bits has no more."""


def rvl_pixels(data: bytes | memoryview, name: str, width: int, height: int) -> NDArray[np.uint16]:
    """The pixels of an image.

    Args:
        data: compressed.
        name: what it is called in errors.
        width, height: [px].

    Returns:
        shape (height, width), uint16.

    Raises:
        FrameError: it ends too early, or has more pixels than its size says.
    """
    size = width * height
    if len(data) > 4 * size + 64:
        raise FrameError(
            f"{name}: {len(data):,} bytes of RVL, which is too much for {width} x {height} pixels"
        )
    numbers = _numbers(data, name)
    pixels = np.zeros(size, dtype=np.uint16)
    at, done, before = 0, 0, 0
    while done < size:
        if at + 2 > len(numbers):
            raise FrameError(f"{name}: truncated RVL, {done:,} pixels of {size:,}")
        empty, full = int(numbers[at]), int(numbers[at + 1])
        at += 2
        if empty + full == 0 or done + empty + full > size or at + full > len(numbers):
            raise FrameError(f"{name}: damaged RVL after {done:,} pixels of {size:,}")
        done += empty
        if full:
            coded = numbers[at : at + full]
            depths = before + np.cumsum((coded >> 1) ^ -(coded & 1))
            if depths.min() < 0 or depths.max() > 65535:
                raise FrameError(f"{name}: damaged RVL, depths beyond 16 bits")
            pixels[done : done + full] = depths.astype(np.uint16)
            before = int(depths[-1])
            at, done = at + full, done + full
    return pixels.reshape(height, width)


def _numbers(data: bytes | memoryview, name: str) -> NDArray[np.int64]:
    """All numbers, one after the other; what fills the last word is zeros."""
    words = np.frombuffer(data[: len(data) // 4 * 4], dtype="<u4")
    nibbles = ((words[:, None] >> np.arange(28, -1, -4, dtype=np.uint32)) & 15).ravel()
    last = np.flatnonzero((nibbles & 8) == 0)
    if not len(last):
        return np.zeros(0, dtype=np.int64)
    first = np.concatenate([[0], last[:-1] + 1])
    if int((last - first).max()) >= MOST_NIBBLES:
        raise FrameError(f"{name}: damaged RVL, a number of more than 32 bits")
    nibbles = nibbles[: last[-1] + 1].astype(np.int64)
    place = np.arange(len(nibbles)) - np.repeat(first, last - first + 1)
    return np.add.reduceat((nibbles & 7) << (3 * place), first)
