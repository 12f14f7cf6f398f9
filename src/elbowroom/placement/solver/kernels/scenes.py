"""Counting free voxels of scenes by planes of bits: rule three, free = three | (one & ~disputed)."""

import numpy as np
from numba import njit

M1, M2, M4 = np.uint64(0x5555555555555555), np.uint64(0x3333333333333333), np.uint64(0x0F0F0F0F0F0F0F0F)
GATHER = np.uint64(0x0101010101010101)


@njit(cache=True, nogil=True)
def ones(word):
    """Number of bits that are set."""
    word = word - ((word >> np.uint64(1)) & M1)
    word = (word & M2) + ((word >> np.uint64(2)) & M2)
    word = (word + (word >> np.uint64(4))) & M4
    return (word * GATHER) >> np.uint64(56)


@njit(cache=True, nogil=True)
def gather(through, disputed, chosen, state):
    """What chosen cameras know together: rows one, two, three, disputed of state, shape (4, words), written."""
    state[:] = np.uint64(0)
    for c in chosen:
        for w in range(state.shape[1]):
            seen = through[c, w]
            state[2, w] |= state[1, w] & seen
            state[1, w] |= state[0, w] & seen
            state[0, w] |= seen
            state[3, w] |= disputed[c, w]


@njit(cache=True, nogil=True)
def count_free(state, truly):
    """Number of truly free voxels that are declared free."""
    total = np.uint64(0)
    for w in range(truly.shape[0]):
        total += ones((state[2, w] | (state[0, w] & ~state[3, w])) & truly[w])
    return total


@njit(cache=True, nogil=True)
def count_with_each(through, disputed, state, truly, counts):
    """The same with one camera more, for each camera: counts, shape (cameras,), written."""
    for c in range(through.shape[0]):
        total = np.uint64(0)
        for w in range(truly.shape[0]):
            seen = through[c, w]
            three = state[2, w] | (state[1, w] & seen)
            one = state[0, w] | seen
            total += ones((three | (one & ~(state[3, w] | disputed[c, w]))) & truly[w])
        counts[c] = total
