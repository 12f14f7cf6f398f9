"""Eight pixels of a row at once: which of them a voxel has to be asked of.

One load and a few comparisons of eight texels each; as a loop the compiler does them one at a time. Numba emits them as
vectors of LLVM, which any processor can do (`numba.extending.intrinsic`). Without the compiler the functions as they
stand here are run.
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


def telling(texels: np.ndarray, at: int, clear_from: np.uint32, hidden_to: np.uint32) -> np.uint64:
    """Which of eight texels say anything of what lies between two depths: not wholly behind it, nor wholly before it.

    Args:
        texels: (n,) uint32, at least eight from `at` on.
        at: the first.
        clear_from: what is seen from there on lies behind [quanta].
        hidden_to: what is seen up to there lies before [quanta].
    """
    eight = np.asarray(texels[at : at + EIGHT])
    greatest = np.uint32(0xFFFF) - (eight & np.uint32(0xFFFF))
    return _bits((eight >> np.uint32(16) < clear_from) & (greatest > hidden_to))


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


@intrinsic
def _telling_lanes(_: Any, texels: Any, at: Any, clear_from: Any, hidden_to: Any) -> tuple[Any, Any]:
    def emit(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        eight = _eight_from(context, builder, signature.args[0], arguments[0], arguments[1])
        lower = ir.Constant(ir.IntType(32), 0xFFFF)
        before = builder.and_(eight, _all(builder, lower))
        not_behind = builder.icmp_unsigned("<", eight, _upper(builder, arguments[2]))
        not_before = builder.icmp_unsigned("<", before, _all(builder, builder.sub(lower, arguments[3])))
        return _as_word(builder, builder.and_(not_behind, not_before))

    return types.uint64(texels, types.intp, types.uint32, types.uint32), emit


@overload(short_of, inline="always")
def _short_of(texels, at, limit):
    return lambda texels, at, limit: _short_of_lanes(texels, at, limit)


@overload(telling, inline="always")
def _telling(texels, at, clear_from, hidden_to):
    return lambda texels, at, clear_from, hidden_to: _telling_lanes(texels, at, clear_from, hidden_to)
