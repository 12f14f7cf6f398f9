"""Depth cameras evenly along the four walls of the room."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from elbowroom.errors import CameraError
from elbowroom.geometry import DepthCamera, Intrinsics, looking_at
from elbowroom.geometry.camera import DepthKind
from elbowroom.sensing import NoiseModel

SIZES: dict[str, tuple[int, int, DepthKind]] = {
    "vga": (640, 480, "planar"),
    "qqvga": (160, 120, "planar"),
    # the thesis' PMD camera: 64 x 48 pixels, distance from the camera's centre
    "thesis": (64, 48, "radial"),
}
"""Width and height [px] and kind of depth by name, for `wall_cameras(size=...)`."""


@dataclass(frozen=True, slots=True)
class Optics:
    """What a sensor measures within its image.

    Args:
        hfov_deg: horizontal field of view, from the left edge of the image to its right edge [deg].
        depth_kind: "planar" or "radial"; None: by the image's size.
        min_depth_m, max_depth_m: range of the sensor [m].

    Raises:
        CameraError: a field of view that no pinhole has.
    """

    hfov_deg: float = 90.0
    depth_kind: DepthKind | None = None
    min_depth_m: float = 0.0
    max_depth_m: float = math.inf

    def __post_init__(self) -> None:
        if not 0 < self.hfov_deg < 180:
            raise CameraError(f"optics: hfov_deg is {self.hfov_deg}, must be between 0 and 180 degrees")

    def intrinsics(self, width: int, height: int) -> Intrinsics:
        """Of an image of square pixels [px] whose middle the optical axis meets."""
        focal_px = width / 2 / math.tan(math.radians(self.hfov_deg) / 2)
        return Intrinsics(fx=focal_px, fy=focal_px, cx=(width - 1) / 2, cy=(height - 1) / 2)


@dataclass(frozen=True, slots=True)
class Walls:
    """The walls along which cameras hang, and where they look.

    Args:
        half_side_m: distance of the cameras from the middle planes of the room: just inside its walls; two where
            it is longer in x than in y or the other way round [m].
        centre_m: the room's middle, x and y [m].
        aim_m: height at which the optical axis meets the room's middle axis [m]. Of aims from 0.7 to 2.2 m,
            1.1 m finds most of an empty room of 4 x 4 x 2.5 m: each part is in view of seven of 21 or three
            of eight VGA cameras at least.
    """

    half_side_m: float | tuple[float, float] = 1.99
    centre_m: tuple[float, float] = (0.0, 0.0)
    aim_m: float = 1.1

    def world_from_camera(self, share: float, height_m: float) -> NDArray[np.float64]:
        """The pose, shape (4, 4), at a share of the way round, from the middle of the wall at +x, and a height [m]."""
        half = self.half_side_m
        half_x, half_y = (half, half) if isinstance(half, int | float) else half
        x, y = _along_walls(share)
        eye = (self.centre_m[0] + half_x * x, self.centre_m[1] + half_y * y, height_m)
        return looking_at(eye, (*self.centre_m, self.aim_m))


def wall_cameras(
    count: int = 21,
    height_m: float | Sequence[float] = 2.4,
    width: int | None = None,
    height: int | None = None,
    *,
    size: str = "vga",
    optics: Optics = Optics(),
    walls: Walls = Walls(),
    noise: NoiseModel | None = None,
) -> tuple[DepthCamera, ...]:
    """Cameras at equal distances along the walls, each looking at the room's vertical middle axis.

    The first hangs in the middle of the wall at +x, the others follow counter-clockwise seen from above.

    Args:
        count: how many.
        height_m: of the cameras above the floor [m]; several: neighbours take them in turn.
        width, height: of the image [px]; pixels are square. None: by `size`.
        size: one of `SIZES`.
        optics: field of view, kind of depth and range.
        walls: where they hang and look.
        noise: sensor noise; None: exact.

    Returns:
        Cameras "cam00", "cam01" and so on.

    Raises:
        CameraError: fewer than one camera, no height, or an unknown size.
    """
    if count != int(count) or count < 1:
        raise CameraError(f"wall_cameras: count is {count}, must be a whole number of at least 1")
    width, height, kind = _image(size, width, height)
    heights = [height_m] if isinstance(height_m, int | float) else list(height_m)
    if not heights:
        raise CameraError("wall_cameras: height_m is empty, at least one height is needed")
    intrinsics = optics.intrinsics(width, height)
    digits = max(2, len(str(count - 1)))
    return tuple(
        DepthCamera(
            name=f"cam{number:0{digits}d}",
            width=width,
            height=height,
            world_from_camera=walls.world_from_camera(number / count, heights[number % len(heights)]),
            intrinsics=intrinsics,
            depth_kind=optics.depth_kind or kind,
            noise=noise,
            min_depth_m=optics.min_depth_m,
            max_depth_m=optics.max_depth_m,
        )
        for number in range(count)
    )


def _image(size: str, width: int | None, height: int | None) -> tuple[int, int, DepthKind]:
    """Width and height [px] and the usual kind of depth."""
    if size not in SIZES:
        raise CameraError(f"wall_cameras: size is {size!r}, known are {', '.join(SIZES)}")
    usual_width, usual_height, kind = SIZES[size]
    width = usual_width if width is None else width
    height = usual_height if height is None else height
    if min(width, height) < 1:
        raise CameraError(f"wall_cameras: image of {width} x {height} pixels, must be at least 1 x 1")
    return width, height, kind


def _along_walls(share: float) -> tuple[float, float]:
    """The place (x, y) at a share of the way round the walls, from the middle of the wall at +x; walls at +-1."""
    way = (share * 8 + 1) % 8
    wall, along = int(way // 2), way % 2 - 1
    return ((1.0, along), (-along, 1.0), (-1.0, -along), (along, -1.0))[wall]
