"""Whether what the cameras see in common bears their new poses out, and what it says nothing of."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.stats import chi2

from elbowroom.calibrate.refinement.kernels.overlap import AGREES, COMPARED
from elbowroom.calibrate.refinement.overlap import PairSums
from elbowroom.calibrate.refinement.step import Before
from elbowroom.calibrate.result.pose_words import deviations, weakest_words
from elbowroom.errors import CalibrationError
from elbowroom.geometry.twist import between, sizes

ALLOWED = float(chi2.ppf(0.99, 6))
"""Squared Mahalanobis distance up to which a camera may move: 99 % of the cameras with this covariance are nearer."""
FEWEST_COMMON = 300
"""Points that two cameras must have in common to count as a pair, over all moments."""
LEAST_SHARE = 0.2
"""Share of a camera's common points that must agree in the end."""
SURE_M, SURE_RAD = 0.001, float(np.radians(0.02))
"""One sigma below which it does not matter that the images say nothing more [m, rad]."""
FREE = 0.9
"""A direction in which the covariance is still this share of what it was (one sigma) was not touched by the images."""

Array = NDArray[Any]


def check_refined(
    sums: Sequence[PairSums], poses: Mapping[str, Array], before: Before, converged: bool
) -> None:
    """Refuses what the images do not bear out; names the camera.

    Args:
        sums: of all pairs at the end.
        poses: world_from_camera by name, refined.
        before: what was known.
        converged: whether the cameras came to rest.

    Raises:
        CalibrationError: no common view, farther than allowed, surfaces that do not fit, or no rest.
    """
    common = [pair for pair in sums if pair.compared >= FEWEST_COMMON]
    _check_common(list(poses), common)
    for name in before.free:
        square = before.square_moved(name, poses[name])
        if square > ALLOWED:
            far_m, far_rad = sizes(between(before.poses[name], poses[name]))
            raise CalibrationError(
                f"camera {name}: the common scene wants it {far_m * 1e3:.0f} mm and {np.degrees(far_rad):.2f} degrees "
                f"from where it was, {np.sqrt(square):.1f} of its sigmas; at most {np.sqrt(ALLOWED):.1f} are allowed "
                "(99 %): it was knocked, or its covariance is too small; calibrate it again"
            )
    for name in poses:
        mine = [pair for pair in common if name in (pair.one, pair.other)]
        agreeing, compared = (int(sum(pair.counts[c] for pair in mine)) for c in (AGREES, COMPARED))
        if agreeing < LEAST_SHARE * compared:
            raise CalibrationError(
                f"camera {name}: {100 * agreeing / compared:.0f} % of what it shares with others fits together, at "
                f"least {100 * LEAST_SHARE:.0f} % must; its pose is too far off for this: calibrate it by a board or "
                "the machine"
            )
    if not converged:
        raise CalibrationError(
            "refine: the cameras do not come to rest; capture a room with more in it, or calibrate by a board or the "
            "machine"
        )


def _check_common(names: list[str], common: Sequence[PairSums]) -> None:
    """Refuses cameras that nothing ties to the others."""
    for name in names:
        if not any(name in (pair.one, pair.other) for pair in common):
            raise CalibrationError(
                f"camera {name}: shares no view with any other camera; it cannot be refined on the common scene: "
                "calibrate it by a board or the machine, or leave it out"
            )
    apart = _parts(names, common)
    if len(apart) > 1:
        raise CalibrationError(
            f"cameras {', '.join(sorted(apart[1]))}: share no view with {', '.join(sorted(apart[0]))}; refine them "
            "apart, or calibrate them together by a board or the machine"
        )


def _parts(names: list[str], common: Sequence[PairSums]) -> list[set[str]]:
    """The cameras by what they share a view with, directly or through others."""
    parts = [{name} for name in names]
    for pair in common:
        one = next(part for part in parts if pair.one in part)
        other = next(part for part in parts if pair.other in part)
        if one is not other:
            parts.remove(other)
            one |= other
    return parts


def untouched_notes(name: str, covariance: Array, before: Array) -> tuple[str, ...]:
    """What the common scene says nothing of, a sentence each.

    Args:
        name: of the camera.
        covariance, before: of its twist now and before, shape (6, 6).
    """
    whiten = np.linalg.inv(np.linalg.cholesky(before))
    left, directions = np.linalg.eigh(whiten @ covariance @ whiten.T)
    untouched = np.sqrt(left) > FREE
    if not untouched.any():
        return ()
    if untouched.all():
        return (f"{name}: the common scene says nothing of its pose that was not known before",)
    # back from units of sigma to metres and radians
    freed = np.linalg.cholesky(before) @ directions[:, untouched]
    place_m, turn = deviations(freed @ freed.T)
    if place_m < SURE_M and turn < SURE_RAD:
        return ()
    return (
        f"{name}: the common scene says nothing of {weakest_words(freed @ freed.T)}, which is known to "
        f"{place_m * 1e3:.1f} mm and {np.degrees(turn):.2f} degrees, as before; put furniture where it and others look",
    )
