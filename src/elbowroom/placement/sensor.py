"""A kind of depth sensor that may be mounted anywhere: a camera but for its name and its place."""

from dataclasses import dataclass, replace
from functools import cache

import numpy as np
from numpy.typing import NDArray

from elbowroom.errors import SiteError
from elbowroom.geometry import DepthCamera
from elbowroom.simulate import Optics, wall_cameras
from elbowroom.site import Site
from elbowroom.site.camera_entry import CameraSettings, build_camera

THESIS_RANGE_M = 7.0
"""The thesis' time-of-flight sensor measures up to this (section 5.2) [m]."""


@dataclass(frozen=True, slots=True, eq=False)
class Sensor:
    """A kind of sensor.

    Args:
        name: of the kind.
        camera: one such camera, wherever it is.
        price: of one, in whatever money the site counts in.
    """

    name: str
    camera: DepthCamera
    price: float = 1.0

    def at(self, name: str, world_from_camera: NDArray[np.float64]) -> DepthCamera:
        """Such a camera with a name and a pose, shape (4, 4)."""
        return replace(self.camera, name=name, world_from_camera=world_from_camera)


@cache
def known_sensors() -> dict[str, Sensor]:
    """Sensors by name, 90 degrees wide.

    `thesis` (64x48, distance from the camera's centre, up to 7 m), `vga` (640x480), `square` (480x480).
    """
    return {
        "thesis": Sensor(
            "thesis", wall_cameras(1, size="thesis", optics=Optics(max_depth_m=THESIS_RANGE_M))[0]
        ),
        "vga": Sensor("vga", wall_cameras(1, size="vga")[0]),
        "square": Sensor("square", wall_cameras(1, width=480, height=480)[0]),
    }


def sensors_of(site: Site) -> tuple[Sensor, ...]:
    """The kinds of sensors that a site offers.

    Those of `placement.sensors`, over `camera_defaults`; where it lists none, the one that `camera_defaults` describes,
    or the one that the simulated room's cameras are.

    Raises:
        SiteError: size or intrinsics of one are not given.
    """
    shared, folder = site.entry.camera_defaults, site.path.parent
    offered = site.entry.placement.sensors if site.entry.placement is not None else ()
    if offered:
        made = []
        for index, entry in enumerate(offered):
            settings = {
                key: value for key, value in entry.over(shared).items() if key not in ("name", "price")
            }
            try:
                camera = build_camera(entry.name, settings, np.eye(4), folder)
            except SiteError as error:
                raise SiteError(f"{site.path}: placement.sensors[{index}] ({entry.name}): {error}") from None
            made.append(Sensor(entry.name, camera, entry.price))
        return tuple(made)
    if site.simulated is not None and not site.lists_cameras:
        return (
            Sensor("camera", wall_cameras(**{**site.simulated_cameras(), "count": 1, "height_m": 2.4})[0]),
        )
    try:
        camera = build_camera("camera", CameraSettings().over(shared), np.eye(4), folder)
    except SiteError as error:
        raise SiteError(f"{site.path}: no sensor: {error}, or in placement.sensors") from None
    return (Sensor("camera", camera),)
