"""Twenty ways in which people describe cameras wrongly."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from elbowroom.evaluate.contradictions.rooms import RandomSite, Rng
from elbowroom.geometry import DepthCamera, Intrinsics
from elbowroom.geometry.transforms import invert_rigid
from elbowroom.geometry.twist import exp

Change = Callable[[Rng, DepthCamera], DepthCamera]
Cameras = tuple[DepthCamera, ...]


@dataclass(frozen=True, slots=True, eq=False)
class Wrong:
    """A site described wrongly.

    Args:
        cameras: as they are now said to be.
        named: those of which that is wrong.
    """

    cameras: Cameras
    named: frozenset[str]


Kind = Callable[[Rng, RandomSite], Wrong]


def one(change: Change) -> Kind:
    """One camera is wrong, any of them.

    Args:
        change: what is done to its description.
    """

    def wrong(rng: Rng, site: RandomSite) -> Wrong:
        at = int(rng.integers(len(site.cameras)))
        changed = change(rng, site.cameras[at])
        return Wrong(_with(site.cameras, {at: changed}), frozenset({changed.name}))

    return wrong


def each(change: Change) -> Kind:
    """All cameras are wrong alike.

    Args:
        change: what is done to each description.
    """

    def wrong(rng: Rng, site: RandomSite) -> Wrong:
        return Wrong(tuple(change(rng, camera) for camera in site.cameras), frozenset(site.names))

    return wrong


def _with(cameras: Cameras, changed: Mapping[int, DepthCamera]) -> Cameras:
    return tuple(changed.get(number, camera) for number, camera in enumerate(cameras))


def _posed(camera: DepthCamera, pose: NDArray[np.float64]) -> DepthCamera:
    return replace(camera, world_from_camera=pose)


def _inverse(_: Rng, camera: DepthCamera) -> DepthCamera:
    return _posed(camera, invert_rigid(camera.world_from_camera))


def _axes(rotation: NDArray[np.float64]) -> Change:
    """Camera axes of another convention: described axes are the optical ones times a matrix."""
    turn = np.eye(4)
    turn[:3, :3] = rotation
    return lambda _, camera: _posed(camera, camera.world_from_camera @ turn)


OPENGL = np.diag((1.0, -1.0, -1.0))
HOUSING = np.array(((0.0, -1.0, 0.0), (0.0, 0.0, -1.0), (1.0, 0.0, 0.0)))
"""Optical from housing (x forward, y left, z up)."""


def _transposed(_: Rng, camera: DepthCamera) -> DepthCamera:
    pose = camera.world_from_camera.copy()
    pose[:3, :3] = pose[:3, :3].T
    return _posed(camera, pose)


def _lens(_: Rng, camera: DepthCamera) -> DepthCamera:
    """Of the image of twice the size."""
    k = camera.intrinsics
    double = Intrinsics(2 * k.fx, 2 * k.fy, 2 * k.cx + 0.5, 2 * k.cy + 0.5, k.distortion)
    return replace(camera, intrinsics=double)


def _mirrored(camera: DepthCamera, mirror: NDArray[np.float64], image: NDArray[np.float64]) -> DepthCamera:
    """The pose of the mirrored world, with camera axes mirrored as well so that it stays rigid."""
    pose = camera.world_from_camera.copy()
    pose[:3, :3] = mirror @ pose[:3, :3] @ image
    pose[:3, 3] = mirror @ pose[:3, 3]
    return _posed(camera, pose)


def _upside_down(_: Rng, camera: DepthCamera) -> DepthCamera:
    """A set whose fy is negative, as that of a mirrored world, with the sign left out."""
    return _mirrored(camera, np.diag((1.0, -1.0, 1.0)), np.diag((1.0, -1.0, 1.0)))


def _left_handed(_: Rng, camera: DepthCamera) -> DepthCamera:
    return _mirrored(camera, np.diag((-1.0, 1.0, 1.0)), np.diag((-1.0, 1.0, 1.0)))


def _millimetres(_: Rng, camera: DepthCamera) -> DepthCamera:
    pose = camera.world_from_camera.copy()
    pose[:3, 3] *= 1000.0
    return _posed(camera, pose)


def _rolled(degrees: float) -> Change:
    return _axes(Rotation.from_euler("z", degrees, degrees=True).as_matrix())


def _quaternion(_: Rng, camera: DepthCamera) -> DepthCamera:
    """x y z w read as w x y z."""
    x, y, z, w = Rotation.from_matrix(camera.world_from_camera[:3, :3]).as_quat()
    pose = camera.world_from_camera.copy()
    pose[:3, :3] = Rotation.from_quat((y, z, w, x)).as_matrix()
    return _posed(camera, pose)


def _degrees(_: Rng, camera: DepthCamera) -> DepthCamera:
    """Degrees read as radians."""
    angles = Rotation.from_matrix(camera.world_from_camera[:3, :3]).as_euler("ZYX", degrees=True)
    pose = camera.world_from_camera.copy()
    pose[:3, :3] = Rotation.from_euler("ZYX", angles).as_matrix()
    return _posed(camera, pose)


def _moved(rng: Rng, camera: DepthCamera) -> DepthCamera:
    """By 40 cm in any direction."""
    way = rng.normal(size=3)
    return _posed(
        camera, camera.world_from_camera @ exp(np.append(np.zeros(3), 0.4 * way / np.linalg.norm(way)))
    )


def _knocked(rng: Rng, camera: DepthCamera) -> DepthCamera:
    """Turned by 12 degrees about any axis."""
    axis = rng.normal(size=3)
    turn = np.radians(12.0) * axis / np.linalg.norm(axis)
    return _posed(camera, camera.world_from_camera @ exp(np.append(turn, np.zeros(3))))


def _exchanged(rng: Rng, site: RandomSite) -> Wrong:
    a, b = (int(n) for n in rng.choice(len(site.cameras), 2, replace=False))
    one_, other = site.cameras[a], site.cameras[b]
    changed = {a: _posed(one_, other.world_from_camera), b: _posed(other, one_.world_from_camera)}
    return Wrong(_with(site.cameras, changed), frozenset({one_.name, other.name}))


def _shifted(_: Rng, site: RandomSite) -> Wrong:
    """The list of poses begins one camera late."""
    poses = [camera.world_from_camera for camera in site.cameras]
    moved = zip(site.cameras, poses[1:] + poses[:1], strict=True)
    return Wrong(tuple(_posed(camera, pose) for camera, pose in moved), frozenset(site.names))


def _copied(rng: Rng, site: RandomSite) -> Wrong:
    a, b = (int(n) for n in rng.choice(len(site.cameras), 2, replace=False))
    copy = _posed(site.cameras[a], site.cameras[b].world_from_camera)
    return Wrong(_with(site.cameras, {a: copy}), frozenset({copy.name}))


KINDS: Mapping[str, Kind] = {
    "inverse, one": one(_inverse),
    "inverse, all": each(_inverse),
    "OpenGL axes, one": one(_axes(OPENGL)),
    "OpenGL axes, all": each(_axes(OPENGL)),
    "housing axes, one": one(_axes(HOUSING.T)),
    "housing axes, all": each(_axes(HOUSING.T)),
    "rotation transposed, one": one(_transposed),
    "two exchanged": _exchanged,
    "poses one late": _shifted,
    "pose of another": _copied,
    "lens of twice the size, one": one(_lens),
    "lens of twice the size, all": each(_lens),
    "sign of fy dropped, all": each(_upside_down),
    "left-handed world, one": one(_left_handed),
    "millimetres, one": one(_millimetres),
    "rolled by 90 degrees, one": one(_rolled(90.0)),
    "rolled by 180 degrees, one": one(_rolled(180.0)),
    "quaternion misread, one": one(_quaternion),
    "degrees as radians, one": one(_degrees),
    "moved by 40 cm, one": one(_moved),
}
"""By name, what is done to a site's cameras."""
MORE: Mapping[str, Kind] = {"turned by 12 degrees, one": one(_knocked)}
