"""What the thesis had and printed: its sensors, its tables' figures (Hamersma 2011)."""

from collections.abc import Sequence
from functools import cache

from elbowroom.geometry import DepthCamera
from elbowroom.machine import Machine
from elbowroom.machine.c_arm import ceiling_c_arm
from elbowroom.sensing import NOISE_PRESETS, NoiseModel
from elbowroom.simulate import wall_cameras

SENSORS: dict[str, str] = {"640x480": "vga", "64x48": "thesis"}
"""Sensors by the name in results, and their size in `wall_cameras`. 64x48: the thesis' ToF camera, radial depth."""

HEIGHTS_M = (2.4, 0.4)
"""The cameras hang along the walls at these heights in turn [m]: from above alone, table and machine hide too much."""

TABLE_2: dict[int, tuple[float, float]] = {
    1: (99.1, 89.1),
    2: (98.7, 94.0),
    3: (98.7, 93.0),
    4: (98.6, 89.0),
    5: (99.2, 90.2),
    6: (99.0, 87.3),
}
"""Free and occupied by setup [%]."""


def sensor_cameras(
    sensor: str, *, noise: bool | NoiseModel = False, count: int = 21
) -> tuple[DepthCamera, ...]:
    """The cameras along the walls.

    Args:
        sensor: a name of `SENSORS`.
        noise: True: a time-of-flight camera of today; or a model.
        count: how many.
    """
    model = noise if isinstance(noise, NoiseModel) else NOISE_PRESETS["tof"] if noise else None
    return wall_cameras(count, heights(count), size=SENSORS[sensor], noise=model)


def heights(count: int) -> Sequence[float]:
    """Of `HEIGHTS_M`, what a number of cameras takes: one alone hangs above."""
    return HEIGHTS_M[: max(1, min(count, len(HEIGHTS_M)))]


@cache
def c_arm() -> Machine:
    """The ceiling C-arm; always the same object, so that what is worked out for it is kept."""
    return ceiling_c_arm()
