"""What each camera saw at one voxel: asked again of the frames, not stored."""

from dataclasses import dataclass
from enum import Enum
from typing import cast

import numpy as np
from numpy.typing import NDArray

from elbowroom.errors import EvidenceError, GridError
from elbowroom.geometry import DepthCamera, VoxelGrid, bits
from elbowroom.reconstruct.carve import Detail, carve_images
from elbowroom.reconstruct.free_space import FreeSpace, Source
from elbowroom.reconstruct.images import RoomImages


class Sight(Enum):
    """What a camera can say of a voxel; the value is the sentence that a person reads."""

    THROUGH = "sees through it"
    SURFACE = "measured a surface in it"
    EDGE = "sees past a part of it only"
    BLIND = "looks there without a valid return"
    HIDDEN = "looks there, but something nearer hides it"
    OUTSIDE = "does not have all of it in its image"


@dataclass(frozen=True, slots=True)
class CameraSight:
    """One camera's say of one voxel.

    Args:
        camera: its name.
        sight: what it saw.
        distance_m: from the camera to the voxel's centre [m].
        measured_m: what the centre's pixel measured [m, the camera's kind of depth]; None: no return or outside.
    """

    camera: str
    sight: Sight
    distance_m: float
    measured_m: float | None


@dataclass(frozen=True, slots=True)
class PointReport:
    """Why one voxel is free or not.

    Args:
        index: of the voxel, (i, j, k).
        centre_m: of the voxel, world frame [m].
        state: "free", "surface", "unseen", or "the machine itself".
        cameras: what each camera saw, nearest first.
        could_settle: names of cameras that would see the voxel if what hides or blinds them were gone, nearest first.
    """

    index: tuple[int, int, int]
    centre_m: tuple[float, float, float]
    state: str
    cameras: tuple[CameraSight, ...]
    could_settle: tuple[str, ...]

    def __str__(self) -> str:
        x, y, z = self.centre_m
        lines = [f"voxel {self.index} around ({x:.2f}, {y:.2f}, {z:.2f}) m is {self.state}"]
        for sight in Sight:
            names = [seen.camera for seen in self.cameras if seen.sight is sight]
            if names:
                lines.append(f"  {', '.join(names)}: {sight.value}")
        if self.could_settle:
            lines.append(f"  could settle it with a clear view: {', '.join(self.could_settle)}")
        return "\n".join(lines)


def report_on(space: FreeSpace, point_in_world: NDArray[np.float64]) -> PointReport:
    """See `FreeSpace.explain`."""
    if space.source is None:
        raise EvidenceError("explain: no frames at hand, this space was not made from frames of cameras")
    if point_in_world.shape != (3,) or not np.isfinite(point_in_world).all():
        raise GridError(f"explain: point is {point_in_world.tolist()}, must be three finite numbers [m]")
    if not space.grid.contains(point_in_world):
        raise GridError(
            f"explain: point {point_in_world.tolist()} lies outside the grid from {space.grid.lower_m.tolist()} "
            f"to {space.grid.upper_m.tolist()}"
        )
    index = space.grid.index_of(point_in_world)
    centre = space.grid.centre_of(index)
    corner = space.grid.lower_m + index * space.grid.voxel_size_m
    voxel = VoxelGrid((corner[0], corner[1], corner[2]), (1, 1, 1), space.grid.voxel_size_m)
    seen = sorted(
        (_sight(voxel, camera, space.source, centre) for camera in space.source.images.cameras),
        key=lambda one: one.distance_m,
    )
    willing = (Sight.HIDDEN, Sight.BLIND, Sight.EDGE)
    i, j, k = (int(n) for n in index)
    return PointReport(
        (i, j, k),
        (float(centre[0]), float(centre[1]), float(centre[2])),
        _state(space, i, j, k),
        tuple(seen),
        tuple(one.camera for one in seen if one.sight in willing),
    )


def _state(space: FreeSpace, i: int, j: int, k: int) -> str:
    word, bit = bits.place_of((i, j, k), space.grid)

    def holds(words: NDArray[np.uint64]) -> bool:
        return bool(words[word] & bit)

    if holds(space.body_words):
        return "the machine itself"
    if holds(space.free_words):
        return "free"
    return "surface" if holds(space.surface_words) else "unseen"


def _sight(voxel: VoxelGrid, camera: DepthCamera, source: Source, centre: NDArray[np.float64]) -> CameraSight:
    name = camera.name
    images = RoomImages(
        (camera,),
        {n: i for n, i in source.images.least_m.items() if n == name},
        {n: i for n, i in source.images.greatest_m.items() if n == name},
    )
    model = {n: i for n, i in source.model_depth.items() if n == name}
    evidence = carve_images(
        voxel,
        images,
        detail=cast(Detail, source.detail),
        margin=source.margin,
        complete=True,
        model_depth=model,
        threads=1,
    )
    in_camera = camera.camera_from_world[:3, :3] @ centre + camera.camera_from_world[:3, 3]
    distance_m = float(np.linalg.norm(centre - camera.centre_in_world))
    k = camera.intrinsics
    measured, visible, past = None, False, False
    if in_camera[2] > 0:
        # a voxel that spills over the edge of the image can never be seen through
        reach = voxel.voxel_size_m * 0.87 * max(k.fx, k.fy) / in_camera[2]
        u, v = k.fx * in_camera[0] / in_camera[2] + k.cx, k.fy * in_camera[1] / in_camera[2] + k.cy
        half = reach + 2
        visible = half <= u <= camera.width - 1 - half and half <= v <= camera.height - 1 - half
        if visible and name in images.least_m:
            value = float(images.least_m[name][round(v), round(u)])
            measured = value if np.isfinite(value) and value > 0 else None
            behind = (
                distance_m if camera.depth_kind == "radial" else float(in_camera[2])
            ) + voxel.voxel_size_m
            about = (
                slice(round(v - reach), round(v + reach) + 1),
                slice(round(u - reach), round(u + reach) + 1),
            )
            past = bool((images.least_m[name][about] > behind).any())
    if evidence.through[0].any():
        sight = Sight.THROUGH
    elif evidence.surface.any():
        sight = Sight.SURFACE
    elif evidence.blind.any():
        sight = Sight.BLIND
    elif evidence.disputed.any() or past:
        sight = Sight.EDGE
    else:
        sight = Sight.HIDDEN if visible else Sight.OUTSIDE
    return CameraSight(name, sight, distance_m, measured)
