"""Depth cameras evenly along the four walls of the room."""

import math
from collections.abc import Sequence

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


def wall_cameras(
    count: int = 21,
    height_m: float | Sequence[float] = 2.4,
    width: int | None = None,
    height: int | None = None,
    hfov_deg: float = 90.0,
    *,
    size: str = "vga",
    depth_kind: DepthKind | None = None,
    aim_m: float = 1.1,
    half_side_m: float | tuple[float, float] = 1.99,
    centre_m: tuple[float, float] = (0.0, 0.0),
    noise: NoiseModel | None = None,
    min_depth_m: float = 0.0,
    max_depth_m: float = math.inf,
) -> tuple[DepthCamera, ...]:
    """Cameras at equal distances along the walls, each looking at the room's vertical middle axis.

    The first hangs in the middle of the wall at +x, the others follow counter-clockwise seen from above.

    Args:
        count: how many.
        height_m: of the cameras above the floor [m]; several: neighbours take them in turn.
        width, height: of the image [px]; pixels are square. None: by `size`.
        hfov_deg: horizontal field of view, from the left edge of the image to its right edge [deg].
        size: one of `SIZES`.
        depth_kind: "planar" or "radial"; None: by `size`.
        aim_m: height at which the optical axis meets the room's middle axis [m]. Of aims from 0.7 to 2.2 m,
            1.1 m finds most of an empty room of 4 x 4 x 2.5 m: each part is in view of seven of 21 or three
            of eight VGA cameras at least.
        half_side_m: distance of the cameras from the middle planes of the room: just inside its walls; two where
            it is longer in x than in y or the other way round [m].
        centre_m: the room's middle, x and y [m].
        noise: sensor noise; None: exact.
        min_depth_m, max_depth_m: range of the sensor [m].

    Returns:
        Cameras "cam00", "cam01" and so on.

    Raises:
        CameraError: fewer than one camera, an unknown size, or a field of view that no pinhole has.
    """
    if count != int(count) or count < 1:
        raise CameraError(f"wall_cameras: count is {count}, must be a whole number of at least 1")
    if not 0 < hfov_deg < 180:
        raise CameraError(f"wall_cameras: hfov_deg is {hfov_deg}, must be between 0 and 180 degrees")
    if size not in SIZES:
        raise CameraError(f"wall_cameras: size is {size!r}, known are {', '.join(SIZES)}")
    usual_width, usual_height, usual_kind = SIZES[size]
    width = usual_width if width is None else width
    height = usual_height if height is None else height
    if min(width, height) < 1:
        raise CameraError(f"wall_cameras: image of {width} x {height} pixels, must be at least 1 x 1")
    heights = [height_m] if isinstance(height_m, int | float) else list(height_m)
    if not heights:
        raise CameraError("wall_cameras: height_m is empty, at least one height is needed")
    focal_px = width / 2 / math.tan(math.radians(hfov_deg) / 2)
    intrinsics = Intrinsics(fx=focal_px, fy=focal_px, cx=(width - 1) / 2, cy=(height - 1) / 2)
    digits = max(2, len(str(count - 1)))
    half_x, half_y = (half_side_m, half_side_m) if isinstance(half_side_m, int | float) else half_side_m
    places = [_along_walls(number / count) for number in range(count)]
    return tuple(
        DepthCamera(
            name=f"cam{number:0{digits}d}",
            width=width,
            height=height,
            world_from_camera=looking_at(
                (
                    centre_m[0] + half_x * places[number][0],
                    centre_m[1] + half_y * places[number][1],
                    heights[number % len(heights)],
                ),
                (*centre_m, aim_m),
            ),
            intrinsics=intrinsics,
            depth_kind=depth_kind or usual_kind,
            noise=noise,
            min_depth_m=min_depth_m,
            max_depth_m=max_depth_m,
        )
        for number in range(count)
    )


def _along_walls(share: float) -> tuple[float, float]:
    """The place (x, y) at a share of the way round the walls, from the middle of the wall at +x; walls at +-1."""
    way = (share * 8 + 1) % 8
    wall, along = int(way // 2), way % 2 - 1
    return ((1.0, along), (-along, 1.0), (-1.0, -along), (along, -1.0))[wall]
