"""Why a motion ends where it does, in numbers, and what would change it."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from elbowroom.geometry import DepthCamera
from elbowroom.geometry.kernels.bits import plain
from elbowroom.geometry.kernels.noise import margin_at
from elbowroom.machine import Machine
from elbowroom.motion import Cause, Motion, Verdict
from elbowroom.reconstruct import FreeSpace
from elbowroom.reconstruct.point_report import CameraSight, PointReport, Sight
from elbowroom.reconstruct.records import margin_of
from elbowroom.reconstruct.source import ImageSource

MOST_POINTS = 200
"""Of what was measured about a voxel so many points are compared with the link."""
NEAREST_CAMERA_M = 0.2
"""No advice asks for a camera nearer than this [m]."""
FEW_MM = 5.0
"""A gap that is smaller is none that can be told [mm]."""


@dataclass(frozen=True, slots=True, eq=False)
class Why:
    """Why a motion ends where it does.

    Args:
        verdict: of the motion.
        report: what each camera saw at the voxel that ends it; None: that lies nowhere, or no images are at hand.
        outside_m: how far what was measured there is from the link, where the motion ends [m]; None: nothing was.
        advice: what would change it, a sentence each.
    """

    verdict: Verdict
    report: PointReport | None
    outside_m: float | None
    advice: tuple[str, ...]

    @property
    def is_the_margin(self) -> bool:
        """Whether nothing was measured in the link's way but what lies outside it, within the margin."""
        if self.verdict.cause is not Cause.SURFACE or self.outside_m is None or self.report is None:
            return False
        widest = max((camera.margin_m for camera in self.measuring), default=0.0)
        return FEW_MM / 1e3 < self.outside_m <= widest

    @property
    def measuring(self) -> tuple[CameraSight, ...]:
        """Cameras that measured something about the voxel, the machine apart, and do not see through."""
        if self.report is None:
            return ()
        return tuple(
            camera
            for camera in self.report.cameras
            if camera.sight in (Sight.SURFACE, Sight.EDGE) and camera.least_m is not None
        )


def why(space: FreeSpace, machine: Machine, joints: Mapping[str, float], verdict: Verdict) -> Why:
    """Why a motion ends where it does.

    Args:
        space: that it was checked in, with what it was made of.
        machine, joints: as they were checked.
        verdict: what came of it.
    """
    place, source = verdict.place_in_world, space.source
    if place is None or not isinstance(source, ImageSource) or not space.grid.contains(place):
        return Why(verdict, None, None, _elsewhere(verdict))
    report = space.explain(place)
    measured = source.surface_about(space.grid, report.index)
    outside_m = None
    if verdict.cause is Cause.SURFACE and verdict.link is not None:
        stopping = [c for c in report.cameras if c.sight in (Sight.SURFACE, Sight.EDGE)]
        points = [measured[c.camera][_is_near(measured[c.camera], place, space, c)] for c in stopping]
        near = np.concatenate([np.zeros((0, 3)), *points])
        outside_m = _distance(near, space, place, _link_at(machine, joints, verdict))
    found = Why(verdict, report, outside_m, ())
    return Why(verdict, report, outside_m, tuple(_advice(found, source)))


def _is_near(
    points: NDArray[np.float64], place: tuple[float, float, float], space: FreeSpace, camera: CameraSight
) -> NDArray[np.bool_]:
    """Which points may lie in a voxel, give or take the camera's margin: pixels at its rim show what is beyond it."""
    reach_m = space.grid.voxel_size_m + camera.margin_m
    return np.asarray(np.linalg.norm(points - np.array(place), axis=1) <= reach_m)


def _link_at(machine: Machine, joints: Mapping[str, float], verdict: Verdict) -> NDArray[np.float64]:
    """Triangles of the link where the motion ends, shape (n, 3, 3), world frame [m]."""
    motion, there = verdict.motion, dict(joints)
    if isinstance(motion, Motion):
        there[motion.joint] += motion.direction * verdict.free_travel
    link = machine.links[machine.link_names.index(str(verdict.link))]
    pose = machine.world_from_links(there)[link.name]
    placed: NDArray[np.float64] = link.triangles @ pose[:3, :3].T + pose[:3, 3]
    return placed


def _distance(
    points: NDArray[np.float64],
    space: FreeSpace,
    place: tuple[float, float, float],
    link: NDArray[np.float64],
) -> float | None:
    """Median distance from a link of what was measured nearest to a place [m]."""
    if not len(points):
        return None
    from trimesh.triangles import closest_point  # slow to load, and only stops ask

    aside = np.linalg.norm(points - np.array(place), axis=1)
    near = points[np.argsort(aside)[:MOST_POINTS]]
    # only what of the link can be nearest: about the voxel, by how far the points are
    about = float(np.linalg.norm(near - np.array(place), axis=1).max()) + 4 * space.grid.voxel_size_m
    lower, upper = link.min(axis=1), link.max(axis=1)
    gap = np.maximum(np.maximum(lower - place, place - upper), 0.0)
    some = link[np.linalg.norm(gap, axis=1) <= about]
    if not len(some):
        return None
    distances = []
    for point in near:
        foot = closest_point(some, np.broadcast_to(point, (len(some), 3)))
        distances.append(float(np.linalg.norm(foot - point, axis=1).min()))
    return float(np.median(distances))


def _elsewhere(verdict: Verdict) -> tuple[str, ...]:
    if verdict.cause is Cause.OUTSIDE_GRID:
        return (f"the watched box ends there: make it larger, or name {verdict.link} in unchecked_links",)
    return ()


def _advice(found: Why, source: ImageSource) -> list[str]:
    """What would change it."""
    report, cause = found.report, found.verdict.cause
    assert report is not None
    if cause is Cause.SURFACE and found.is_the_margin:
        return _of_margin(found, source)
    if cause is Cause.SURFACE and found.outside_m is not None:
        return [f"something is there: {_mm(found.outside_m)} from {found.verdict.link} where the motion ends"]
    if cause is Cause.BLIND:
        blind = [
            f"{c.camera} ({100 * c.without_return:.0f} %)" for c in report.cameras if c.sight is Sight.BLIND
        ]
        return [
            f"pixels without a valid return: {', '.join(blind)}; look for what blinds them, or for its range"
        ]
    if cause is Cause.KEPT_OUT:
        return [
            f"zone {found.verdict.zone} keeps all links out there: change it in the site, if it may be entered"
        ]
    if cause in (Cause.UNSEEN, Cause.SURFACE):
        # a surface of which no camera measured anything near is an edge across the voxel
        hidden = [c.camera for c in report.cameras if c.sight in (Sight.HIDDEN, Sight.EDGE)]
        hiding = f"{', '.join(hidden)} would see it, were nothing in between; " if hidden else ""
        return [f"{hiding}a camera that looks there from another side would settle it"]
    return []


def _of_margin(found: Why, source: ImageSource) -> list[str]:
    """That a surface outside the link is too near for what the cameras can tell, and from where it could be told."""
    assert found.outside_m is not None
    names = ", ".join(camera.camera for camera in found.measuring)
    widest = max(found.measuring, key=lambda camera: camera.margin_m)
    text = (
        f"the surface lies about {_mm(found.outside_m)} from {found.verdict.link}, and the margin of {names} there "
        f"is up to {_mm(widest.margin_m)}: so near a surface they cannot tell that the space before it is free"
    )
    ways = ["less noise", "a machine that stands higher or farther from it"]
    cameras = {camera.name: camera for camera in source.images.cameras}
    nearer = near_enough_m(cameras[widest.camera], found.outside_m, source)
    if nearer is not None:
        ways.insert(
            0, f"cameras nearer than about {nearer:.1f} m ({widest.camera} is {widest.distance_m:.1f} m away)"
        )
    return [text, f"what would change it: {', '.join(ways[:-1])}, or {ways[-1]}"]


def near_enough_m(camera: DepthCamera, gap_m: float, source: ImageSource) -> float | None:
    """From how far a camera of this kind would have a margin of a gap at most [m]; None: from nowhere.

    Args:
        camera: of its kind.
        gap_m: at most so wide the margin is [m].
        source: by whose terms.
    """
    margin = margin_of(camera, camera.margin or source.terms.margin)
    depths = np.arange(NEAREST_CAMERA_M, 20.0, 0.05)
    good = [depth for depth in depths if plain(margin_at)(margin, depth) <= gap_m]
    return float(good[-1]) if good else None


def _mm(metres: float) -> str:
    return f"{1e3 * metres:.0f} mm"
