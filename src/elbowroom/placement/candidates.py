"""Where cameras may hang, what they may look at, and what each would cost."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import trimesh
from numpy.typing import NDArray

from elbowroom.errors import CameraError, InputError
from elbowroom.geometry import DepthCamera, VoxelGrid, looking_at
from elbowroom.placement.even import FROM_WALL_M
from elbowroom.placement.fixed_room import FixedRoom
from elbowroom.placement.sensor import Sensor, sensors_of
from elbowroom.site import Site
from elbowroom.site.placement_entry import AlongEntry, PlacementEntry, PricesEntry

WALL_SPACING_M, CEILING_SPACING_M = 0.5, 1.25
"""Where a site says nothing: mounts along the walls and on the ceiling are so far apart [m]."""
TOO_NEAR = 1e-6


@dataclass(frozen=True, slots=True, eq=False)
class Mount:
    """A place where one camera may hang.

    Args:
        name: of the place.
        position_m: shape (3,), world frame [m].
        price: of the mount.
        cable_m: length of cable to the hub [m].
    """

    name: str
    position_m: NDArray[np.float64]
    price: float
    cable_m: float


@dataclass(frozen=True, slots=True, eq=False)
class Candidate:
    """A camera that could be bought and mounted.

    Args:
        camera: at its place; its name is the mount's.
        mount: where it hangs.
        sensor: its kind.
        price: of sensor, mount and cable together.
        cable_price: of the cable alone.
    """

    camera: DepthCamera
    mount: Mount
    sensor: Sensor
    price: float
    cable_price: float


def candidates_of(
    site: Site, grid: VoxelGrid, room: FixedRoom | None, *, seed: int = 1
) -> tuple[Candidate, ...]:
    """Every kind of sensor at every mount with every aim, as the site's key `placement` says.

    Where it lists no mounts, they are along the walls every half metre at 2.4 and 0.4 m and on the ceiling.

    Args:
        site: the file.
        grid: the watched box, whose middle and quarters are aimed at where the site lists no `aims_m`.
        room: walls and furniture; mounts inside a solid are left out.
        seed: of the places drawn on a mesh.

    Raises:
        InputError: no mount is left, or walls that are not known.
        SiteError: a sensor that no camera can be.
    """
    given = site.entry.placement or PlacementEntry()
    mounts = _mounts(given, room, seed)
    mounts = [mount for mount in mounts if _is_free(mount, given, room)]
    aims = np.array(given.aims_m) if given.aims_m else default_aims(grid)
    prices, sensors = given.prices, sensors_of(site)
    made = []
    for mount in mounts:
        for sensor in sensors:
            for aim in aims:
                if np.linalg.norm(aim - mount.position_m) < TOO_NEAR:
                    continue
                camera = sensor.at(mount.name, looking_at(mount.position_m.tolist(), aim.tolist()))
                cable = mount.cable_m * prices.cable_per_m
                made.append(Candidate(camera, mount, sensor, sensor.price + mount.price + cable, cable))
    if not made:
        raise InputError(
            f"{site.path}: placement: no candidates; every mount is taken, forbidden or inside something fixed, or "
            "none is given"
        )
    return tuple(made)


def default_aims(grid: VoxelGrid) -> NDArray[np.float64]:
    """Where cameras may look: the box's middle at three heights, and the middles of its quarters, shape (7, 3) [m]."""
    lower, size = grid.lower_m, grid.upper_m - grid.lower_m
    middle = [(0.5, 0.5, high) for high in (0.1, 0.3, 0.5)]
    quarters = [(x, y, 0.3) for x in (0.25, 0.75) for y in (0.25, 0.75)]
    return lower + np.array(middle + quarters) * size


def _mounts(given: PlacementEntry, room: FixedRoom | None, seed: int) -> list[Mount]:
    prices = given.prices
    mounts = []
    for entry in given.mounts:
        if not entry.taken:
            position = np.array(entry.position_m)
            price = prices.mount if entry.price is None else entry.price
            cable = cable_m(position, prices) if entry.cable_m is None else entry.cable_m
            mounts.append(Mount(entry.name, position, price, cable))
    along = given.mounts_along
    if along is None and not given.mounts:
        along = AlongEntry(wall_spacing_m=WALL_SPACING_M, ceiling_spacing_m=CEILING_SPACING_M)
    if along is not None:
        places = _along(along, room, seed)
        mounts += [Mount(name, at, prices.mount, cable_m(at, prices)) for name, at in places]
    return mounts


def _along(along: AlongEntry, room: FixedRoom | None, seed: int) -> list[tuple[str, NDArray[np.float64]]]:
    """Names and places of the mounts along walls, ceiling and mesh."""
    if room is None or room.walls_m is None:
        raise InputError(
            "placement: no walls to mount cameras on; give room.walls in the site file, or list mounts"
        )
    lower, upper = room.walls_m[0] + FROM_WALL_M, room.walls_m[1] - FROM_WALL_M
    places: list[tuple[str, NDArray[np.float64]]] = []
    if along.wall_spacing_m is not None:
        for height in along.heights_m:
            at = f"-{height:g}" if len(along.heights_m) > 1 else ""
            ring = _ring(lower[:2], upper[:2], along.wall_spacing_m)
            places += [
                (f"wall{number:02d}{at}", np.array([x, y, height])) for number, (x, y) in enumerate(ring)
            ]
    if along.ceiling_spacing_m is not None:
        axes = [_inner(lower[axis], upper[axis], along.ceiling_spacing_m) for axis in (0, 1)]
        spots = [(x, y) for x in axes[0] for y in axes[1]]
        places += [(f"ceiling{n:02d}", np.array([x, y, upper[2]])) for n, (x, y) in enumerate(spots)]
    if along.mesh_count is not None:
        places += _on_mesh(along.mesh_count, room, seed)
    return places


def _ring(lower: NDArray[np.float64], upper: NDArray[np.float64], spacing: float) -> NDArray[np.float64]:
    """Places at about equal distances along four sides, corners among them, shape (n, 2)."""
    corners = np.array([(upper[0], lower[1]), upper, (lower[0], upper[1]), lower])
    sides = []
    for start, end in zip(corners, np.roll(corners, -1, axis=0), strict=True):
        count = max(1, round(float(np.linalg.norm(end - start)) / spacing))
        sides.append(start + (end - start) * (np.arange(count) / count)[:, None])
    return np.concatenate(sides)


def _inner(low: float, high: float, spacing: float) -> NDArray[np.float64]:
    """Places at about equal distances between two walls, half of that distance from each."""
    count = max(1, round((high - low) / spacing))
    return low + (high - low) * (np.arange(count) + 0.5) / count


def _on_mesh(count: int, room: FixedRoom, seed: int) -> list[tuple[str, NDArray[np.float64]]]:
    """Places on the surfaces of the room, a little before them, evenly by area; within the walls."""
    triangles = room.triangles
    mesh = trimesh.Trimesh(
        triangles.reshape(-1, 3), np.arange(3 * len(triangles)).reshape(-1, 3), process=False
    )
    points, faces = trimesh.sample.sample_surface(mesh, 40 * count, seed=seed)
    assert room.walls_m is not None
    points = points + mesh.face_normals[faces] * FROM_WALL_M
    inside = ((points > room.walls_m[0]) & (points < room.walls_m[1])).all(axis=1)
    kept = points[inside][:count]
    return [(f"mesh{number:02d}", point) for number, point in enumerate(kept)]


def cable_m(position: NDArray[np.float64], prices: PricesEntry) -> float:
    """Cable along the room's axes to the hub [m]; 0 without one."""
    return 0.0 if prices.hub_m is None else float(np.abs(position - np.array(prices.hub_m)).sum())


def _is_free(mount: Mount, given: PlacementEntry, room: FixedRoom | None) -> bool:
    """Whether a mount lies in no forbidden box and inside nothing fixed."""
    for box in given.forbidden:
        if (mount.position_m >= box.lower_m).all() and (mount.position_m <= box.upper_m).all():
            return False
    if room is None:
        return True
    here = np.eye(4)
    here[:3, 3] = mount.position_m
    probe = next(iter(_probe(here)))
    try:
        room.refuse_inside((probe,))
    except CameraError:
        return False
    return True


def _probe(pose: NDArray[np.float64]) -> Sequence[DepthCamera]:
    from elbowroom.placement.sensor import known_sensors

    return (known_sensors()["thesis"].at("probe", pose),)
