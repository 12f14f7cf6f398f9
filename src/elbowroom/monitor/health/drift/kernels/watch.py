"""How far a camera or a link has moved, from offsets against where surfaces should lie: arrays and floats."""

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
        frames: how many are in it, at most `MEAN_OF`; 0: the spot is not in view.
        used: int64, indices of the spots that are within the gate, in their order; the rest is meaningless.
    """

    offset: np.ndarray
    sigma: np.ndarray
    frames: np.ndarray
    used: np.ndarray


class Gate(NamedTuple):
    """What is believed: the camera's range, and how far an offset may be off besides four sigmas; beyond that it is
    another thing's [m]."""

    least: float
    greatest: float
    off: float


class Counts(NamedTuple):
    """Numbers of spots within the gate, nearer, farther, without a return."""

    within: int
    nearer: int
    farther: int
    lost: int


class Fit(NamedTuple):
    """A small motion, and what speaks for it against standing still.

    Fields:
        motion: turn [rad], move [m], shape (6,).
        covariance: of it, shape (6, 6).
        speaks_for, against: log-likelihood of the motion over that of standing still, added over the spots that speak
            for it, and over those that speak against it.
        fits_still, fits_moved: shares of the spots that fit without and with it.
    """

    motion: np.ndarray
    covariance: np.ndarray
    speaks_for: float
    against: float
    fits_still: float
    fits_moved: float


@njit(cache=True, nogil=True)
def listen(image, spots, gate, memory):
    """Offsets along the normals of what an image shows at its spots, averaged over the last frames.

    An offset that is far from the mean begins a new one, so the mean follows at once what steps.

    Args:
        image: flattened, float32 [m]; what is not a number above zero and in range is no return.
        spots: where to look.
        gate: what is believed.
        memory: written: offsets away from the camera are above zero.

    Returns:
        `Counts`.
    """
    within, nearer, farther, lost = 0, 0, 0, 0
    for i in range(spots.pixel.size):
        depth = float(image[spots.pixel[i]])
        if not (depth > 0.0 and depth >= gate.least and depth <= gate.greatest and depth < np.inf):
            lost += 1
            memory.frames[i] = 0
            continue
        e = (depth - spots.depth[i]) * spots.scale[i]
        reach = gate.off + 4.0 * spots.sigma[i]
        if e < -reach:
            nearer += 1
            memory.frames[i] = 0
        elif e > reach:
            farther += 1
            memory.frames[i] = 0
        else:
            _remember(memory, i, e, spots.sigma[i])
            memory.used[within] = i
            within += 1
    return Counts(within, nearer, farther, lost)


@njit(nogil=True)
def _remember(memory, i, e, sigma):
    """Adds an offset to the mean of its spot, or begins a new mean with it."""
    count = memory.frames[i]
    if count == 0 or abs(e - memory.offset[i]) > STEP_M + STEP_SIGMAS * sigma:
        count = 1
        memory.offset[i] = e
    else:
        count = min(count + 1, MEAN_OF)
        memory.offset[i] += (e - memory.offset[i]) / count
    memory.frames[i] = count
    memory.sigma[i] = max(sigma / math.sqrt(count), LEAST_SIGMA_M)


@njit(cache=True, nogil=True)
def fit_motion(jacobian, offset, sigma, used, turn_sigma, move_sigma):
    """The small motion that explains most offsets, and what speaks for it against standing still.

    Geman-McClure loss whose width falls from step to step (graduated non-convexity: Yang, Antonante, Tzoumas, Carlone,
    RA-L 2020), begun at no motion, with a weak prior that keeps directions at zero which nothing shows.

    Args:
        jacobian: shape (n, 6), offset per turn [m/rad] and per move.
        offset, sigma: shape (n,) [m].
        used: indices of those that count.
        turn_sigma, move_sigma: of the prior [rad], [m].

    Returns:
        `Fit`.
    """
    motion, covariance = np.zeros(6), np.empty((6, 6))
    n = used.size
    # per spot: what it shows per turn and move, its offset, and the weight of the step; eight numbers for the processor
    rows = np.empty((n, 8))
    for j in range(n):
        for k in range(6):
            rows[j, k] = jacobian[used[j], k]
        rows[j, 6] = offset[used[j]]
    sums = np.empty((6, 8))
    rhs = np.empty(6)
    for step in range(STEPS):
        width = WIDEST_M * (NARROWEST_M / WIDEST_M) ** (step / (STEPS - 1))
        _weights(rows, sigma, used, motion, width)
        _normal_equations(rows, sums)
        for k in range(6):
            sums[k, k] += 1.0 / (turn_sigma if k < 3 else move_sigma) ** 2
            rhs[k] = sums[k, 6]
        _factorise(sums)
        _solve(sums, rhs, motion)
    for m in range(6):
        for k in range(6):
            rhs[k] = 1.0 if k == m else 0.0
        _solve(sums, rhs, covariance[m])
    speaks_for, against, fits_still, fits_moved = _weigh(rows, sigma, used, motion)
    return Fit(motion, covariance, speaks_for, against, fits_still, fits_moved)


@njit(nogil=True)
def _weights(rows, sigma, used, motion, width):
    """Weight of each spot by how well it fits the motion of the step before, into the last column."""
    m0, m1, m2, m3, m4, m5 = motion[0], motion[1], motion[2], motion[3], motion[4], motion[5]
    for j in range(rows.shape[0]):
        s = sigma[used[j]]
        r = rows[j, 6] - (rows[j, 0] * m0 + rows[j, 1] * m1 + rows[j, 2] * m2)
        r -= rows[j, 3] * m3 + rows[j, 4] * m4 + rows[j, 5] * m5
        ratio = r / (width + SIGMAS * s)
        w = 1.0 / (1.0 + ratio * ratio)
        rows[j, 7] = w * w / (s * s)


@njit(nogil=True)
def _normal_equations(rows, sums):
    """Weighted sums of the products of each two of six columns, and of these with the seventh."""
    s00 = s10 = s11 = s20 = s21 = s22 = s30 = s31 = s32 = s33 = 0.0
    s40 = s41 = s42 = s43 = s44 = s50 = s51 = s52 = s53 = s54 = s55 = 0.0
    r0 = r1 = r2 = r3 = r4 = r5 = 0.0
    # numbers by name stay in registers, which an array of them does not
    for j in range(rows.shape[0]):
        a, b, c = rows[j, 0], rows[j, 1], rows[j, 2]
        d, e, f = rows[j, 3], rows[j, 4], rows[j, 5]
        g, w = rows[j, 6], rows[j, 7]
        wa, wb, wc, wd, we, wf = w * a, w * b, w * c, w * d, w * e, w * f
        s00 += wa * a
        s10, s11 = s10 + wb * a, s11 + wb * b
        s20, s21, s22 = s20 + wc * a, s21 + wc * b, s22 + wc * c
        s30, s31, s32, s33 = s30 + wd * a, s31 + wd * b, s32 + wd * c, s33 + wd * d
        s40, s41, s42, s43, s44 = s40 + we * a, s41 + we * b, s42 + we * c, s43 + we * d, s44 + we * e
        s50, s51, s52, s53, s54 = s50 + wf * a, s51 + wf * b, s52 + wf * c, s53 + wf * d, s54 + wf * e
        s55 += wf * f
        r0, r1, r2, r3, r4, r5 = r0 + wa * g, r1 + wb * g, r2 + wc * g, r3 + wd * g, r4 + we * g, r5 + wf * g
    sums[0, 0] = s00
    sums[1, 0], sums[1, 1] = s10, s11
    sums[2, 0], sums[2, 1], sums[2, 2] = s20, s21, s22
    sums[3, 0], sums[3, 1], sums[3, 2], sums[3, 3] = s30, s31, s32, s33
    sums[4, 0], sums[4, 1], sums[4, 2], sums[4, 3], sums[4, 4] = s40, s41, s42, s43, s44
    sums[5, 0], sums[5, 1], sums[5, 2], sums[5, 3], sums[5, 4], sums[5, 5] = s50, s51, s52, s53, s54, s55
    sums[0, 6], sums[1, 6], sums[2, 6], sums[3, 6], sums[4, 6], sums[5, 6] = r0, r1, r2, r3, r4, r5


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
def _weigh(rows, sigma, used, motion):
    """What the spots say of the motion (`Fit`): of each a Gaussian with a share of strays."""
    speaks_for, against, fits_still, fits_moved = 0.0, 0.0, 0, 0
    for j in range(rows.shape[0]):
        s, e = sigma[used[j]], rows[j, 6]
        r = e
        for k in range(6):
            r -= rows[j, k] * motion[k]
        half = 0.5 / (s * s)
        gain = math.log(
            (STRAY + (1.0 - STRAY) * math.exp(-r * r * half))
            / (STRAY + (1.0 - STRAY) * math.exp(-e * e * half))
        )
        if gain > 0.0:
            speaks_for += gain
        else:
            against -= gain
        near = FITS_M + FITS_SIGMAS * s
        fits_still += abs(e) <= near
        fits_moved += abs(r) <= near
    count = max(used.size, 1)
    return speaks_for, against, fits_still / count, fits_moved / count


@njit(cache=True, nogil=True)
def judge_image(image, spots, gate, turn_sigma, move_sigma, memory):
    """`listen`, then `fit_motion` to the spots within the gate: their arguments, and what both return."""
    counts = listen(image, spots, gate, memory)
    used = memory.used[: counts.within]
    return counts, fit_motion(spots.jacobian, memory.offset, memory.sigma, used, turn_sigma, move_sigma)
