"""A point or a direction through a rigid transform, number by number.

Sums run from left to right, so that the same point comes out with the same bits in every kernel.
"""

from numba import njit


@njit(inline="always")
def along(b_from_a, axis, x, y, z):
    """One coordinate of a point of frame a in frame b; `b_from_a`: (3 or 4, 4)."""
    return b_from_a[axis, 0] * x + b_from_a[axis, 1] * y + b_from_a[axis, 2] * z + b_from_a[axis, 3]


@njit(inline="always")
def moved(b_from_a, x, y, z):
    """A point of frame a in frame b; `b_from_a`: (3 or 4, 4)."""
    return (
        b_from_a[0, 0] * x + b_from_a[0, 1] * y + b_from_a[0, 2] * z + b_from_a[0, 3],
        b_from_a[1, 0] * x + b_from_a[1, 1] * y + b_from_a[1, 2] * z + b_from_a[1, 3],
        b_from_a[2, 0] * x + b_from_a[2, 1] * y + b_from_a[2, 2] * z + b_from_a[2, 3],
    )


@njit(inline="always")
def turned(b_from_a, x, y, z):
    """A direction of frame a in frame b; `b_from_a`: (3 or 4, 3 or 4)."""
    return (
        b_from_a[0, 0] * x + b_from_a[0, 1] * y + b_from_a[0, 2] * z,
        b_from_a[1, 0] * x + b_from_a[1, 1] * y + b_from_a[1, 2] * z,
        b_from_a[2, 0] * x + b_from_a[2, 1] * y + b_from_a[2, 2] * z,
    )


@njit(inline="always")
def turned_back(b_from_a, x, y, z):
    """A direction of frame b in frame a; `b_from_a`: (3 or 4, 3 or 4)."""
    return (
        b_from_a[0, 0] * x + b_from_a[1, 0] * y + b_from_a[2, 0] * z,
        b_from_a[0, 1] * x + b_from_a[1, 1] * y + b_from_a[2, 1] * z,
        b_from_a[0, 2] * x + b_from_a[1, 2] * y + b_from_a[2, 2] * z,
    )
