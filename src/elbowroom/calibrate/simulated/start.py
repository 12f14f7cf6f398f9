"""How far from the truth a simulated site starts: what a rough installation drawing would say."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from elbowroom.errors import CalibrationError
from elbowroom.geometry import DepthCamera, Intrinsics


@dataclass(frozen=True, slots=True)
class Start:
    """By how much true cameras differ from what the site file says.

    Args:
        turned_deg, moved_m: each camera's pose in the file is off by so much, in a random direction.
        focal_pct: true focal lengths and principal points differ by up to this share of the focal length [%].
        lens: true lenses bend by five coefficients, such that no lens folds back within 90 degrees; the
            file says nothing of it.
        depth_scale_pct, depth_bias_m: true depth is measured too long by up to this share [%] and length [m].

    Raises:
        CalibrationError: a number below zero or not finite.
    """

    turned_deg: float = 3.0
    moved_m: float = 0.05
    focal_pct: float = 0.0
    lens: bool = False
    depth_scale_pct: float = 0.0
    depth_bias_m: float = 0.0

    def __post_init__(self) -> None:
        for name in ("turned_deg", "moved_m", "focal_pct", "depth_scale_pct", "depth_bias_m"):
            value = getattr(self, name)
            if not (np.isfinite(value) and value >= 0):
                raise CalibrationError(f"start: {name} is {value}, must be a finite number of at least 0")


@dataclass(frozen=True, slots=True, eq=False)
class TrueCamera:
    """A simulated camera as it is, and as the site says it is.

    Args:
        true: pose and intrinsics that its images are made with.
        said: what the site says.
        depth_scale, depth_bias_m: it measures true depth times this, plus that [m].
    """

    true: DepthCamera
    said: DepthCamera
    depth_scale: float = 1.0
    depth_bias_m: float = 0.0


def started(
    cameras: Sequence[DepthCamera], start: Start, random: np.random.Generator
) -> tuple[TrueCamera, ...]:
    """Each camera with its truth and with what a site file would say of it.

    Args:
        cameras: true poses, nominal intrinsics.
        start: by how much both differ.
        random: source of randomness.
    """
    made = []
    for camera in cameras:
        true = replace(camera, intrinsics=_true_intrinsics(camera.intrinsics, start, random))
        off = moved(start.turned_deg, start.moved_m, random)
        said = replace(camera, world_from_camera=camera.world_from_camera @ off)
        made.append(
            TrueCamera(
                true,
                said,
                1 + start.depth_scale_pct / 100 * random.uniform(-1, 1),
                start.depth_bias_m * random.uniform(-1, 1),
            )
        )
    return tuple(made)


def moved(turned_deg: float, moved_m: float, random: np.random.Generator) -> NDArray[np.float64]:
    """A motion by exactly these amounts about and along random directions, shape (4, 4).

    Args:
        turned_deg, moved_m: how far [deg], [m].
        random: for the directions.
    """
    motion = np.eye(4)
    axis, way = random.standard_normal(3), random.standard_normal(3)
    motion[:3, :3] = Rotation.from_rotvec(np.radians(turned_deg) * axis / np.linalg.norm(axis)).as_matrix()
    motion[:3, 3] = moved_m * way / np.linalg.norm(way)
    return motion


def _true_intrinsics(nominal: Intrinsics, start: Start, random: np.random.Generator) -> Intrinsics:
    share = start.focal_pct / 100
    zoom, stretch = 1 + share * random.uniform(-1, 1), 1 + 0.2 * share * random.uniform(-1, 1)
    shift = share * nominal.fx * random.uniform(-1, 1, 2)
    bend: tuple[float, ...] = ()
    if start.lens:
        bend = (
            random.uniform(-0.06, 0.04),
            random.uniform(0.0, 0.02),
            *random.uniform(-0.002, 0.002, 2),
            random.uniform(-0.001, 0.001),
        )
    return Intrinsics(
        fx=nominal.fx * zoom,
        fy=nominal.fy * zoom * stretch,
        cx=nominal.cx + shift[0],
        cy=nominal.cy + shift[1],
        distortion=bend,
    )
