"""One step of the least squares over all pairs of cameras, with what was known of each camera before."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from elbowroom.calibrate.refinement.overlap import PairSums
from elbowroom.geometry import invert_rigid
from elbowroom.geometry.twist import adjoint, between, moved

Array = NDArray[Any]
NOISIER = 2.0
"""Noise of neighbouring pixels goes together in real sensors: slopes scatter more than single pixels say."""


@dataclass(frozen=True, slots=True, eq=False)
class Before:
    """What was known of the cameras before.

    Args:
        poses: world_from_camera of all of them, by name.
        covariances: of the twists of those that may move, shape (6, 6).
    """

    poses: Mapping[str, Array]
    covariances: Mapping[str, Array]

    @property
    def free(self) -> list[str]:
        """Names of the cameras that may move."""
        return list(self.covariances)

    def square_moved(self, name: str, world_from_camera: Array) -> float:
        """Squared Mahalanobis distance of a pose from what was known of it."""
        twist = between(self.poses[name], world_from_camera)
        return float(twist @ np.linalg.solve(self.covariances[name], twist))


def step(
    sums: Sequence[PairSums], poses: Mapping[str, Array], before: Before, share: float = 1.0
) -> tuple[dict[str, Array], float]:
    """One step of Gauss and Newton, or a share of it: new poses, and the whole step's length in sigmas.

    Args:
        sums: of all pairs of cameras.
        poses: world_from_camera by name, shape (4, 4).
        before: what is known of the poses beforehand.
        share: how much of the step to go, up to 1.
    """
    normal, gradient = equations(sums, poses, before)
    twist = -np.linalg.solve(normal, gradient)
    new = dict(poses)
    for row, name in enumerate(before.free):
        new[name] = moved(poses[name], share * twist[6 * row : 6 * row + 6])
    return new, float(np.sqrt(twist @ normal @ twist))


def equations(
    sums: Sequence[PairSums], poses: Mapping[str, Array], before: Before, *, without_noise: bool = False
) -> tuple[Array, Array]:
    """Normal equations of the twists of all cameras that may move, six each, and their right-hand side.

    A point of the one camera sees, in the other's frame, the one's twist brought there minus the other's own.

    Args:
        sums: of all pairs.
        poses: world_from_camera by name, at which they were taken.
        before: what was known.
        without_noise: leave out what noise in the slopes of planes only seems to say, as a covariance should.
    """
    free = before.free
    normal, gradient = np.zeros((6 * len(free),) * 2), np.zeros(6 * len(free))
    at = {name: slice(6 * row, 6 * row + 6) for row, name in enumerate(free)}
    shared = times_used(sums)
    for pair in sums:
        inflation = shared[pair.one, pair.other] * inflation_of(pair)
        own = said_by(pair) if without_noise else pair.normal.sum(axis=0)
        slope = pair.gradient.sum(axis=0)
        by = {
            pair.one: adjoint(invert_rigid(poses[pair.other]) @ poses[pair.one]),
            pair.other: -np.eye(6),
        }
        for name in by.keys() & at.keys():
            gradient[at[name]] += by[name].T @ slope / inflation
            for other in by.keys() & at.keys():
                normal[at[name], at[other]] += by[name].T @ own @ by[other] / inflation
    for name in free:
        weight = np.linalg.inv(before.covariances[name])
        normal[at[name], at[name]] += weight
        gradient[at[name]] += weight @ between(before.poses[name], poses[name])
    return normal, gradient


def times_used(sums: Sequence[PairSums]) -> dict[tuple[str, str], float]:
    """By pair: in how many comparisons its two cameras' images take part, on average.

    The same noise is in all of them: seven partners, both ways, are not fourteen times the knowledge.
    """
    uses: dict[str, int] = {}
    for pair in sums:
        if pair.compared:
            for name in (pair.one, pair.other):
                uses[name] = uses.get(name, 0) + 1
    return {
        (pair.one, pair.other): max(1.0, (uses.get(pair.one, 0) + uses.get(pair.other, 0)) / 2)
        for pair in sums
    }


def said_by(pair: PairSums) -> Array:
    """What a pair's surfaces say without what their noise seems to say, shape (6, 6); nowhere below nothing."""
    whole = pair.normal.sum(axis=0)
    scale = np.sqrt(np.maximum(np.diag(whole), 1e-30))
    values, vectors = np.linalg.eigh((whole - NOISIER * pair.by_noise) / np.outer(scale, scale))
    return np.asarray((vectors * np.maximum(values, 0.0)) @ vectors.T * np.outer(scale, scale))


def inflation_of(pair: PairSums) -> float:
    """By how much the covariance of a pair must grow for the parts of the image to agree with each other, at least 1.

    What a lens, a depth scale or a warped reading adds is the same in all points of a part of the image. So the sums of
    the parts scatter more than single points' noise would make them, by this factor.
    """
    whole = pair.normal.sum(axis=0)
    used = pair.normal.any(axis=(1, 2))
    count = int(used.sum())
    if count < 3:
        return 1.0
    step = np.linalg.pinv(whole, rcond=1e-9) @ pair.gradient.sum(axis=0)
    left = pair.gradient[used] - pair.normal[used] @ step
    scatter = np.einsum("ti,tj->ij", left, left) * count / (count - 1)
    return max(1.0, float(np.trace(np.linalg.pinv(whole, rcond=1e-9) @ scatter)) / 6)
