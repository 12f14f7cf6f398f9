"""Depth images as rows of eight small numbers, each row in as few bits as its greatest number takes, and back.

The numbers are the zigzags of `depth.py`. Those of a row stand beside each other: the first bits of eight words of 16
are the first row, the next ones the second, so that a row is one move of a vector. A row whose numbers take 15 bits
has 16.
"""

from typing import Any

import numpy as np
from llvmlite import ir
from numba import njit, types
from numba.core import cgutils
from numba.extending import intrinsic, overload

from elbowroom.wire.kernels.depth import PIECE, scratch, zigzags

ROW = 8
"""Numbers of a row."""
FULL, WHOLE = 15, 16
"""Bits that are written as `FULL` are `WHOLE`: so each row's fit into half a byte."""


@njit(cache=True, nogil=True)
def pack_rows(depth, bits, scale, bias, widths, words):
    """Depth as rows of whole units; how many rows of words are used, or -1: units would not give back its bits.

    Args:
        depth: float32, shape (n,) [m].
        bits: the same memory as int32.
        scale, bias: float32: metres per unit, and what was added after that [m].
        widths: uint8, shape (n / 16,), rounded up: bits of each row, two a byte, the first in its lower half; written.
        words: uint16, shape (n + 24,) or more; its begin is written.
    """
    near, wides = scratch(), np.zeros(PIECE // ROW + 1, np.uint8)
    wrong, at, filled = np.int32(0), 0, np.uint32(0)
    words[:ROW] = 0
    for begin in range(0, depth.size, PIECE):
        end = min(depth.size, begin + PIECE)
        wrong |= zigzags(depth[begin:end], bits[begin:end], scale, bias, near)
        rows = (end - begin + ROW - 1) // ROW
        near.zigzag[end - begin : ROW * rows] = 0
        for row in range(rows):
            wide = np.uint32(put_row(near.zigzag, row, words, at, filled))
            wide += np.uint32(wide == FULL)
            wides[row] = np.uint8(min(wide, np.uint32(FULL)))
            filled += wide
            at += np.int64(filled >> np.uint32(4))
            filled &= np.uint32(15)
        wides[rows] = 0
        out = widths[begin // (2 * ROW) : begin // (2 * ROW) + (rows + 1) // 2]
        for x in range(out.size):
            out[x] = wides[2 * x] | (wides[2 * x + 1] << 4)
    used = at + np.int64(filled > 0)
    return used if wrong == 0 else -1


@njit(cache=True, nogil=True)
def from_rows(widths, words, units):
    """The numbers again; whether rows use all words, and no more.

    Args:
        widths, words: uint8 and uint16, as `pack_rows` writes them; words are whole rows.
        units: uint16, shape (n,); written.
    """
    at, filled, there = 0, 0, words.size // ROW
    before = np.uint16(0)
    for row in range((units.size + ROW - 1) // ROW):
        wide = np.int64(widths[row // 2] >> (4 * (row % 2))) & 15
        wide = WHOLE if wide == FULL else wide
        if at + (filled + wide + 15) // 16 > there:
            return False
        for x in range(ROW * row, min(ROW * row + ROW, units.size)):
            code = np.uint32(0)
            if wide > 0:
                code = np.uint32(words[ROW * at + x % ROW]) >> np.uint32(filled)
            if filled + wide > 16:
                code |= np.uint32(words[ROW * (at + 1) + x % ROW]) << np.uint32(16 - filled)
            code &= (np.uint32(1) << np.uint32(wide)) - np.uint32(1)
            before = np.uint16(
                before + np.uint16((code >> np.uint32(1)) ^ np.uint32(-np.int64(code & np.uint32(1))))
            )
            units[x] = before
        filled += wide
        at += filled // 16
        filled %= 16
    return at + (filled > 0) == there


def put_row(numbers: Any, row: int, words: Any, at: int, filled: int) -> int:
    """Writes a row into words that hold `filled` bits each, and into the next ones; how many bits it takes.

    Args:
        numbers: uint16, shape (m,).
        row: which eight of them.
        words: uint16, shape (k,), with a row more than it takes; above the filled bits they are 0.
        at: the row of words that is being filled.
        filled: how many bits of each [0, 15].
    """
    given = numbers[ROW * row : ROW * row + ROW].astype(np.uint32)
    moved = given << np.uint32(filled)
    words[ROW * at : ROW * at + ROW] |= (moved & np.uint32(0xFFFF)).astype(np.uint16)
    words[ROW * at + ROW : ROW * at + 2 * ROW] = moved >> np.uint32(16)
    return int(np.bitwise_or.reduce(given)).bit_length()


@overload(put_row)
def _put_row(numbers, row, words, at, filled):
    """The same as a handful of instructions, in compiled code.

    It is not inlined by Numba, which then drops what is written to an array that a tuple holds.
    """
    return lambda numbers, row, words, at, filled: _row_put(
        numbers, np.int64(row), words, np.int64(at), np.uint32(filled)
    )


@intrinsic
def _row_put(typing, numbers, row, words, at, filled):
    """`put_row` of vectors, which the compiler makes of no loop of eight; no index is checked."""
    signature = types.uint32(numbers, row, words, at, filled)
    narrow, wide = (ir.VectorType(ir.IntType(bits), ROW) for bits in (16, 32))

    def generate(context, build, signature, given):
        def place(which, index):
            array = context.make_array(signature.args[which])(context, build, given[which])
            begin = build.gep(array.data, [build.mul(index, ir.Constant(ir.IntType(64), ROW))])
            return build.bitcast(begin, narrow.as_pointer())

        def load(at):
            found = build.load(at)
            found.align = 2
            return found

        def store(value, at):
            build.store(value, at).align = 2

        row = load(place(0, given[1]))
        either = cgutils.get_or_insert_function(
            build.module, ir.FunctionType(ir.IntType(16), [narrow]), f"llvm.vector.reduce.or.v{ROW}i16"
        )
        greatest = build.zext(build.call(either, [row]), ir.IntType(32))
        bits = build.sub(ir.Constant(ir.IntType(32), 32), build.ctlz(greatest, ir.Constant(ir.IntType(1), 0)))
        none = ir.Constant(wide, ir.Undefined)
        first = build.insert_element(none, given[4], ir.Constant(ir.IntType(32), 0))
        filled = build.shuffle_vector(first, none, ir.Constant(wide, [0] * ROW))
        moved = build.shl(build.zext(row, wide), filled)
        here = place(2, given[3])
        store(build.or_(load(here), build.trunc(moved, narrow)), here)
        after = build.lshr(moved, ir.Constant(wide, [16] * ROW))
        store(build.trunc(after, narrow), build.gep(here, [ir.Constant(ir.IntType(64), 1)]))
        return bits

    return signature, generate
