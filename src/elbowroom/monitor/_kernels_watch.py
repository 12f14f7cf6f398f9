"""How far a camera or a link has moved, from offsets of what it shows against where it should lie: arrays and floats."""

import math
from typing import NamedTuple

import numpy as np
from numba import njit

STEPS = 5
WIDEST_M = 0.10
NARROWEST_M = 0.008
SIGMAS = 2.5
"""Width of the robust loss: falls from the widest to the narrowest over the steps, and 2.5 sigmas beside that."""
STRAY = 0.02
"""Share of the returns that come from anything at all: bounds what one pixel can say to ln(1 / 0.02) = 3.9."""
FITS_SIGMAS = 3.0
FITS_M = 0.008
"""A return fits if it lies so near to where it should."""
FIT, NEARER, FARTHER, LOST = 0, 1, 2, 3
MEAN_OF = 8
"""Offsets are averaged over so many frames."""
STEP_M, STEP_SIGMAS = 0.02, 4.0
"""Unless they step by more than this."""
LEAST_SIGMA_M = 0.002
"""Nothing is trusted to less than this, along the surface's normal: steady errors of real sensors are no less [m]."""


class Spots(NamedTuple):
    """Places of one image whose depth is known, n of them, each on a surface that is flat about it.

    Fields:
        pixel: place in the flattened image, int64.
        depth: where the surface lies along the pixel's ray [m, the camera's kind].
        scale: metres along the surface's normal per metre along the ray.
        sigma: of a return, along the normal [m].
        jacobian: shape (n, 6), offset along the normal per small turn [rad] and move [m] of the camera.
    """

    pixel: np.ndarray
    depth: np.ndarray
    scale: np.ndarray
    sigma: np.ndarray
    jacobian: np.ndarray


class Memory(NamedTuple):
    """What the frames before have shown at the spots.

    Fields:
        offset: mean offset along the normal, shape (n,) [m].
        sigma: of that mean [m].
        count: how many frames are in it, at most `MEAN_OF`; 0: the spot is not in view.
        used: int64, indices of the spots that are within the gate, in their order; the rest is meaningless.
    """

    offset: np.ndarray
    sigma: np.ndarray
    count: np.ndarray
    used: np.ndarray


@njit(cache=True, nogil=True)
def listen(image, spots, least, greatest, gate, memory, counted):
    """Offsets along the normals of what an image shows at its spots, averaged over the last frames.

    An offset that is far from the mean begins a new one, so the mean follows at once what steps.

    Args:
        image: flattened, float32 [m]; what is not a number above zero and in range is no return.
        spots: `Spots`.
        least, greatest: range of the camera [m].
        gate: offsets beyond this and four sigmas are another thing's [m].
        memory: `Memory`, written: offsets away from the camera are above zero.
        counted: shape (4,) int64, written: numbers of spots within the gate, nearer, farther, without a return.
    """
    counted[:] = 0
    for i in range(spots.pixel.size):
        depth = float(image[spots.pixel[i]])
        if not (depth > 0.0 and depth >= least and depth <= greatest and depth < np.inf):
            counted[LOST] += 1
            memory.count[i] = 0
            continue
        e = (depth - spots.depth[i]) * spots.scale[i]
        sigma = spots.sigma[i]
        reach = gate + 4.0 * sigma
        if e < -reach or e > reach:
            counted[NEARER if e < 0.0 else FARTHER] += 1
            memory.count[i] = 0
            continue
        count = memory.count[i]
        if count == 0 or abs(e - memory.offset[i]) > STEP_M + STEP_SIGMAS * sigma:
            count = 1
            memory.offset[i] = e
        else:
            count = min(count + 1, MEAN_OF)
            memory.offset[i] += (e - memory.offset[i]) / count
        memory.count[i] = count
        memory.sigma[i] = max(sigma / math.sqrt(count), LEAST_SIGMA_M)
        memory.used[counted[FIT]] = i
        counted[FIT] += 1


@njit(cache=True, nogil=True)
def fit_motion(jacobian, offset, sigma, used, turn_sigma, move_sigma, motion, covariance, said):
    """The small motion that explains most offsets, and what speaks for it against standing still.

    Geman-McClure loss whose width falls from step to step (graduated non-convexity: Yang, Antonante, Tzoumas, Carlone,
    RA-L 2020), begun at no motion, with a weak prior that keeps directions at zero which nothing shows.

    Args:
        jacobian: shape (n, 6), offset per turn [m/rad] and per move.
        offset, sigma: shape (n,) [m].
        used: indices of those that count.
        turn_sigma, move_sigma: of the prior [rad], [m].
        motion: shape (6,), written: turn [rad], move [m].
        covariance: shape (6, 6), written.
        said: shape (4,), written: log-likelihood of the motion over that of standing still, added over spots that
            speak for it, and over those that speak against it; shares of spots that fit without and with it.
    """
    information = np.empty((6, 6))
    rhs = np.empty(6)
    for k in range(6):
        motion[k] = 0.0
    for step in range(STEPS):
        width = WIDEST_M * (NARROWEST_M / WIDEST_M) ** (step / (STEPS - 1))
        for k in range(6):
            rhs[k] = 0.0
            for m in range(6):
                information[k, m] = 0.0
        for n in range(used.size):
            i = used[n]
            e = offset[i]
            r = e
            for k in range(6):
                r -= jacobian[i, k] * motion[k]
            c = width + SIGMAS * sigma[i]
            w = 1.0 / (1.0 + (r / c) ** 2)
            w = w * w / (sigma[i] * sigma[i])
            for k in range(6):
                weighted = w * jacobian[i, k]
                rhs[k] += weighted * e
                for m in range(k + 1):
                    information[k, m] += weighted * jacobian[i, m]
        for k in range(6):
            information[k, k] += 1.0 / (turn_sigma if k < 3 else move_sigma) ** 2
        _factorise(information)
        _solve(information, rhs, motion)
    for m in range(6):
        for k in range(6):
            rhs[k] = 1.0 if k == m else 0.0
        _solve(information, rhs, covariance[m])
    _weigh(jacobian, offset, sigma, used, motion, said)


@njit(nogil=True)
def _factorise(matrix):
    """Cholesky factor in the lower triangle, in place."""
    for k in range(6):
        for m in range(k + 1):
            total = matrix[k, m]
            for j in range(m):
                total -= matrix[k, j] * matrix[m, j]
            matrix[k, m] = math.sqrt(total) if k == m else total / matrix[m, m]


@njit(nogil=True)
def _solve(factor, rhs, solution):
    """Solves with a Cholesky factor."""
    for k in range(6):
        total = rhs[k]
        for j in range(k):
            total -= factor[k, j] * solution[j]
        solution[k] = total / factor[k, k]
    for k in range(5, -1, -1):
        total = solution[k]
        for j in range(k + 1, 6):
            total -= factor[j, k] * solution[j]
        solution[k] = total / factor[k, k]


@njit(nogil=True)
def _weigh(jacobian, offset, sigma, used, motion, said):
    """What each spot says of the motion against standing still: Gaussian with a share of strays."""
    speaks_for, against, fits_still, fits_moved = 0.0, 0.0, 0, 0
    for n in range(used.size):
        i = used[n]
        e = offset[i]
        r = e
        for k in range(6):
            r -= jacobian[i, k] * motion[k]
        half = 0.5 / (sigma[i] * sigma[i])
        gain = math.log(STRAY + (1.0 - STRAY) * math.exp(-r * r * half))
        gain -= math.log(STRAY + (1.0 - STRAY) * math.exp(-e * e * half))
        if gain > 0.0:
            speaks_for += gain
        else:
            against -= gain
        near = FITS_M + FITS_SIGMAS * sigma[i]
        fits_still += abs(e) <= near
        fits_moved += abs(r) <= near
    said[0], said[1] = speaks_for, against
    said[2] = fits_still / max(used.size, 1)
    said[3] = fits_moved / max(used.size, 1)


@njit(cache=True, nogil=True)
def judge_image(
    image, spots, least, greatest, gate, turn_sigma, move_sigma, memory, counted, motion, covariance, said
):
    """`listen`, then `fit_motion` to the spots within the gate; their arguments."""
    listen(image, spots, least, greatest, gate, memory, counted)
    used = memory.used[: counted[FIT]]
    fit_motion(
        spots.jacobian, memory.offset, memory.sigma, used, turn_sigma, move_sigma, motion, covariance, said
    )
