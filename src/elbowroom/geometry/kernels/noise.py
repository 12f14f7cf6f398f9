"""How far a measured depth scatters (`geometry.noise`), and how far it is trusted (`geometry.margin`).

All of it in the precision of what comes in: float32 numbers give float32, as loops over many pixels at once need.
"""

from typing import NamedTuple

import numpy as np
from numba import njit


class DepthMargin(NamedTuple):
    """By how much depth is not trusted: constant, by depth, by its square, by the square of depth beyond offset."""

    constant: float
    linear: float
    quadratic: float
    beyond: float
    offset: float


@njit(inline="always")
def sigma(noise, depth):
    """Standard deviation at a depth [m]; `noise`: any record with constant, linear, quadratic and offset."""
    # the same bits as the greater of (depth - offset) and 0, but without a 0 of one precision
    beyond = max(depth, noise.offset) - noise.offset
    return noise.constant + noise.linear * depth + noise.quadratic * beyond * beyond


@njit(inline="always")
def margin_at(margin, depth):
    """How far a depth is not trusted [m]; `margin`: a `DepthMargin`."""
    beyond = max(depth, margin.offset) - margin.offset
    return (
        margin.constant + depth * (margin.linear + depth * margin.quadratic) + margin.beyond * beyond * beyond
    )


@njit(inline="always")
def in_float32(margin):
    """The same margin for float32 depths, as numbers of its own: a loop then need not read them again."""
    return DepthMargin(
        np.float32(margin.constant),
        np.float32(margin.linear),
        np.float32(margin.quadratic),
        np.float32(margin.beyond),
        np.float32(margin.offset),
    )
