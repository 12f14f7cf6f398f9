"""Eight pixels of a row at once, and eight rows of them: which a voxel has to be asked of.

One load and a few comparisons of eight texels each, eight rows without a branch; as a loop the compiler does them one
at a time. Numba emits them as vectors of LLVM, which any processor can do (`numba.extending.intrinsic`). Without the
compiler the functions as they stand here are run.
"""

from typing import Any

import numpy as np
from llvmlite import ir
from numba import types
from numba.extending import intrinsic, overload

EIGHT = 8
"""Pixels that are looked at in one step."""
_LANES = ir.VectorType(ir.IntType(32), EIGHT)


def short_of(texels: np.ndarray, at: int, limit: np.uint32) -> np.uint64:
    """Which of eight texels are free no farther than below a limit, pixel n in bit n.

    Args:
        texels: (n,) uint32, at least eight from `at` on.
        at: the first.
        limit: of their least depth [quanta, at most 65535].
    """
    least = np.asarray(texels[at : at + EIGHT]) >> np.uint32(16)
    return _bits(least < limit)


def shorts_of(texels: np.ndarray, at: int, stride: int, last: int, limit: np.uint32) -> np.uint64:
    """As `short_of`, of eight rows: pixel n of row r in bit 8 r + n. Rows past the last are as the last.

    Args:
        texels: (n,) uint32.
        at: the first of the first row.
        stride: from one row to the next.
        last: number of the last row, counted from 0.
        limit: as of `short_of`.
    """
    word = np.uint64(0)
    for row in range(EIGHT):
        word |= short_of(texels, at + min(row, last) * stride, limit) << np.uint64(EIGHT * row)
    return word


def tellings_of(
    texels: np.ndarray, at: int, stride: int, last: int, between: tuple[np.uint32, np.uint32]
) -> np.uint64:
    """Which of eight by eight texels say anything of what lies between two depths; bits as of `shorts_of`.

    These are neither wholly behind it nor wholly before it.

    Args:
        texels, at, stride, last: as of `shorts_of`.
        between: what is seen from the first on lies behind, what is seen up to the second lies before [quanta].
    """
    clear_from, hidden_to = between
    word = np.uint64(0)
    for row in range(EIGHT):
        first = at + min(row, last) * stride
        eight = np.asarray(texels[first : first + EIGHT])
        greatest = np.uint32(0xFFFF) - (eight & np.uint32(0xFFFF))
        tells = (eight >> np.uint32(16) < clear_from) & (greatest > hidden_to)
        word |= _bits(tells) << np.uint64(EIGHT * row)
    return word


def _bits(marks: Any) -> np.uint64:
    return np.uint64(sum(1 << n for n in range(EIGHT) if marks[n]))


def _eight_from(context: Any, builder: Any, array_type: Any, array: Any, at: Any) -> Any:
    """Eight texels, as one vector; they need not lie at a multiple of their size."""
    data = context.make_array(array_type)(context, builder, array).data
    eight = builder.load(builder.bitcast(builder.gep(data, [at]), _LANES.as_pointer()))
    eight.align = 4
    return eight


def _all(builder: Any, number: Any) -> Any:
    """A number in all lanes."""
    one = builder.insert_element(ir.Constant(_LANES, ir.Undefined), number, ir.Constant(ir.IntType(32), 0))
    return builder.shuffle_vector(one, ir.Constant(_LANES, ir.Undefined), ir.Constant(_LANES, [0] * EIGHT))


def _as_word(builder: Any, marks: Any) -> Any:
    return builder.zext(builder.bitcast(marks, ir.IntType(EIGHT)), ir.IntType(64))


def _upper(builder: Any, number: Any) -> Any:
    """A least depth as a texel has it."""
    return _all(builder, builder.shl(number, ir.Constant(ir.IntType(32), 16)))


@intrinsic
def _short_of_lanes(_: Any, texels: Any, at: Any, limit: Any) -> tuple[Any, Any]:
    def emit(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        eight = _eight_from(context, builder, signature.args[0], arguments[0], arguments[1])
        return _as_word(builder, builder.icmp_unsigned("<", eight, _upper(builder, arguments[2])))

    return types.uint64(texels, types.intp, types.uint32), emit


def _eight_rows(builder: Any, places: tuple[Any, Any, Any], marks_at: Any) -> Any:
    """Marks of eight rows as one word.

    Args:
        builder: of LLVM.
        places: of the first texel, from row to row, and number of the last row.
        marks_at: from the place of a row's first texel to its marks.
    """
    at, stride, last = places
    word = ir.Constant(ir.IntType(64), 0)
    for number in range(EIGHT):
        row = ir.Constant(ir.IntType(64), number)
        row = builder.select(builder.icmp_signed("<", row, last), row, last)
        marks = _as_word(builder, marks_at(builder.add(at, builder.mul(row, stride))))
        word = builder.or_(word, builder.shl(marks, ir.Constant(ir.IntType(64), EIGHT * number)))
    return word


@intrinsic
def _short_of_rows(_: Any, texels: Any, at: Any, stride: Any, last: Any, limit: Any) -> tuple[Any, Any]:
    def emit(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        array, *places, limit = arguments
        most = _upper(builder, limit)
        return _eight_rows(
            builder,
            tuple(places),
            lambda at: builder.icmp_unsigned(
                "<", _eight_from(context, builder, signature.args[0], array, at), most
            ),
        )

    return types.uint64(texels, types.intp, types.intp, types.intp, types.uint32), emit


@intrinsic
def _telling_rows(_: Any, texels: Any, at: Any, stride: Any, last: Any, between: Any) -> tuple[Any, Any]:
    def emit(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        array, *places, between = arguments
        lower = ir.Constant(ir.IntType(32), 0xFFFF)
        behind = _upper(builder, builder.extract_value(between, 0))
        before = _all(builder, builder.sub(lower, builder.extract_value(between, 1)))

        def marks_at(at: Any) -> Any:
            eight = _eight_from(context, builder, signature.args[0], array, at)
            not_behind = builder.icmp_unsigned("<", eight, behind)
            not_before = builder.icmp_unsigned("<", builder.and_(eight, _all(builder, lower)), before)
            return builder.and_(not_behind, not_before)

        return _eight_rows(builder, tuple(places), marks_at)

    two = types.UniTuple(types.uint32, 2)
    return types.uint64(texels, types.intp, types.intp, types.intp, two), emit


@overload(short_of, inline="always")
def _short_of(texels, at, limit):
    return lambda texels, at, limit: _short_of_lanes(texels, at, limit)


@overload(shorts_of, inline="always")
def _shorts_of(texels, at, stride, last, limit):
    return lambda texels, at, stride, last, limit: _short_of_rows(texels, at, stride, last, limit)


@overload(tellings_of, inline="always")
def _tellings_of(texels, at, stride, last, between):
    return lambda texels, at, stride, last, between: _telling_rows(texels, at, stride, last, between)
