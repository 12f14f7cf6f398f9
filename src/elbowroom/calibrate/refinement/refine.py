"""Cameras refined on what they see in common: walls, floor, furniture; never farther than their covariance allows."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from elbowroom.calibrate.refinement.agreement import Agreement, agreement, seen_from
from elbowroom.calibrate.refinement.kernels.overlap import Overlap
from elbowroom.calibrate.refinement.overlap import PairSums, Surfaces, pair_sums, pairs_of, surfaces
from elbowroom.calibrate.refinement.step import Before, equations, step
from elbowroom.calibrate.refinement.verdict import FEWEST_COMMON, check_refined, untouched_notes
from elbowroom.calibrate.result.calibrated_camera import CalibratedCamera
from elbowroom.calibrate.result.surface_picture import SurfacePicture
from elbowroom.errors import CalibrationError
from elbowroom.geometry import DepthCamera
from elbowroom.sensing import DepthFrame, Snapshot
from elbowroom.sensing.planar_images import planar_images

GATES_M = (0.40,) * 6 + (0.25,) * 6 + (0.15,) * 6 + (0.10,) * 6 + (0.05,) * 8
"""How far apart surfaces may be and still be the same, round by round [m]; then by sigmas alone."""
FINE_ROUNDS = 30
RULE = Overlap(gate_m=0.0, reach=4.7, floor_m=0.002, least_cosine=0.8, tiles=4, arm_px=np.nan)

ROUGH_COSINE = 0.6
STILL = 0.05
"""A step of fewer sigmas is the last one."""
RESTLESS, HALF_AFTER = 1.0, 8
"""Points that come and go keep the poses swinging a little: later steps are halved; longer ones never came to rest."""
WORSE = 0.98
"""Share of the agreeing pixels that must be left: less is more than chance."""
MOST_MOMENTS, MOST_COMPARISONS = 12, 1500
"""Of the room, and of images with images: a still room says no more the oftener it is seen."""

Array = NDArray[Any]
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

    def row(self) -> dict[str, Any]:
        """A row of kind "pair": shares of pixels that agree, before and after [%]."""
        return {
            "kind": "pair",
            "one": self.one,
            "other": self.other,
            "compared": self.after.compared,
            "agree_before_pct": self.before.agree_pct,
            "agree_pct": self.after.agree_pct,
            "hidden_pct": self.after.hidden_pct,
            "conflict_pct": self.after.conflict_pct,
        }


@dataclass(frozen=True, slots=True, eq=False)
class Refinement:
    """What the common scene says.

    Args:
        cameras: in the order given, those that hold left out.
        pairs: those that have enough in common.
        moments: how many were used.
        pictures: of each camera what it measured beside what another one sees there.
    """

    cameras: tuple[CalibratedCamera, ...]
    pairs: tuple[PairAgreement, ...]
    moments: int
    pictures: tuple[SurfacePicture, ...]


def refine(
    cameras: Sequence[DepthCamera],
    covariances: Mapping[str, Array | None],
    moments: Iterable[Snapshot],
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
    before = _before(cameras, covariances)
    progress("reading images")
    views, used = _views(cameras, moments)
    pairs = pairs_of(views)
    poses: Mapping[str, Array] = before.poses
    for gate_m in GATES_M:
        progress("bringing surfaces together")
        rule = RULE._replace(gate_m=gate_m, floor_m=max(RULE.floor_m, gate_m / 10), least_cosine=ROUGH_COSINE)
        poses, _ = step(pair_sums(pairs, poses, rule), poses, before)
    for number in range(FINE_ROUNDS):
        progress("least squares")
        share = 1.0 if number < HALF_AFTER else 0.5
        poses, length = step(pair_sums(pairs, poses, RULE), poses, before, share)
        if length < STILL:
            break
    sums = pair_sums(pairs, poses, RULE)
    check_refined(sums, poses, before, length < RESTLESS)
    common = [(pair, own) for pair, own in zip(pairs, sums, strict=True) if own.compared >= FEWEST_COMMON]
    agreements = tuple(_agreement(pair, before.poses, poses) for pair, _ in common)
    _refuse_worse(agreements, before)
    return Refinement(
        _refined(
            cameras, sums, poses, before, np.linalg.inv(equations(sums, poses, before, without_noise=True)[0])
        ),
        agreements,
        used,
        _pictures(views, common, poses),
    )


def _before(cameras: Sequence[DepthCamera], covariances: Mapping[str, Array | None]) -> Before:
    names = [camera.name for camera in cameras]
    missing = [name for name in names if name not in covariances]
    if missing:
        raise CalibrationError(
            f"camera {missing[0]}: how sure its pose is, is not known; calibrate it by a board or the machine, or "
            "give its covariance"
        )
    known = {name: given for name in names if (given := covariances[name]) is not None}
    if len(names) < 2 or not known:
        raise CalibrationError(
            f"refine: {len(names)} cameras, {len(known)} of them may move; at least 2 and 1 are needed"
        )
    return Before({camera.name: camera.world_from_camera for camera in cameras}, known)


def _refined(
    cameras: Sequence[DepthCamera],
    sums: Sequence[PairSums],
    poses: Mapping[str, Array],
    before: Before,
    covariance: Array,
) -> tuple[CalibratedCamera, ...]:
    found = []
    for row, name in enumerate(before.free):
        own = covariance[6 * row : 6 * row + 6, 6 * row : 6 * row + 6]
        old = next(camera for camera in cameras if camera.name == name)
        found.append(
            CalibratedCamera(
                camera=replace(old, world_from_camera=poses[name]),
                before=old,
                covariance=own,
                residuals_px=np.zeros(0),
                residuals_m=np.concatenate([s.offs for s in sums if name in (s.one, s.other)]),
                notes=untouched_notes(name, own, before.covariances[name]),
            )
        )
    return tuple(found)


def _views(cameras: Sequence[DepthCamera], moments: Iterable[Snapshot]) -> tuple[list[Surfaces], int]:
    """Images of all cameras as surfaces, of as many moments as are worth it, and how many those are."""
    everything = list(moments)
    count = min(MOST_MOMENTS, max(1, MOST_COMPARISONS // (len(cameras) * (len(cameras) - 1))))
    rows = np.unique(np.linspace(0, len(everything) - 1, count).astype(int)) if everything else ()
    frames: dict[str, list[tuple[int, DepthFrame]]] = {camera.name: [] for camera in cameras}
    for number in rows:
        for frame in everything[number].frames:
            if frame.camera in frames:
                frames[frame.camera].append((int(number), frame))
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
    ], len(rows)


def _together(one: Surfaces, other: Surfaces) -> list[tuple[int, int]]:
    """Rows of the images of both of the same moments."""
    _, rows, other_rows = np.intersect1d(one.moments, other.moments, return_indices=True)
    return [(int(a), int(b)) for a, b in zip(rows, other_rows, strict=True)]


def _refuse_worse(pairs: Sequence[PairAgreement], before: Before) -> None:
    """A camera that fits worse than before was laid on the wrong surfaces.

    Raises:
        CalibrationError: names the first one.
    """
    for name in before.free:
        mine = [pair for pair in pairs if name in (pair.one, pair.other)]
        now, then = sum(pair.after.agree for pair in mine), sum(pair.before.agree for pair in mine)
        if now < WORSE * then:
            raise CalibrationError(
                f"camera {name}: {then} of its pixels agreed with other cameras, refined only {now} would; it was laid "
                "on the wrong surfaces: capture a room with more in it, or calibrate by a board or the machine"
            )


def _agreement(
    pair: tuple[Surfaces, Surfaces], before: Mapping[str, Array], after: Mapping[str, Array]
) -> PairAgreement:
    one, other = pair

    def whole(poses: Mapping[str, Array]) -> Agreement:
        total = Agreement(0, 0, 0, 0)
        for row, at in _together(one, other):
            total += agreement(
                one.images.at(poses[one.name]),
                one.images.depth_m[row],
                other.images.at(poses[other.name]),
                other.images.depth_m[at],
            )
        return total

    return PairAgreement(one.name, other.name, whole(before), whole(after))


def _pictures(
    views: Sequence[Surfaces],
    common: Sequence[tuple[tuple[Surfaces, Surfaces], PairSums]],
    poses: Mapping[str, Array],
) -> tuple[SurfacePicture, ...]:
    """Of each camera what it measured, beside what the camera that shares most with it sees there."""
    found = []
    for view in views:
        one = max(((own.compared, pair[0]) for pair, own in common if pair[1] is view), key=lambda x: x[0])[1]
        row, at = _together(one, view)[0]
        camera = view.images.at(poses[view.name])
        expected = seen_from(camera, one.images.at(poses[one.name]), one.images.depth_m[row])
        measured = view.images.depth_m[at]
        near = np.abs(measured - expected) < RULE.reach * _sigma(camera, measured)
        agrees = (measured > 0) & (expected > 0) & near
        found.append(SurfacePicture(view.name, f"beside what {one.name} sees", measured, expected, agrees))
    return tuple(found)


def _sigma(camera: DepthCamera, depth_m: NDArray[np.float32]) -> Array:
    floor = np.full(depth_m.shape, RULE.floor_m)
    return floor if camera.noise is None else np.hypot(camera.noise.sigma(depth_m), floor)
