"""Cameras refined on what they see in common: walls, floor, furniture; never farther than their covariance allows."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.stats import chi2

from elbowroom.calibrate._kernels_overlap import Overlap
from elbowroom.calibrate.agreement import Agreement, agreement
from elbowroom.calibrate.calibrated_camera import CalibratedCamera
from elbowroom.calibrate.overlap import PairSums, Surfaces, pair_sums, pairs_of, surfaces
from elbowroom.calibrate.planar_images import planar_images
from elbowroom.calibrate.pose_words import deviations, weakest_words
from elbowroom.calibrate.twist import adjoint, between, moved, sizes
from elbowroom.errors import CalibrationError
from elbowroom.geometry import DepthCamera, invert_rigid
from elbowroom.sensing import DepthFrame
from elbowroom.site import RecordedMoment

ALLOWED = float(chi2.ppf(0.99, 6))
"""Squared Mahalanobis distance up to which a camera may move: 99 % of the cameras with this covariance are nearer."""
GATES_M = (0.40,) * 6 + (0.25,) * 6 + (0.15,) * 6 + (0.10,) * 6 + (0.05,) * 8
"""How far apart surfaces may be and still be the same, round by round [m]; then by sigmas alone."""
FINE_ROUNDS = 30
RULE = Overlap(gate_m=0.0, reach=4.7, floor_m=0.002, least_cosine=0.8, tiles=4)
STILL = 0.05
"""A step of fewer sigmas is the last one."""
FEWEST_COMMON = 300
"""Points that two cameras must have in common to count as a pair, over all moments."""
MOST_MOMENTS = 12
LEAST_SHARE = 0.2
"""Share of a camera's common points that must agree in the end."""
FREE = 0.9
"""A direction in which the covariance is still this share of what it was (one sigma) was not touched by the images."""

Array = NDArray[np.float64]
Progress = Callable[[str], None]


@dataclass(frozen=True, slots=True, eq=False)
class PairAgreement:
    """How well two cameras fit together, before and after.

    Args:
        one, other: names: points of the one in the image of the other.
        before, after: over all moments that were used.
    """

    one: str
    other: str
    before: Agreement
    after: Agreement


@dataclass(frozen=True, slots=True, eq=False)
class Refinement:
    """What the common scene says.

    Args:
        cameras: in the order given, those that hold left out.
        pairs: those that have enough in common.
        moments: how many were used.
    """

    cameras: tuple[CalibratedCamera, ...]
    pairs: tuple[PairAgreement, ...]
    moments: int


def refine(
    cameras: Sequence[DepthCamera],
    covariances: Mapping[str, Array | None],
    moments: Iterable[RecordedMoment],
    *,
    progress: Progress = lambda words: None,
) -> Refinement:
    """Moves cameras until what they see in common fits together, each within what its covariance allows.

    Maximum a posteriori: distances between surfaces of all pairs of cameras, and each camera's own pose with its
    covariance. So the world stays where the cameras together say that it is.

    Args:
        cameras: two or more, with poses.
        covariances: of each pose, shape (6, 6); None: this camera holds exactly.
        moments: of a room seen by all of them; people may move between them, not the cameras.
        progress: told what is being done.

    Raises:
        CalibrationError: a camera that shares no view with the others, surfaces that do not come together, or a camera
            that the images want farther from where it was than its covariance allows.
    """
    poses = {camera.name: camera.world_from_camera for camera in cameras}
    missing = [name for name in poses if name not in covariances]
    if missing:
        raise CalibrationError(
            f"camera {missing[0]}: how sure its pose is, is not known; calibrate it, or say it with --sure-to"
        )
    free = [name for name in poses if covariances[name] is not None]
    if len(poses) < 2 or not free:
        raise CalibrationError(
            f"refine: {len(poses)} cameras, {len(free)} of them may move; at least 2 and 1 are needed"
        )
    progress("reading images")
    views, used = _views(cameras, moments)
    progress("surfaces")
    pairs = pairs_of(views)
    prior = {name: np.linalg.inv(covariances[name]) for name in free}
    start = dict(poses)
    for gate_m in GATES_M:
        rule = RULE._replace(gate_m=gate_m, floor_m=max(RULE.floor_m, gate_m / 10), least_cosine=0.6)
        poses, _, _ = _step(pair_sums(pairs, poses, rule), poses, start, prior, free)
        progress("coming together")
    converged = False
    for _ in range(FINE_ROUNDS):
        sums = pair_sums(pairs, poses, RULE)
        poses, normal, length = _step(sums, poses, start, prior, free)
        progress("least squares")
        if length < STILL:
            converged = True
            break
    sums = pair_sums(pairs, poses, RULE)
    _check(sums, poses, start, prior, free, converged)
    _, normal, _ = _step(sums, poses, start, prior, free)
    covariance = np.linalg.inv(normal)
    found = []
    for row, name in enumerate(free):
        own = covariance[6 * row : 6 * row + 6, 6 * row : 6 * row + 6]
        before = next(camera for camera in cameras if camera.name == name)
        found.append(
            CalibratedCamera(
                camera=replace(before, world_from_camera=poses[name]),
                before=before,
                covariance=own,
                residuals_px=np.zeros(0),
                residuals_m=np.concatenate([s.offs for s in sums if name in (s.one, s.other)]),
                notes=_notes(name, own, covariances[name]),
            )
        )
    return Refinement(tuple(found), _agreements(pairs, sums, start, poses), used)


def _views(cameras: Sequence[DepthCamera], moments: Iterable[RecordedMoment]) -> tuple[list[Surfaces], int]:
    frames: dict[str, list[tuple[int, DepthFrame]]] = {camera.name: [] for camera in cameras}
    chosen = list(moments)
    chosen = (
        [chosen[i] for i in np.unique(np.linspace(0, len(chosen) - 1, MOST_MOMENTS).astype(int))]
        if chosen
        else []
    )
    for number, moment in enumerate(chosen):
        for frame in moment.frames:
            if frame.camera in frames:
                frames[frame.camera].append((number, frame))
    for name, own in frames.items():
        if not own:
            raise CalibrationError(
                f"camera {name}: no image of it; look whether it was running, or leave it out"
            )
    return [
        surfaces(
            planar_images(camera, [frame for _, frame in frames[camera.name]]),
            [number for number, _ in frames[camera.name]],
        )
        for camera in cameras
    ], len(chosen)


def _step(
    sums: Sequence[PairSums],
    poses: dict[str, Array],
    start: Mapping[str, Array],
    prior: Mapping[str, Array],
    free: list[str],
) -> tuple[dict[str, Array], Array, float]:
    """One step of Gauss and Newton; new poses, normal equations, and the step's length in sigmas.

    A point of the one camera sees, in the other's frame, the one's twist brought there minus the other's own.
    """
    normal, gradient = np.zeros((6 * len(free),) * 2), np.zeros(6 * len(free))
    at = {name: slice(6 * row, 6 * row + 6) for row, name in enumerate(free)}
    for pair in sums:
        inflation = inflation_of(pair)
        own, slope = pair.normal.sum(axis=0) / inflation, pair.gradient.sum(axis=0) / inflation
        by = {
            pair.one: adjoint(invert_rigid(poses[pair.other]) @ poses[pair.one]),
            pair.other: -np.eye(6),
        }
        for name in by.keys() & at.keys():
            gradient[at[name]] += by[name].T @ slope
            for other in by.keys() & at.keys():
                normal[at[name], at[other]] += by[name].T @ own @ by[other]
    for name in free:
        normal[at[name], at[name]] += prior[name]
        gradient[at[name]] += prior[name] @ between(start[name], poses[name])
    twist = -np.linalg.solve(normal, gradient)
    new = dict(poses)
    for name in free:
        new[name] = moved(poses[name], twist[at[name]])
    return new, normal, float(np.sqrt(twist @ normal @ twist))


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


def _check(
    sums: Sequence[PairSums],
    poses: Mapping[str, Array],
    start: Mapping[str, Array],
    prior: Mapping[str, Array],
    free: list[str],
    converged: bool,
) -> None:
    """Refuses what the images do not bear out; names the camera."""
    common = [pair for pair in sums if pair.compared >= FEWEST_COMMON]
    for name in poses:
        if not any(name in (pair.one, pair.other) for pair in common):
            raise CalibrationError(
                f"camera {name}: shares no view with any other camera; it cannot be refined on the common scene: "
                "calibrate it by a board or the machine, or leave it out"
            )
    apart = _parts(list(poses), common)
    if len(apart) > 1:
        raise CalibrationError(
            f"cameras {', '.join(sorted(apart[1]))}: share no view with {', '.join(sorted(apart[0]))}; refine them "
            "apart, or calibrate them together by a board or the machine"
        )
    for name in free:
        allowed = between(start[name], poses[name])
        square = float(allowed @ prior[name] @ allowed)
        if square > ALLOWED:
            far_m, far_rad = sizes(allowed)
            raise CalibrationError(
                f"camera {name}: the common scene wants it {far_m * 1e3:.0f} mm and {np.degrees(far_rad):.2f} degrees from "
                f"where it was, {np.sqrt(square):.1f} of its sigmas; at most {np.sqrt(ALLOWED):.1f} are allowed (99 %): "
                "it was knocked, or its covariance is too small; calibrate it again"
            )
    for name in poses:
        mine = [pair for pair in common if name in (pair.one, pair.other)]
        agreeing, compared = (int(sum(pair.counts[c] for pair in mine)) for c in (1, 0))
        if agreeing < LEAST_SHARE * compared:
            raise CalibrationError(
                f"camera {name}: {100 * agreeing / compared:.0f} % of what it shares with others fits together, at least "
                f"{100 * LEAST_SHARE:.0f} % must; its pose is too far off for this: calibrate it by a board or the machine"
            )
    if not converged:
        raise CalibrationError(
            "refine: the cameras do not come to rest; capture a room with more in it, or calibrate by a board or the machine"
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


def _notes(name: str, covariance: Array, before: Array) -> tuple[str, ...]:
    """What the common scene says nothing of."""
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
    return (
        f"{name}: the common scene leaves {weakest_words(freed @ freed.T)} free ({place_m * 1e3:.0f} mm, "
        f"{np.degrees(turn):.2f} degrees, as before); put furniture where it and others look",
    )


def _agreements(
    pairs: Sequence[tuple[Surfaces, Surfaces]],
    sums: Sequence[PairSums],
    before: Mapping[str, Array],
    after: Mapping[str, Array],
) -> tuple[PairAgreement, ...]:
    found = []
    for (one, other), pair in zip(pairs, sums, strict=True):
        if pair.compared < FEWEST_COMMON:
            continue
        total = []
        for poses in (before, after):
            whole = Agreement(0, 0, 0, 0)
            _, rows, at = np.intersect1d(one.moments, other.moments, return_indices=True)
            for row, other_row in zip(rows, at, strict=True):
                whole += agreement(
                    one.images.at(poses[one.name]),
                    one.images.depth_m[row],
                    other.images.at(poses[other.name]),
                    other.images.depth_m[other_row],
                )
            total.append(whole)
        found.append(PairAgreement(one.name, other.name, *total))
    return tuple(found)
