"""Depth images as small numbers and back, bit for bit: units, differences along the row, most of them in half a byte.

A difference is written as its zigzag (0, -1, 1, -2, ... as 0, 1, 2, 3, ...). Those below the greatest number of a
*code* (15 in half a byte, 255 in a byte) are the code; of others the code is that greatest number, and they follow
apart, in their order.
"""

from typing import Any, NamedTuple

import numpy as np
from numba import njit

HALF, BYTE = 15, 255
"""The greatest number of a code; it says that the difference follows apart."""
ROUNDS = np.float32(12582912.0)
"""1.5 * 2**23: added to a float32 below 2**22 it leaves the nearest whole number in the lowest bits."""
SAMPLED = 32
"""Of so many pieces one is looked at to choose the code."""
PIECE = 2048
"""Pixels that are worked on while they are in the nearest cache."""


class Scratch(NamedTuple):
    """What is known of a piece while it is worked on.

    Args:
        metres, bits: the same memory as float32 and int32, shape (PIECE,).
        units: uint16, shape (PIECE + 1,): the last one of the piece before, and its own.
        zigzag: uint16, shape (PIECE,): of what each is more than the one before.
    """

    metres: Any
    bits: Any
    units: Any
    zigzag: Any


@njit(cache=True, nogil=True)
def steps_above(depth, scale, most):
    """How often, in one of `SAMPLED` pieces of 64, the next one is so far away that its zigzag is at least `most`.

    Args:
        depth: float32, shape (n,) [m].
        scale: float32: metres per unit.
        most: the greatest number of a code.
    """
    far = np.float32(most // 2) * scale
    many = 0
    for begin in range(0, depth.size - 64, SAMPLED * 64):
        some, after = depth[begin : begin + 64], depth[begin + 1 : begin + 65]
        for x in range(some.size):
            many += np.int64(not abs(after[x] - some[x]) <= far)
    return many


@njit(cache=True, nogil=True)
def pack_units(depth, bits, scale, bias, is_half, codes, apart):
    """Depth as codes of whole units; how many numbers follow apart, or -1: `from_units` would not give back its bits.

    Args:
        depth: float32, shape (n,) [m].
        bits: the same memory as int32.
        scale, bias: float32: metres per unit, and what was added after that [m].
        is_half: whether two codes share a byte.
        codes: uint8, shape (n,), or ((n + 1) // 2,) of halves; written.
        apart: uint16, shape (n,); its begin is written.
    """
    near = scratch()
    wrong, many = np.int32(0), 0
    for begin in range(0, depth.size, PIECE):
        end = min(depth.size, begin + PIECE)
        wrong |= zigzags(depth[begin:end], bits[begin:end], scale, bias, near)
        small = near.zigzag[: end - begin]
        if is_half:
            _halves(small, codes[begin // 2 : (end + 1) // 2])
            many = _set_apart(small, HALF, apart, many)
        else:
            out = codes[begin:end]
            for x in range(out.size):
                out[x] = np.uint8(min(small[x], np.uint16(BYTE)))
            many = _set_apart(small, BYTE, apart, many)
    return many if wrong == 0 else -1


@njit(inline="always")
def scratch():
    """Memory for a piece."""
    metres = np.empty(PIECE, np.float32)
    return Scratch(
        metres, metres.view(np.int32), np.zeros(PIECE + 1, np.uint16), zigzag=np.zeros(PIECE, np.uint16)
    )


@njit(inline="always")
def zigzags(given, given_bits, scale, bias, near):
    """A piece as zigzags of whole units; not 0 where these would not give back its bits.

    Args:
        given: float32, shape (n,) [m], at most `PIECE`.
        given_bits: the same memory as int32.
        scale, bias: float32: metres per unit, and what was added after that [m].
        near: written; its first unit is the last one of the piece before.
    """
    inverse, wrong = np.float32(1.0) / scale, np.int32(0)
    some, some_bits = near.metres, near.bits
    here, small = near.units[1 : 1 + given.size], near.zigzag[: given.size]
    # loops of one step each: the compiler turns each into vectors
    for x in range(given.size):
        some[x] = (given[x] - bias) * inverse + ROUNDS
    for x in range(given.size):
        here[x] = np.uint16(0) if given_bits[x] == 0 else np.uint16(some_bits[x])
    if bias == np.float32(0):
        for x in range(given.size):
            some[x] = np.float32(here[x]) * scale
    else:
        for x in range(given.size):
            some[x] = _metres(here[x], scale, bias)
    for x in range(given.size):
        wrong |= some_bits[x] ^ given_bits[x]
    for x in range(given.size):
        more = np.int16(here[x] - near.units[x])
        small[x] = np.uint16((more << 1) ^ (more >> 15))
    near.units[0] = here[given.size - 1]
    return wrong


@njit(inline="always")
def _halves(zigzag, codes):
    """Two codes a byte, the first in its lower half."""
    for x in range(zigzag.size // 2):
        low, high = min(zigzag[2 * x], np.uint16(HALF)), min(zigzag[2 * x + 1], np.uint16(HALF))
        codes[x] = np.uint8(low | (high << 4))
    if zigzag.size % 2:
        codes[zigzag.size // 2] = np.uint8(min(zigzag[zigzag.size - 1], np.uint16(HALF)))


@njit(inline="always")
def _set_apart(zigzag, most, apart, many):
    """Adds those that are `most` or above; most pieces of 32 have none."""
    for begin in range(0, zigzag.size, 32):
        given = zigzag[begin : min(zigzag.size, begin + 32)]
        greatest = np.uint16(0)
        for x in range(given.size):
            greatest = max(greatest, given[x])
        if greatest >= most:
            for x in range(given.size):
                apart[many] = given[x]  # there is room: no more follow apart than have gone by
                many += np.int64(given[x] >= most)
    return many


@njit(cache=True, nogil=True)
def from_units(units, scale, bias, depth):
    """Depth [m] as `DepthFrame.from_raw` makes it.

    Args:
        units: uint16, shape (n,).
        scale, bias: float32: metres per unit, and what is added after that [m].
        depth: float32, shape (n,); written.
    """
    for x in range(units.size):
        depth[x] = _metres(units[x], scale, bias)


@njit(inline="always")
def _metres(unit, scale, bias):
    """0 is no return; what the bias takes to zero or below is none either."""
    metres = np.float32(unit) * scale
    if bias != np.float32(0):
        metres = metres + bias
    return np.float32(0) if unit == 0 or not metres > np.float32(0) else metres


@njit(cache=True, nogil=True)
def differences_32(numbers, zigzag):
    """What each number is more than the one before it, as zigzag, modulo 2**32.

    Args:
        numbers: uint32, shape (n,).
        zigzag: uint32, shape (n,); written.
    """
    before = np.uint32(0)
    for x in range(numbers.size):
        more = np.int32(numbers[x] - before)
        zigzag[x] = np.uint32((more << np.int32(1)) ^ (more >> np.int32(31)))
        before = numbers[x]


@njit(cache=True, nogil=True)
def from_codes(codes, is_half, apart, units):
    """The numbers again; whether the codes use all that follows apart, and no more.

    Args:
        codes: uint8, as `pack_units` writes them.
        is_half: whether two codes share a byte.
        apart: uint16, shape (m,).
        units: uint16, shape (n,); written.
    """
    most = np.uint16(HALF) if is_half else np.uint16(BYTE)
    used = 0
    before = np.uint16(0)
    for x in range(units.size):
        code = np.uint16(codes[x // 2] >> (4 * (x % 2))) & np.uint16(15) if is_half else np.uint16(codes[x])
        if code == most:
            if used == apart.size:
                return False
            code = apart[used]
            used += 1
        before = np.uint16(before + ((code >> 1) ^ np.uint16(-np.int32(code & 1))))
        units[x] = before
    return used == apart.size


@njit(cache=True, nogil=True)
def from_differences_32(zigzag, numbers):
    """The numbers whose `differences_32` are given.

    Args:
        zigzag: uint32, shape (n,).
        numbers: uint32, shape (n,); written.
    """
    before = np.uint32(0)
    for x in range(numbers.size):
        code = zigzag[x]
        before = np.uint32(before + ((code >> np.uint32(1)) ^ np.uint32(-np.int64(code & np.uint32(1)))))
        numbers[x] = before
