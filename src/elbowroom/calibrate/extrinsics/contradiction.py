"""Measured places that contradict what the cameras see.

Each pose of the board, and each point in images, is judged by all others: let its measured places be unknown, and see
by how much the sum of squares falls and where the places come to lie (mean-shift outlier model; Cook and Weisberg:
Residuals and Influence in Regression, 1982, ch. 2). With D the derivatives of its residuals e by these places, and
M = I - J C J^T what is left of a residual after the fit (J rows, C the covariance of the unknowns),

    shift = -(D^T M D)^+ D^T e,    fall = e^T D (D^T M D)^+ D^T e
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import block_diag
from scipy.stats import chi2

from elbowroom.calibrate.extrinsics.adjustment import Solution
from elbowroom.calibrate.extrinsics.anchor import BoardCorner, KnownPoint
from elbowroom.calibrate.extrinsics.known_points import KnownPoints, PointRows
from elbowroom.errors import CalibrationError

Array = NDArray[np.float64]
FALSE_ALARM = 1e-6
"""Share of places measured as well as is said that are refused all the same."""
AS_SUSPECT = 0.8
"""Of the largest fall over what is allowed: what reaches so much may as well be the one that is wrong."""
LEAST_SHARE = 1e-6
"""Shifts of which less than this is left after the fit are ones that nothing else tells of."""


@dataclass(frozen=True, slots=True)
class _Judged:
    """How far places that were measured together lie from where all else puts them.

    Args:
        words: what they are of.
        fall: of the sum of squares, over what is allowed by chance.
        name, off_m: of the point that lies farthest off [m].
    """

    words: str
    fall: float
    name: str
    off_m: float


def require_points_agree(known: KnownPoints, solution: Solution) -> None:
    """Measured places go together with each other and with what the cameras see.

    Args:
        known: the points.
        solution: of the least squares with these points.

    Raises:
        CalibrationError: a pose of the board, or a point, that was measured wrong; of which it is one, if that is open.
    """
    together: dict[str, list[tuple[KnownPoint, PointRows]]] = {}
    rows = known.rows(solution.state, solution.index)
    for point, own in zip(known.anchor.points, rows, strict=True):
        words = f"pose {point.pose}" if isinstance(point, BoardCorner) else f"point {point.name}"
        together.setdefault(words, []).append((point, own))
    judged = [_judged(words, members, solution.covariance) for words, members in together.items()]
    worst = max(judged, key=lambda one: one.fall)
    if worst.fall <= 1:
        return
    others = [one for one in judged if one is not worst and one.fall > max(1.0, AS_SUSPECT * worst.fall)]
    raise CalibrationError(
        f"{worst.words}: the measured place of {worst.name} lies {worst.off_m * 1e3:.0f} mm from where the cameras and "
        f"all other points put it, more than sigma_m of {known.anchor.sigma_m * 1e3:g} mm allows"
        + (f" (or it is {' or '.join(one.words for one in others)} that is wrong)" if others else "")
        + "; measure it again, or take it out of calibration.world"
    )


def _judged(words: str, members: list[tuple[KnownPoint, PointRows]], covariance: Array) -> _Judged:
    rows = np.zeros((sum(len(own.residual) for _, own in members), len(covariance)))
    at = 0
    for _, own in members:
        rows[at : at + len(own.residual), own.among] = own.rows
        at += len(own.residual)
    residual = np.concatenate([own.residual for _, own in members])
    by_shift = block_diag(*(own.by_shift for _, own in members))
    left = by_shift.T @ (by_shift - rows @ (covariance @ (rows.T @ by_shift)))
    values, vectors = np.linalg.eigh((left + left.T) / 2)
    told = values > LEAST_SHARE * np.linalg.norm(by_shift, 2) ** 2
    pull = vectors[:, told].T @ (by_shift.T @ residual)
    shifts = np.linalg.norm((vectors[:, told] @ (pull / values[told])).reshape(-1, 3), axis=1)
    allowed = float(chi2.ppf(1 - FALSE_ALARM, max(int(told.sum()), 1)))
    farthest = int(shifts.argmax())
    return _Judged(
        words,
        float(pull @ (pull / values[told])) / allowed,
        members[farthest][0].name,
        float(shifts[farthest]),
    )
