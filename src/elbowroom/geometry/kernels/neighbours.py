"""Which pixels are about others."""

from numba import njit


@njit(inline="always")
def is_about(pixel, one, other):
    """Whether a pixel is one of those about two that lie side by side, or are the same; each (row, column)."""
    near_one = abs(pixel[0] - one[0]) <= 1 and abs(pixel[1] - one[1]) <= 1
    near_other = abs(pixel[0] - other[0]) <= 1 and abs(pixel[1] - other[1]) <= 1
    own = (pixel[0] == one[0] and pixel[1] == one[1]) or (pixel[0] == other[0] and pixel[1] == other[1])
    return (near_one or near_other) and not own
