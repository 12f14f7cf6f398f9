"""Depth images as small numbers and back, bit for bit: units, differences along the row, most of them in half a byte.

A difference is written as its zigzag (0, -1, 1, -2, ... as 0, 1, 2, 3, ...). Those below the greatest number of a
*code* (15 in half a byte, 255 in a byte) are the code; of others the code is that greatest number, and they follow
apart, in their order.
"""

import numpy as np
from numba import njit

HALF, BYTE = 15, 255
"""The greatest number of a code; it says that the difference follows apart."""
ROUNDS = np.float32(12582912.0)
"""1.5 * 2**23: added to a float32 below 2**22 it leaves the nearest whole number in the lowest bits."""
PIECE = 2048
"""Pixels that are worked on while they are in the nearest cache."""


@njit(cache=True, nogil=True)
def to_units(depth, bits, scale, bias, units):
    """Depth as whole units; whether `from_units` gives back the same bits.

    Args:
        depth: float32, shape (n,) [m].
        bits: the same memory as int32.
        scale, bias: float32: metres per unit, and what was added after that [m].
        units: uint16, shape (n,); written.
    """
    inverse = np.float32(1.0) / scale
    some = np.empty(PIECE, np.float32)
    some_bits = some.view(np.int32)
    wrong = np.int32(0)
    for begin in range(0, depth.size, PIECE):
        end = min(depth.size, begin + PIECE)
        given, given_bits, out = depth[begin:end], bits[begin:end], units[begin:end]
        # loops of one step each: the compiler turns each into vectors
        for x in range(given.size):
            some[x] = (given[x] - bias) * inverse + ROUNDS
        for x in range(given.size):
            out[x] = np.uint16(0) if given_bits[x] == 0 else np.uint16(some_bits[x])
        for x in range(given.size):
            some[x] = _metres(out[x], scale, bias)
        for x in range(given.size):
            wrong |= some_bits[x] ^ given_bits[x]
    return wrong == 0


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
def differences(numbers, zigzag):
    """What each number is more than the one before it, as zigzag, and modulo the type's size.

    Args:
        numbers: uint16, shape (n,).
        zigzag: uint16, shape (n,); written.
    """
    before = np.uint16(0)
    if numbers.size:
        first = np.int16(numbers[0] - before)
        zigzag[0] = np.uint16((first << 1) ^ (first >> 15))
    for x in range(1, numbers.size):
        more = np.int16(numbers[x] - numbers[x - 1])
        zigzag[x] = np.uint16((more << 1) ^ (more >> 15))


@njit(cache=True, nogil=True)
def differences_32(numbers, zigzag):
    """As `differences`, of 32 bits.

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
def many_above(zigzag, most):
    """How many are `most` or above, counted in every eighth piece of 64.

    Args:
        zigzag: uint16, shape (n,).
        most: the greatest number of a code.
    """
    many = 0
    for begin in range(0, zigzag.size, 512):
        some = zigzag[begin : min(zigzag.size, begin + 64)]
        for x in range(some.size):
            many += np.int64(some[x] >= most)
    return many


@njit(cache=True, nogil=True)
def to_bytes(zigzag, codes, apart):
    """One code a byte; how many numbers follow apart.

    Args:
        zigzag: uint16, shape (n,).
        codes: uint8, shape (n,); written.
        apart: uint16, shape (n,); its begin is written.
    """
    many = 0
    for begin in range(0, zigzag.size, 64):
        end = min(zigzag.size, begin + 64)
        given, out = zigzag[begin:end], codes[begin:end]
        greatest = np.uint16(0)
        for x in range(given.size):
            out[x] = np.uint8(min(given[x], np.uint16(BYTE)))
            greatest = max(greatest, given[x])
        if greatest >= BYTE:
            many = _set_apart(given, BYTE, apart, many)
    return many


@njit(cache=True, nogil=True)
def to_halves(zigzag, codes, apart):
    """Two codes a byte, the first in its lower half; how many numbers follow apart.

    Args:
        zigzag: uint16, shape (n,).
        codes: uint8, shape ((n + 1) // 2,); written.
        apart: uint16, shape (n,); its begin is written.
    """
    small = np.zeros(64, np.uint8)
    many = 0
    for begin in range(0, zigzag.size, 64):
        end = min(zigzag.size, begin + 64)
        given, out = zigzag[begin:end], codes[begin // 2 : (end + 1) // 2]
        greatest = np.uint16(0)
        for x in range(given.size):
            small[x] = np.uint8(min(given[x], np.uint16(HALF)))
            greatest = max(greatest, given[x])
        if given.size % 2:
            small[given.size] = np.uint8(0)
        for x in range(out.size):
            out[x] = small[2 * x] | (small[2 * x + 1] << 4)
        if greatest >= HALF:
            many = _set_apart(given, HALF, apart, many)
    return many


@njit(inline="always")
def _set_apart(given, most, apart, many):
    for x in range(given.size):
        if given[x] >= most:
            apart[many] = given[x]
            many += 1
    return many


@njit(cache=True, nogil=True)
def from_codes(codes, is_half, apart, units):
    """The numbers again; whether the codes use all that follows apart, and no more.

    Args:
        codes: uint8, as `to_bytes` or `to_halves` writes them.
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
