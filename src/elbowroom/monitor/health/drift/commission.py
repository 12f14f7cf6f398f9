"""Finds what stands still in front of the cameras: the reference that the watch compares with."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from elbowroom.errors import CalibrationError
from elbowroom.geometry import DepthCamera
from elbowroom.geometry.parallel import spread
from elbowroom.machine import Machine
from elbowroom.machine.rasterise import rasterise
from elbowroom.monitor.health.drift.flat_spots import flat_spots
from elbowroom.monitor.health.drift.reference import CameraReference, lens_of
from elbowroom.sensing import DepthFrame, Snapshot, rectified
from elbowroom.sensing.rays import pixel_rays

UNIT_M = 0.00025
"""Frames are kept in 16-bit steps of this: up to 16 m, a quarter of a millimetre fine."""
SPOTS = 480
"""Spots per camera."""
TILES = (8, 6)
"""The image in columns and rows, from which spots are taken in turn."""
LEAST_SHARE = 0.6
"""A pixel must have shown the same surface in so many of the frames."""
STILL_M = 0.01
MACHINE_RIM_PX = 3
LEAST_SPOTS = 60
MAX_BYTES = 1_500_000_000


@dataclass(slots=True, eq=False)
class Commissioning:
    """Collects frames of the still room, and makes references of them. People may walk through; nothing may be knocked.

    Args:
        cameras: of the room.
        machine: whose pixels do not count; None: there is none.
        frames: how many moments will be added.

    Raises:
        CalibrationError: fewer than five frames, or more than fit into memory.
    """

    cameras: Sequence[DepthCamera]
    machine: Machine | None
    frames: int
    _stacks: dict[str, NDArray[np.uint16]] = field(default_factory=dict, init=False)
    _counts: dict[str, int] = field(default_factory=dict, init=False)

    def __post_init__(self) -> None:
        if self.frames < 5:
            raise CalibrationError(
                f"commission: {self.frames} frames, at least 5 are needed to see what stands still"
            )
        size = sum(2 * camera.width * camera.height for camera in self.cameras) * self.frames
        if size > MAX_BYTES:
            raise CalibrationError(
                f"commission: {self.frames} frames take {size / 1e9:.1f} GB, at most {MAX_BYTES / 1e9:.1f} are "
                "used; take fewer"
            )
        for camera in self.cameras:
            shape = (self.frames, camera.height, camera.width)
            self._stacks[camera.name] = np.zeros(shape, dtype=np.uint16)
            self._counts[camera.name] = 0

    def add(self, snapshot: Snapshot) -> None:
        """Adds one moment; if there is a machine, with where it was.

        Raises:
            CalibrationError: a machine without joints, a frame of another size or of no camera, too many moments.
        """
        by_name = {camera.name: camera for camera in self.cameras}
        if self.machine is not None and snapshot.joints is None:
            raise CalibrationError("commission: a machine without joints; give its joint positions")

        def add(frame: DepthFrame) -> None:
            self._add(frame, by_name.get(frame.camera), snapshot.joints_at(frame.camera) or {})

        spread(add, snapshot.frames)

    def _add(self, frame: DepthFrame, camera: DepthCamera | None, joints: Mapping[str, float]) -> None:
        """Adds one frame of a camera, with where the machine was."""
        if camera is None or frame.depth_m.shape != (camera.height, camera.width):
            raise CalibrationError(f"commission: frame of {frame.camera}: no such camera, or another size")
        number = self._counts[camera.name]
        if number >= self.frames:
            raise CalibrationError(f"commission: more than the {self.frames} frames that were announced")
        usable = (frame.depth_m >= max(camera.min_depth_m, UNIT_M)) & (frame.depth_m <= camera.deepest_m)
        usable &= frame.depth_m < 65535 * UNIT_M
        if self.machine is not None:
            usable &= ~_machine_pixels(self.machine, camera, joints)
        depth = np.where(usable, frame.depth_m, 0) / UNIT_M
        self._stacks[camera.name][number] = np.round(depth).astype(np.uint16)
        self._counts[camera.name] += 1

    def reference_of(self, camera: DepthCamera) -> CameraReference:
        """The reference of one camera.

        Raises:
            CalibrationError: too few frames of it, or too little that stood still and is flat.
        """
        count = self._counts[camera.name]
        if count < 5:
            raise CalibrationError(
                f"commission: camera {camera.name} gave {count} frames, at least 5 are needed; is it connected?"
            )
        return _reference(camera, self._stacks[camera.name][:count])

    def references(self) -> tuple[CameraReference, ...]:
        """Those of all cameras, in their order.

        Raises:
            CalibrationError: as `reference_of`.
        """
        return tuple(spread(self.reference_of, self.cameras))


def _reference(camera: DepthCamera, stack: NDArray[np.uint16]) -> CameraReference:
    """What stood still and is flat in some frames of a camera."""
    depth, scatter = _still(stack)
    rays = pixel_rays(camera)
    x, y = rays.x.astype(np.float64), rays.y.astype(np.float64)
    per_planar = np.sqrt(1 + x * x + y * y) if camera.depth_kind == "radial" else np.ones_like(x)
    found = flat_spots(depth / per_planar, x, y, 1.25 * scatter / np.sqrt(len(stack)))
    chosen = _spread_out(found.flat, found.normal)
    if len(chosen) < LEAST_SPOTS:
        raise CalibrationError(
            f"commission: camera {camera.name} shows {len(chosen)} flat spots that stood still, at least "
            f"{LEAST_SPOTS} are needed; clear its view of floor and walls, or take more frames"
        )
    at = np.unravel_index(chosen, depth.shape)
    # the median of the frames at the very pixel carries its noise; the plane about it averages that out
    return CameraReference(
        camera=camera.name,
        width=camera.width,
        height=camera.height,
        lens=lens_of(camera),
        radial=camera.depth_kind == "radial",
        pixel=chosen,
        depth_m=(found.planar_m * per_planar)[at],
        sigma_m=scatter[at],
        ray=np.column_stack([x[at], y[at]]),
        normal=found.normal[at],
    )


def _still(stack: NDArray[np.uint16]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Median depth and scatter of the pixels that showed one surface in most frames; 0 elsewhere [m]."""
    count = len(stack)
    wanted = max(round(LEAST_SHARE * count), 3)
    ordered = np.sort(stack, axis=0).astype(np.float32)
    ordered *= UNIT_M
    lost = (stack == 0).sum(axis=0)
    middle = np.minimum(lost + (count - lost) // 2, count - 1)
    median = np.take_along_axis(ordered, middle[None], axis=0)[0]
    away = np.abs(ordered - median)
    away[ordered == 0] = np.inf
    away.sort(axis=0)
    # too much where people hid the surface for a while, never too little
    typical = np.take_along_axis(away, np.minimum((count - lost) // 2, count - 1)[None], axis=0)[0]
    scatter = 1.4826 * typical
    same = (away <= STILL_M + 4 * scatter).sum(axis=0)
    still = (same >= wanted) & (scatter < 0.1) & (median > 0)
    depth = np.where(still, median, 0).astype(np.float64)
    return depth, np.where(still, scatter, 0).astype(np.float64)


def _machine_pixels(machine: Machine, camera: DepthCamera, joints: Mapping[str, float]) -> NDArray[np.bool_]:
    """Pixels of the raw image in which the machine is, or nearly."""
    pinhole = rectified(camera)
    seen = np.isfinite(rasterise(machine, pinhole, joints))
    for _ in range(MACHINE_RIM_PX):
        grown = seen.copy()
        grown[1:] |= seen[:-1]
        grown[:-1] |= seen[1:]
        grown[:, 1:] |= seen[:, :-1]
        grown[:, :-1] |= seen[:, 1:]
        seen = grown
    if not camera.intrinsics.is_distorted:
        return seen
    rays, k = pixel_rays(camera), pinhole.intrinsics
    u = np.clip(np.round(rays.x * k.fx + k.cx), 0, camera.width - 1).astype(np.int64)
    v = np.clip(np.round(rays.y * k.fy + k.cy), 0, camera.height - 1).astype(np.int64)
    return np.asarray(seen[v, u])


def _spread_out(flat: NDArray[np.bool_], normal: NDArray[np.float64]) -> NDArray[np.int64]:
    """Up to `SPOTS` pixels, spread over the image and over the directions that surfaces face.

    Pixels are grouped by tile of the image and by the axis of the camera that their normal is nearest to; each group
    gives one in turn until there are enough.
    """
    height, width = flat.shape
    pixels = np.flatnonzero(flat)
    v, u = np.divmod(pixels, width)
    main = np.abs(normal.reshape(-1, 3)[pixels]).argmax(axis=1)
    group = (v * TILES[1] // height * TILES[0] + u * TILES[0] // width) * 3 + main
    # a random order within the groups, then the firsts of all groups, the seconds of all groups, and so on
    shuffled = np.random.default_rng(0).permutation(len(pixels))
    by_group = shuffled[np.argsort(group[shuffled], kind="stable")]
    first = np.searchsorted(group[by_group], group[by_group])
    order = by_group[np.argsort(np.arange(len(pixels)) - first, kind="stable")][:SPOTS]
    return np.sort(pixels[order]).astype(np.int64)
