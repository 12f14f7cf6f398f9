"""What makes a calibration no result: cameras that land metres away, at each other's place, or are hardly known."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from elbowroom.calibrate.result.calibrated_camera import CalibratedCamera
from elbowroom.calibrate.result.change import pose_difference
from elbowroom.geometry import invert_rigid

Array = NDArray[np.float64]
FAR_M, FAR_DEG = 1.0, 45.0
"""A camera that moves farther from where the site has it was not measured roughly: something else is wrong."""
NEAR_M, NEAR_DEG = 0.5, 25.0
"""A camera that lands so near to where the site has one stands at that one's place."""
SAME_M, SAME_DEG = 0.01, 0.5
"""Two cameras that the site has so near to each other are not measured: it says nothing of where they are."""
UNSURE_M, UNSURE_DEG = 0.05, 1.0
"""One sigma beyond which a pose is not known."""


def doubts_of(
    found: Sequence[CalibratedCamera], more: str = "more poses, nearer and tilted"
) -> tuple[str, ...]:
    """Why what was found is no result, a sentence each; none: it is one.

    Args:
        found: cameras, as they were and as they are now.
        more: what makes a pose better known, in words.
    """
    return (*_unsure(found, more), *_far(found))


def _unsure(found: Sequence[CalibratedCamera], more: str) -> list[str]:
    words = []
    for one in found:
        sigma_m = float(np.sqrt(np.trace(one.covariance[3:, 3:])))
        sigma_deg = float(np.degrees(np.sqrt(np.trace(one.covariance[:3, :3]))))
        if sigma_m > UNSURE_M or sigma_deg > UNSURE_DEG:
            words.append(f"{one.camera.name} ({sigma_m * 1e3:.0f} mm, {sigma_deg:.1f} degrees)")
    if not words:
        return []
    return [f"hardly known: {_listed(words)}; {more}, or look whether all images are right"]


def _far(found: Sequence[CalibratedCamera]) -> list[str]:
    before = {one.camera.name: one.before.world_from_camera for one in found if one.before is not None}
    after = {one.camera.name: one.camera.world_from_camera for one in found if one.camera.name in before}
    moved = {name: _apart(before[name], after[name]) for name in before}
    far = [name for name, (by_m, by_deg) in moved.items() if by_m > FAR_M or by_deg > FAR_DEG]
    if not far or _says_nothing(list(before.values())):
        return []
    sizes = _listed([f"{name} by {moved[name][0]:.1f} m and {moved[name][1]:.0f} degrees" for name in far])
    return [f"moved far from where the site has them: {sizes}; {_arrangement(before, after)}"]


def _says_nothing(poses: Sequence[Array]) -> bool:
    """Whether cameras stand at one and the same place, as where nobody has measured yet."""
    return any(
        by_m < SAME_M and by_deg < SAME_DEG
        for number, one in enumerate(poses)
        for by_m, by_deg in (_apart(one, other) for other in poses[number + 1 :])
    )


def _apart(one: Array, other: Array) -> tuple[float, float]:
    by_m, by_rad = pose_difference(one, other)
    return by_m, float(np.degrees(by_rad))


@dataclass(frozen=True, slots=True, eq=False)
class _Arrangement:
    """The cameras as they were found, laid on those that the site has.

    Args:
        places: by camera, at whose place it lands; those that land at none are left out.
        by_m, by_deg: how far all of them were moved together for that.
    """

    places: dict[str, str]
    by_m: float
    by_deg: float

    @property
    def rank(self) -> tuple[int, int, float]:
        """The more cameras land at a place, and at their own, the better; then the less they are moved together."""
        own = sum(name == place for name, place in self.places.items())
        return len(self.places), own, -self.by_m - self.by_deg / 45


def _arrangement(before: Mapping[str, Array], after: Mapping[str, Array]) -> str:
    """What most likely happened, in words."""
    names = list(before)
    tries = [_laid(before, after, np.eye(4))]
    if len(names) > 2:
        tries += [
            _laid(before, after, before[other] @ invert_rigid(after[one])) for one in names for other in names
        ]
    best = max(tries, key=lambda one: one.rank)
    exchanged = {name: place for name, place in sorted(best.places.items()) if name != place}
    together = best.by_m > NEAR_M or best.by_deg > NEAR_DEG
    if len(best.places) < max(2, 0.7 * len(names)):
        return "look whether names, folders and poses belong together, and whether calibration.world is right"
    words = []
    if together:
        words.append(
            f"all moved alike, by {best.by_m:.1f} m and {best.by_deg:.0f} degrees, so it is the world that moved: look "
            "at calibration.world (pose, first_corner_m, x_axis_deg, points)"
        )
    if exchanged:
        pairs = _listed([f"{name} at the place of {place}" for name, place in exchanged.items()])
        words.append(f"{pairs}: their folders, or their names in the site file, are exchanged")
    return (
        "; ".join(words)
        or "look whether the site's poses are of this room, and whether calibration.world is right"
    )


def _laid(before: Mapping[str, Array], after: Mapping[str, Array], together: Array) -> _Arrangement:
    """Each camera at the nearest place that is left, the nearest first."""
    pairs = []
    for name, pose in after.items():
        for place, at in before.items():
            by_m, by_deg = _apart(at, together @ pose)
            if by_m < NEAR_M and by_deg < NEAR_DEG:
                pairs.append((by_m / NEAR_M + by_deg / NEAR_DEG, name, place))
    places: dict[str, str] = {}
    for _, name, place in sorted(pairs):
        if name not in places and place not in places.values():
            places[name] = place
    middle = np.mean([pose[:3, 3] for pose in after.values()], axis=0)
    shift = together[:3, :3] @ middle + together[:3, 3] - middle
    turn = np.eye(4)
    turn[:3, :3] = together[:3, :3]
    return _Arrangement(places, float(np.linalg.norm(shift)), _apart(np.eye(4), turn)[1])


def _listed(words: Sequence[str]) -> str:
    return ", ".join(words[:4]) + (f" and {len(words) - 4} more" if len(words) > 4 else "")
