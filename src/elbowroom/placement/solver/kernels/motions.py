"""What motions sweep, one by one, in planes of bits: how many voxels are not found, and what that is worth."""

from numba import njit

from elbowroom.placement.solver.kernels.scenes import ones


@njit(cache=True, nogil=True)
def worth(missing, few):
    """Of a motion of which so many voxels are not found: 1 of none, a half of `few`."""
    return few / (few + missing)


@njit(cache=True, nogil=True)
def value_of(state, truly, start, weight, few):
    """Worth of all motions together; the words of motion m are start[m] to start[m + 1]."""
    total = 0.0
    for m in range(weight.shape[0]):
        missing = 0
        for w in range(start[m], start[m + 1]):
            found = state[2, w] | (state[0, w] & ~state[3, w])
            missing += int(ones(truly[w] & ~found))
        total += weight[m] * worth(float(missing), few)
    return total


@njit(cache=True, nogil=True)
def values_with_each(through, disputed, state, truly, start, weight, few, values):
    """The same with one camera more, for each camera: values, shape (cameras,), written."""
    for c in range(through.shape[0]):
        total = 0.0
        for m in range(weight.shape[0]):
            missing = 0
            for w in range(start[m], start[m + 1]):
                seen = through[c, w]
                three = state[2, w] | (state[1, w] & seen)
                one = state[0, w] | seen
                found = three | (one & ~(state[3, w] | disputed[c, w]))
                missing += int(ones(truly[w] & ~found))
            total += weight[m] * worth(float(missing), few)
        values[c] = total
