"""What a camera of the plan is: its kind, or its kind with other noise, another resolution, another field of view."""

import math
from dataclasses import dataclass, replace

from elbowroom.errors import InputError
from elbowroom.geometry import DepthCamera
from elbowroom.page.plan.layout import PlacedCamera
from elbowroom.placement.sensor import Sensor
from elbowroom.sensing import NOISE_PRESETS
from elbowroom.simulate import Optics
from elbowroom.sources.cameras import EXACT, with_size

RESOLUTIONS: tuple[tuple[int, int], ...] = (
    (64, 48), (160, 120), (320, 240), (480, 480), (640, 480), (640, 576), (848, 480), (1280, 720),
)  # fmt: skip
"""Sizes of images that can be chosen [px]."""
FIELDS_DEG = (30.0, 130.0)
OTHER = "other"
"""A noise that is none of the presets."""


@dataclass(frozen=True, slots=True)
class Choice:
    """What can be chosen of a camera.

    Args:
        noise: name of a preset, "exact", or `OTHER`.
        size_px: of its images.
        field_deg: horizontal field of view [deg].
    """

    noise: str
    size_px: tuple[int, int]
    field_deg: float


def choice_of(camera: DepthCamera) -> Choice:
    """What a camera is."""
    return Choice(noise_name(camera), (camera.width, camera.height), field_of(camera))


def field_of(camera: DepthCamera) -> float:
    """Its horizontal field of view, from edge to edge of the image, distortion left out [deg]."""
    k = camera.intrinsics
    left, right = (k.cx + 0.5) / k.fx, (camera.width - 0.5 - k.cx) / k.fx
    return math.degrees(math.atan(left) + math.atan(right))


def noise_name(camera: DepthCamera) -> str:
    """The preset that its noise is, "exact", or `OTHER`."""
    if camera.noise is None:
        return EXACT
    return next((name for name, model in NOISE_PRESETS.items() if model == camera.noise), OTHER)


def of_kind(placed: PlacedCamera, sensor: Sensor) -> PlacedCamera:
    """A camera of another kind, where it hangs.

    Args:
        placed: the camera.
        sensor: the kind.
    """
    made = sensor.at(placed.name, placed.camera.world_from_camera)
    return PlacedCamera(replace(made, margin=placed.camera.margin), sensor.name)


def tuned(placed: PlacedCamera, choice: Choice) -> PlacedCamera:
    """A camera of the same kind with something chosen otherwise.

    Args:
        placed: the camera.
        choice: all that can be chosen; what is as it was changes nothing.

    Raises:
        InputError: a noise, a size or a field of view that is not allowed.
    """
    camera, was = placed.camera, choice_of(placed.camera)
    least, most = FIELDS_DEG
    if choice.noise not in (EXACT, OTHER, *NOISE_PRESETS):
        raise InputError(
            f"noise: {choice.noise!r} is unknown, allowed are {', '.join([EXACT, *NOISE_PRESETS])}"
        )
    if choice.size_px != was.size_px and not all(16 <= side <= 2000 for side in choice.size_px):
        raise InputError(f"resolution: {choice.size_px} is no size of an image")
    if choice.noise not in (was.noise, OTHER):
        noise = NOISE_PRESETS.get(choice.noise)
        camera = replace(camera, noise=noise, flying_pixels=noise is not None)
    if choice.size_px != was.size_px:
        camera = with_size(replace(camera, mask=None), choice.size_px)
    if abs(choice.field_deg - was.field_deg) > 1e-6:
        if not least <= choice.field_deg <= most:
            raise InputError(
                f"field of view: is {choice.field_deg:g} degrees, must be from {least:g} to {most:g}"
            )
        optics = Optics(choice.field_deg)
        camera = replace(camera, intrinsics=optics.intrinsics(camera.width, camera.height))
    return replace(placed, camera=camera)
