"""What people get wrong about cameras, each with what undoes it."""

import warnings
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cache

import numpy as np
from numpy.typing import ArrayLike

from elbowroom.geometry import Intrinsics
from elbowroom.reconstruct.contradiction.eye import Array, Eye

SIZES = (2.0, 0.5, 4.0, 0.25, 3.0, 1 / 3, 1.5, 1 / 1.5)
"""By how much larger an image is than the one that a lens belongs to."""
UNITS = {"millimetres": 1e-3, "centimetres": 1e-2, "inches": 0.0254, "feet": 0.3048, "kilometres": 1e3}
"""Of a place, by name [m]."""
FEET_M = 2.0
"""Places that are farther from the world's origin, and of a few metres, may be in feet."""
NEAR_M, FAR_M = 0.1, 15.0
"""Of places in metres none are nearer to the world's origin, or farther; others may be in another unit."""
DEPTHS = (10.0, 0.1, 4.0, 0.25, 5.0, 0.2, 8.0, 0.125, 2.0, 0.5, 1000.0, 1e-3)
"""By how much depths are too small where their unit is another."""
MIRROR = "flip the images back, or mirror the world: diag(1, -1, 1, 1) on both sides of each pose, fy above 0"
ADVICE = {
    "inverse": "world_from_camera takes camera to world: write the inverse",
    "axes": "world_from_camera is of OpenCV's axes, x right, y down, z forward: turn the poses",
    "transposed": "write the rotation's transpose",
    "translation": "write the camera's own place as the translation",
    "upside down": MIRROR,
    "left right": MIRROR,
    "roll": "turn the images or the poses",
    "handedness": "the world is right-handed: convert poses as a whole, not their places alone",
    "world": "give all poses in one world frame",
    "quaternion": "read the numbers in their order",
    "angles": "convert angles once",
    "unit": "places are in metres",
    "lens": "give the lens of the images as they are",
    "depth kind": "give depth_kind as the sensor delivers it",
    "depth unit": "give depth_scale_m as the sensor delivers it",
    "exchanged": "exchange the poses, or the images",
    "shifted": "give each camera its own pose",
}
"""What to do, by kind."""

Undo = Callable[[Eye], Eye | None]


@dataclass(frozen=True, slots=True, eq=False)
class Mistake:
    """One that fits what the cameras see.

    Args:
        kind: a key of `ADVICE`.
        looks: as a sentence goes on after the cameras' names: "poses look like camera-from-world".
        cure: what was tried, as a sentence goes on after "with": "the inverse".
        undone: how a camera sees that was described with this mistake; None: it cannot have been.
    """

    kind: str
    looks: str
    cure: str
    undone: Undo

    @property
    def advice(self) -> str:
        """What to do."""
        return ADVICE[self.kind]


@cache
def mistakes() -> tuple[Mistake, ...]:
    """All that one camera's description can be undone of alone."""
    return (
        *_frames(),
        *_images(),
        *_rolls(),
        *_worlds(),
        *_rotations(),
        *_units(),
        *_lenses(),
        *_depths(),
    )


def _axes(rotation: ArrayLike) -> Undo:
    """The camera's own axes are others: those given, times a fixed matrix."""
    matrix = np.array(rotation, dtype=float)
    return lambda eye: replace(eye, axes=eye.axes @ matrix)


def _inverse(eye: Eye) -> Eye:
    return replace(eye, axes=eye.axes.T, centre=-eye.axes.T @ eye.centre)


def _frames() -> tuple[Mistake, ...]:
    housing = np.array(((0, 0, 1), (-1, 0, 0), (0, -1, 0)))
    opengl = "pose is of OpenGL's or Blender's camera axes (y up, z backward)"
    body = "pose is of the housing (x forward, z up), not of the optical frame"
    twice = "pose was turned from the housing to the optical frame once too often"
    place = "pose has the translation of camera-from-world beside the rotation of world-from-camera"
    return (
        Mistake("inverse", "pose looks like camera-from-world", "the inverse", _inverse),
        Mistake("axes", opengl, "y and z turned round", _axes(np.diag((1, -1, -1)))),
        Mistake("axes", body, "the optical axes", _axes(housing)),
        Mistake("axes", twice, "that turn undone", _axes(housing.T)),
        Mistake("transposed", "rotation is transposed", "its transpose", _transposed),
        Mistake(
            "translation", place, "the place -R t", lambda eye: replace(eye, centre=-eye.axes @ eye.centre)
        ),
        Mistake(
            "translation",
            "place has the wrong sign",
            "the place -t",
            lambda eye: replace(eye, centre=-eye.centre),
        ),
    )


def _transposed(eye: Eye) -> Eye:
    return replace(eye, axes=eye.axes.T)


def _images() -> tuple[Mistake, ...]:
    upside = "images are upside down against the pose (flipped, or fy was negative and lost its sign)"
    sideways = "images have left and right exchanged against the pose (flipped, or of a left-handed world)"
    return (
        Mistake("upside down", upside, "rows reversed", _axes(np.diag((1, -1, 1)))),
        Mistake("left right", sideways, "columns reversed", _axes(np.diag((-1, 1, 1)))),
    )


def _rolls() -> tuple[Mistake, ...]:
    return tuple(
        Mistake(
            "roll",
            f"pose is turned by {angle} degrees about the optical axis against the images",
            f"a turn by {angle} degrees",
            _axes(_turn("z", angle)),
        )
        for angle in (180, 90, -90)
    )


def _worlds() -> tuple[Mistake, ...]:
    """A world of the other hand, one axis reversed in places and rotations; or one whose axes are named otherwise."""
    mirrored = (
        Mistake(
            "handedness",
            f"pose is of a left-handed world, its {axis} axis reversed",
            f"{axis} reversed in place and rotation",
            _mirrored(np.diag([-1.0 if axis == other else 1.0 for other in "xyz"])),
        )
        for axis in "xyz"
    )
    turned = (
        Mistake(
            "world",
            f"pose is of a world turned by {angle} degrees about {axis}",
            f"a turn of the world by {-angle} degrees about {axis}",
            _of_world(_turn(axis, -angle)),
        )
        for axis in "xyz"
        for angle in (90, -90, 180)
    )
    return (*mirrored, *turned)


def _mirrored(mirror: Array) -> Undo:
    return lambda eye: replace(eye, axes=mirror @ eye.axes @ mirror, centre=mirror @ eye.centre)


def _of_world(rotation: Array) -> Undo:
    return lambda eye: replace(eye, axes=rotation @ eye.axes, centre=rotation @ eye.centre)


def _rotations() -> tuple[Mistake, ...]:
    """Rotations that were made of other numbers than these are."""
    small = "rotation was made of angles in radians as if they were degrees"
    return (
        Mistake(
            "quaternion", "quaternion w x y z was read as x y z w", "w read first", _reordered((3, 0, 1, 2))
        ),
        Mistake(
            "quaternion", "quaternion x y z w was read as w x y z", "w read last", _reordered((1, 2, 3, 0))
        ),
        Mistake("angles", small, "angles z y x in radians", _radians("ZYX")),
        Mistake("angles", small, "angles x y z in radians", _radians("XYZ")),
    )


def _reordered(order: tuple[int, ...]) -> Undo:
    """The numbers of a quaternion, x y z w, taken in another order."""

    def undone(eye: Eye) -> Eye | None:
        from scipy.spatial.transform import Rotation  # slow to load, and right poses need it not

        if np.linalg.det(eye.axes) < 0:
            return None
        numbers = Rotation.from_matrix(eye.axes).as_quat()
        return replace(eye, axes=Rotation.from_quat(numbers[list(order)]).as_matrix())

    return undone


def _radians(order: str) -> Undo:
    """Small angles made large again."""

    def undone(eye: Eye) -> Eye | None:
        from scipy.spatial.transform import Rotation  # slow to load, and right poses need it not

        if np.linalg.det(eye.axes) < 0:
            return None
        with warnings.catch_warnings():
            # of angles that cannot be told apart any will do: it is small angles that are looked for
            warnings.simplefilter("ignore", UserWarning)
            angles = Rotation.from_matrix(eye.axes).as_euler(order, degrees=True)
        if np.abs(angles).max() > np.pi + 0.01:
            return None
        return replace(eye, axes=Rotation.from_euler(order, angles).as_matrix())

    return undone


def _units() -> tuple[Mistake, ...]:
    def scaled(factor: float) -> Undo:
        def undone(eye: Eye) -> Eye | None:
            away = float(np.linalg.norm(eye.centre))
            meant = away > (FEET_M if factor == UNITS["feet"] else FAR_M) if factor < 1 else away < NEAR_M
            return replace(eye, centre=eye.centre * factor) if meant else None

        return undone

    return tuple(
        Mistake("unit", f"place is in {name}", f"metres (times {factor:g})", scaled(factor))
        for name, factor in UNITS.items()
    )


def _lenses() -> tuple[Mistake, ...]:
    sizes = (
        Mistake(
            "lens",
            f"lens is of an image {ratio:.3g} times as large",
            f"fx, fy, cx and cy divided by {ratio:.3g}",
            _lens_of(1 / ratio),
        )
        for ratio in SIZES
    )
    turned = "lens is that of an image turned by 90 degrees"
    return (*sizes, Mistake("lens", turned, "fx and fy, cx and cy exchanged", _lens_turned))


def _lens_of(factor: float) -> Undo:
    def undone(eye: Eye) -> Eye:
        k = eye.intrinsics
        # pixel centres lie at whole numbers
        cx, cy = ((at + 0.5) * factor - 0.5 for at in (k.cx, k.cy))
        return replace(eye, intrinsics=replace(k, fx=k.fx * factor, fy=k.fy * factor, cx=cx, cy=cy))

    return undone


def _lens_turned(eye: Eye) -> Eye:
    k = eye.intrinsics
    return replace(eye, intrinsics=Intrinsics(k.fy, k.fx, k.cy, k.cx, k.distortion))


def _depths() -> tuple[Mistake, ...]:
    def scaled(factor: float) -> Undo:
        return lambda eye: replace(eye, scale=eye.scale * factor)

    units = (
        Mistake(
            "depth unit",
            f"depths are {max(factor, 1 / factor):g} times too {'small' if factor > 1 else 'large'}",
            f"depth_scale_m times {factor:g}",
            scaled(factor),
        )
        for factor in DEPTHS
    )
    kind = "depth_kind is the other one, planar for radial or radial for planar"
    other = Mistake("depth kind", kind, "that", lambda eye: replace(eye, radial=not eye.radial))
    return (other, *units)


def _turn(axis: str, degrees: float) -> Array:
    from scipy.spatial.transform import Rotation  # slow to load, and right poses need it not

    return np.asarray(Rotation.from_euler(axis, degrees, degrees=True).as_matrix())
