"""Cameras as a site file describes them."""

import re
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Annotated, Any, Literal

import numpy as np
from numpy.typing import NDArray
from pydantic import AfterValidator, BeforeValidator, Field, model_validator

from elbowroom.errors import SiteError
from elbowroom.files.mask_file import read_mask
from elbowroom.files.matrix_file import read_matrix
from elbowroom.geometry import DepthCamera, Intrinsics, looking_at
from elbowroom.sensing import NOISE_PRESETS, Margin, NoiseModel
from elbowroom.site.entry import (
    Count,
    Covariance,
    Entry,
    Flag,
    Matrix,
    NotNegative,
    Number,
    Point,
    Positive,
    Text,
)
from elbowroom.site.paths import expand
from elbowroom.site.ranges import MILLIMETRES, mirrored_focal, unit_of_depth, up_to

OFF_UNIT = 2e-3
"""A quaternion's length may be off 1 by this: files write four digits."""
Quaternion = tuple[Number, Number, Number, Number]
PINHOLE = ("fx", "fy", "cx", "cy")


def _of_a_folder(name: str) -> str:
    """A camera's name, which may be that of its folder of images."""
    if name.strip() != name or name in (".", ".."):
        raise ValueError("a name that a folder can have, without blanks at its ends")
    return name


class NoiseEntry(Entry):
    """sigma(z) = constant_m + linear z + quadratic max(z - offset_m, 0)^2 [m]."""

    constant_m: Annotated[NotNegative, up_to(0.5, "m", MILLIMETRES)] = 0.0
    linear: Annotated[NotNegative, up_to(0.5, "m a metre")] = 0.0
    quadratic: Annotated[NotNegative, up_to(0.5, "m a square metre", MILLIMETRES)] = 0.0
    offset_m: Annotated[NotNegative, up_to(20, "m", MILLIMETRES)] = 0.0

    def build(self) -> NoiseModel:
        """The noise model."""
        return NoiseModel(**self.model_dump())


def _noise(given: Any) -> Any:
    """A preset's name as its coefficients; "exact" is a sensor without noise."""
    if not isinstance(given, str):
        return given
    if given == "exact":
        return None
    if given not in NOISE_PRESETS:
        raise ValueError(
            f"exact, {', '.join(NOISE_PRESETS)}, or coefficients constant_m, linear, quadratic, offset_m"
        )
    model = NOISE_PRESETS[given]
    return {name: getattr(model, name) for name in NoiseEntry.model_fields}


class MarginEntry(Entry):
    """What a pixel is not trusted to; what is left out has the defaults of `Margin`."""

    sigmas: Annotated[NotNegative, up_to(100, "standard deviations")] = 3.0
    bias_m: Annotated[NotNegative, up_to(2, "m", MILLIMETRES)] = 0.0
    lateral_px: Annotated[NotNegative, up_to(100, "pixels")] = 0.5
    range_linear: Annotated[NotNegative, up_to(1, "m a metre", (0.01, "percent"))] = 0.0
    range_quadratic: Annotated[NotNegative, up_to(1, "m a square metre", MILLIMETRES)] = 0.0

    def build(self) -> Margin:
        """The margin."""
        return Margin(**self.model_dump())


class CameraSettings(Entry):
    """What cameras may share; every key may stand in `camera_defaults` or with a camera."""

    width: Count | None = None
    height: Count | None = None
    fx: Annotated[Number, AfterValidator(mirrored_focal(0))] | None = None
    fy: Annotated[Number, AfterValidator(mirrored_focal(1))] | None = None
    cx: Number | None = None
    cy: Number | None = None
    intrinsics_file: Text | None = None
    distortion: tuple[Number, ...] = ()
    depth_kind: Literal["planar", "radial"] = "planar"
    depth_scale_m: Annotated[Positive, AfterValidator(unit_of_depth)] = 0.001
    depth_bias_m: Annotated[Number, up_to(1, "m", MILLIMETRES)] = 0.0
    noise: Annotated[NoiseEntry | None, BeforeValidator(_noise)] = None
    margin: MarginEntry | None = None
    sensor_margin: MarginEntry | None = None
    min_depth_m: Annotated[NotNegative, up_to(20, "m", MILLIMETRES)] = 0.0
    max_depth_m: Annotated[Positive, up_to(300, "m", MILLIMETRES)] | None = None
    flying_pixels: Flag | None = None
    mask: Text | None = None
    clock_bound_ms: Annotated[NotNegative, up_to(1e4, "ms", (1e-6, "nanoseconds"))] = 0.0
    repeats: Flag = False

    @model_validator(mode="after")
    def _one_source_of_intrinsics(self) -> "CameraSettings":
        if self.intrinsics_file and any(getattr(self, key) is not None for key in PINHOLE):
            raise ValueError("either intrinsics_file or fx, fy, cx, cy, not both")
        if len(self.distortion) not in (0, 5, 8):
            raise ValueError(
                "distortion of no coefficient, 5 (k1 k2 p1 p2 k3) or 8 (k1 k2 p1 p2 k3 k4 k5 k6)"
            )
        return self

    def over(self, defaults: "CameraSettings") -> dict[str, Any]:
        """What was written here, and where nothing was, what was written in the defaults."""
        own = {key: getattr(self, key) for key in self.model_fields_set}
        shared = {key: getattr(defaults, key) for key in defaults.model_fields_set}
        # a camera's own intrinsics replace the shared ones as a whole, in whatever form they come
        if "intrinsics_file" in own or any(key in own for key in PINHOLE):
            shared = {key: value for key, value in shared.items() if key not in ("intrinsics_file", *PINHOLE)}
        return {**shared, **own}


class CameraEntry(CameraSettings):
    """One camera: its name, its place, and whatever is not shared.

    Its pose is `world_from_camera`, or a file of it, or where it is with where it looks, or with how it is turned: a
    quaternion of the camera's axes (x right, y down, z forward) in the world, its order in the key's name.
    `pose_covariance` is what a calibration leaves open: of the rotation vector [rad], then the translation [m], in the
    camera's frame, true world_from_camera = world_from_camera @ exp(error). `sensor_margin` is that part of `margin`
    which is the sensor's own; a calibration adds its part to it, so that calibrating twice does not widen twice.
    """

    name: Annotated[Text, Field(pattern=r"^[^/\\]+$", max_length=100), AfterValidator(_of_a_folder)]
    world_from_camera: Matrix | None = None
    pose_file: Text | None = None
    position_m: Point | None = None
    look_at_m: Point | None = None
    up: Point = (0.0, 0.0, 1.0)
    quaternion_xyzw: Quaternion | None = None
    quaternion_wxyz: Quaternion | None = None
    pose_covariance: Covariance | None = None

    @model_validator(mode="after")
    def _is_a_covariance(self) -> "CameraEntry":
        if self.pose_covariance is not None:
            given = np.array(self.pose_covariance)
            scale = np.sqrt(np.outer(np.abs(given.diagonal()), np.abs(given.diagonal()))) + 1e-30
            if not np.allclose(given / scale, given.T / scale, atol=1e-6):
                raise ValueError("pose_covariance that is symmetric")
            if np.linalg.eigvalsh(given / scale).min() < -1e-6 or given.diagonal().min() < 0:
                raise ValueError("pose_covariance without a negative variance")
        return self

    @model_validator(mode="after")
    def _one_pose(self) -> "CameraEntry":
        turns = [self.look_at_m, self.quaternion_xyzw, self.quaternion_wxyz]
        count = sum(turn is not None for turn in turns)
        ways = [self.world_from_camera, self.pose_file, self.position_m]
        if sum(way is not None for way in ways) != 1 or count != (self.position_m is not None):
            raise ValueError(
                "exactly one of world_from_camera, pose_file, or position_m with look_at_m, quaternion_xyzw or "
                "quaternion_wxyz"
            )
        return self

    @model_validator(mode="after")
    def _turns(self) -> "CameraEntry":
        for key in ("quaternion_xyzw", "quaternion_wxyz"):
            given = getattr(self, key)
            length = 1.0 if given is None else float(np.linalg.norm(given))
            if abs(length - 1) > OFF_UNIT:
                raise ValueError(f"{key} of length 1, a rotation; its length is {length:.4g}")
        return self

    @property
    def _quaternion_xyzw(self) -> NDArray[np.float64] | None:
        if self.quaternion_wxyz is not None:
            return np.roll(self.quaternion_wxyz, -1)
        return None if self.quaternion_xyzw is None else np.array(self.quaternion_xyzw)

    def pose(self, beside: Path) -> NDArray[np.float64]:
        """world_from_camera as it was given, shape (4, 4); not yet checked to be rigid.

        Raises:
            SiteError: a pose file that is not usable, or a direction of view that is none.
        """
        if self.world_from_camera is not None:
            return np.array(self.world_from_camera)
        if self.pose_file is not None:
            return read_matrix(expand(self.pose_file, beside), (4, 4), "pose, camera to world")
        turn = self._quaternion_xyzw
        if turn is not None:
            from scipy.spatial.transform import Rotation  # slow to load, and most sites need none

            pose = np.eye(4)
            pose[:3, :3] = Rotation.from_quat(turn).as_matrix()
            pose[:3, 3] = self.position_m
            return pose
        if self.position_m is None or self.look_at_m is None:
            raise SiteError("camera without a pose: position_m and look_at_m are missing")
        return looking_at(self.position_m, self.look_at_m, self.up, SiteError)


def build_camera(
    name: str, settings: Mapping[str, Any], world_from_camera: NDArray[np.float64], beside: Path
) -> DepthCamera:
    """The camera of these settings.

    Args:
        name: its name.
        settings: keys and values of `CameraSettings`, those that were written.
        world_from_camera: shape (4, 4).
        beside: the site file's folder.

    Raises:
        SiteError: size or intrinsics are missing, or the intrinsics file is not usable.
        CameraError: a value that no camera can have.
    """
    missing = [key for key in ("width", "height") if settings.get(key) is None]
    if settings.get("intrinsics_file") is None:
        missing += [key for key in PINHOLE if settings.get(key) is None]
    if missing:
        raise SiteError(f"{', '.join(missing)} not given; needed here or in camera_defaults")
    distortion = settings.get("distortion", ())
    if settings.get("intrinsics_file") is not None:
        path = expand(settings["intrinsics_file"], beside)
        intrinsics = Intrinsics.from_matrix(read_matrix(path, (3, 3), "camera matrix"), distortion)
    else:
        intrinsics = Intrinsics(**{key: settings[key] for key in PINHOLE}, distortion=distortion)
    noise, margin = settings.get("noise"), settings.get("margin")
    deepest = settings.get("max_depth_m")
    return DepthCamera(
        name=name,
        width=settings["width"],
        height=settings["height"],
        world_from_camera=world_from_camera,
        intrinsics=intrinsics,
        depth_kind=settings.get("depth_kind", "planar"),
        noise=None if noise is None else noise.build(),
        margin=None if margin is None else margin.build(),
        min_depth_m=settings.get("min_depth_m", 0.0),
        max_depth_m=float("inf") if deepest is None else deepest,
        flying_pixels=settings.get("flying_pixels"),
        mask=None
        if settings.get("mask") is None
        else read_mask(expand(settings["mask"], beside), settings["width"], settings["height"]),
        clock_bound_ns=round(settings.get("clock_bound_ms", 0.0) * 1e6),
    )


def mended_poses(warnings: Sequence[str]) -> tuple[str, ...]:
    """Many warnings of poses that were a little off as one note, few as they are."""
    if len(warnings) <= 2:
        return tuple(warnings)
    deviations = [float(found[1]) for text in warnings if (found := re.search(r"by ([0-9.e+-]+),", text))]
    return (
        f"{len(warnings)} poses were off a rotation by up to {max(deviations):.1e}, "
        "each was brought to the nearest one",
    )
