"""Detection capability: at each place the smallest object that the cameras as placed will see (docs/safety.md).

An object is seen by a camera if it is as thick as some pixels at its range, so that no pair of rays passes it by on
both sides, and stands out from the depth noise. Where `views` cameras are needed, the one of them that needs the
thickest object decides. No object thinner than a voxel's diagonal is told apart from its voxel.
"""

import math
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from elbowroom.errors import InputError
from elbowroom.files.atomic import whole_file
from elbowroom.geometry import DepthCamera, VoxelGrid
from elbowroom.geometry.parallel import spread
from elbowroom.placement.verification import Verification

PIXELS = 3.0
"""An object must be so many pixel pitches thick (docs/safety.md, "Detection capability")."""
SIGMAS = 3.0
"""Its depth must differ from what is behind by so many sigmas on each side; a camera's own margin goes before."""
FINE_MM, COARSE_MM = 40.0, 70.0
"""Limits of ISO 13855: up to the first C = 8 (d - 14), up to the second C = 850 mm."""
PERCENTS, SIZES_MM = (50.0, 90.0, 99.0), (14.0, 40.0, 70.0, 150.0)
"""Of the places at which a size is told, and sizes of which the share of places is told."""


@dataclass(frozen=True, slots=True, eq=False)
class Capability:
    """The smallest object that is seen, by place.

    Args:
        grid: the watched box.
        views: so many cameras must see it.
        smallest_mm: float32, shape of the grid: thickness of the smallest object [mm]; infinite if fewer cameras see.
        pitch_mm: the part of it that pixels ask for, of the camera that decides [mm].
        noise_mm: the part that noise asks for [mm].
        asked: bool, shape of the grid: nothing fixed is there.
    """

    grid: VoxelGrid
    views: int
    smallest_mm: NDArray[np.float32]
    pitch_mm: NDArray[np.float32]
    noise_mm: NDArray[np.float32]
    asked: NDArray[np.bool_]

    @property
    def intrusion_mm(self) -> NDArray[np.float32]:
        """C of ISO 13855 by place [mm]: how far somebody may reach before being seen; infinite beyond 70 mm."""
        return intrusion_mm(self.smallest_mm)

    def share_pct(self, size_mm: float) -> float:
        """Share of the places asked at which an object of this thickness is seen [%]."""
        return 100.0 * float((self.smallest_mm[self.asked] <= size_mm).mean())

    def percentile_mm(self, percent: float) -> float:
        """The thickness at which objects are seen at so many percent of the places [mm]; infinite: at fewer."""
        sizes = np.sort(self.smallest_mm[self.asked])
        return float(sizes[min(len(sizes) - 1, max(0, math.ceil(percent / 100 * len(sizes)) - 1))])

    def row(self) -> dict[str, Any]:
        """A row of kind "capability"; sizes in mm, infinite where objects of no size are seen by so many cameras."""
        worst = np.argwhere((self.smallest_mm == self.smallest_mm[self.asked].max()) & self.asked)[0]
        intrusions = np.sort(self.intrusion_mm[self.asked])
        at = {f"{p:g}_pct": int(p / 100 * (len(intrusions) - 1)) for p in PERCENTS}
        return {
            "kind": "capability",
            "views": self.views,
            "voxel_size_m": self.grid.voxel_size_m,
            "smallest_mm": {f"{p:g}_pct": self.percentile_mm(p) for p in PERCENTS},
            "intrusion_mm": {name: float(intrusions[place]) for name, place in at.items()},
            "share_pct": {f"{size:g}_mm": self.share_pct(size) for size in SIZES_MM},
            "worst_m": self.grid.centre_of(worst),
            "worst_mm": float(self.smallest_mm[tuple(worst)]),
        }


def intrusion_mm(detection_mm: NDArray[np.floating]) -> NDArray[np.float32]:
    """C of ISO 13855:2010 for a detection capability d: 8 (d - 14) mm up to 40 mm, 850 mm up to 70 mm.

    Never below zero. Beyond 70 mm the standard's separation for approach at right angles does not apply: infinite.
    Check the formula in the standard before relying on it.

    Args:
        detection_mm: d, any shape [mm].
    """
    d = np.asarray(detection_mm, dtype=np.float64)
    fine = np.maximum(8.0 * (d - 14.0), 0.0)
    return np.where(d <= FINE_MM, fine, np.where(d <= COARSE_MM, 850.0, np.inf)).astype(np.float32)


def capability(found: Verification, views: int = 1) -> Capability:
    """The smallest object that at least so many cameras see, in every voxel.

    Args:
        found: which camera sees which voxel.
        views: so many cameras must see it; 1: that it is not missed altogether; 3: as many as overrule each other.

    Raises:
        InputError: fewer than one view, or more than there are cameras.
    """
    if not 1 <= views <= len(found.cameras):
        raise InputError(
            f"placement: {views} views, there are {len(found.cameras)} cameras; 1 to that many can be asked"
        )
    grid, floor = found.grid, found.grid.voxel_size_m * math.sqrt(3.0)
    parts = [np.full(grid.shape, np.inf, dtype=np.float32) for _ in range(3)]
    index = np.stack(np.meshgrid(*(np.arange(n) for n in grid.shape[1:]), indexing="ij"), axis=-1)

    def one(i: int) -> None:
        plane = np.concatenate([np.full((*index.shape[:2], 1), i), index], axis=-1)
        points = grid.centre_of(plane)
        sizes = np.full((len(found.cameras), 2, *grid.shape[1:]), np.inf)
        for c, camera in enumerate(found.cameras):
            seen = found.seen[c, i]
            pitch, noise = needs(camera, points[seen])
            sizes[c, 0][seen], sizes[c, 1][seen] = pitch, noise
        whole = np.maximum(np.maximum(sizes[:, 0], sizes[:, 1]), floor)
        order = np.argsort(whole, axis=0, kind="stable")[views - 1][None]
        parts[0][i] = 1000 * np.take_along_axis(whole, order, axis=0)[0]
        parts[1][i] = 1000 * np.take_along_axis(sizes[:, 0], order, axis=0)[0]
        parts[2][i] = 1000 * np.take_along_axis(sizes[:, 1], order, axis=0)[0]

    spread(one, range(grid.shape[0]))
    return Capability(grid, views, parts[0], parts[1], parts[2], found.asked)


def needs(
    camera: DepthCamera, points_in_world: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """How thick an object must be at each point for pixels to hit it, and for noise not to hide it [m]."""
    in_camera = (points_in_world - camera.centre_in_world) @ camera.world_from_camera[:3, :3]
    z, radial = in_camera[:, 2], np.linalg.norm(in_camera, axis=1)
    # off the axis a pixel spans less in angle but the object is farther away: across the ray it is z / f at least
    pitch = PIXELS * z / min(camera.intrinsics.fx, camera.intrinsics.fy)
    if camera.noise is None:
        return pitch, np.zeros_like(pitch)
    depth = z if camera.depth_kind == "planar" else radial
    sigmas = SIGMAS if camera.margin is None else camera.margin.sigmas
    return pitch, 2 * sigmas * camera.noise.sigma(depth)


def save_capability(path: Path, result: Capability) -> Path:
    """Writes the map, to be read by `np.load(path, allow_pickle=False)`.

    Entries: origin_m (3,), shape (3,), voxel_size_m (), views (), and smallest_mm, pitch_mm, noise_mm, intrusion_mm and
    asked of the grid's shape in index order x, y, z.

    Raises:
        InputError: the folder cannot be written to.
    """
    with whole_file(path) as unfinished, unfinished.open("wb") as file:
        np.savez_compressed(
            file,
            origin_m=np.array(result.grid.origin_m),
            shape=np.array(result.grid.shape),
            voxel_size_m=np.array(result.grid.voxel_size_m),
            views=np.array(result.views),
            smallest_mm=result.smallest_mm,
            pitch_mm=result.pitch_mm,
            noise_mm=result.noise_mm,
            intrusion_mm=result.intrusion_mm,
            asked=result.asked,
        )
    return path
