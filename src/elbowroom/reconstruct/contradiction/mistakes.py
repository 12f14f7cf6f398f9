"""What people get wrong about cameras, each with what undoes it."""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike

from elbowroom.geometry import Intrinsics
from elbowroom.reconstruct.contradiction.eye import Array, Eye

SIZES = (2.0, 0.5, 4.0, 0.25, 3.0, 1 / 3, 1.5, 1 / 1.5)
"""By how much larger an image is than the one that a lens belongs to."""
UNITS = {"millimetres": 1e-3, "centimetres": 1e-2, "inches": 0.0254, "kilometres": 1e3}
"""Of a place, by name [m]."""
NEAR_M, FAR_M = 0.1, 15.0
"""Places in metres are neither all as near to the world's origin as this, nor farther; others may be in another unit."""
DEPTHS = (10.0, 0.1, 4.0, 0.25, 5.0, 0.2, 8.0, 0.125, 2.0, 0.5, 1000.0, 1e-3)
"""By how much depths are too small where their unit is another."""


@dataclass(frozen=True, slots=True, eq=False)
class Mistake:
    """One that fits what the cameras see.

    Args:
        kind: in one or two words that stay the same: "inverse", "axes", "lens".
        looks: as a sentence goes on after the cameras' names: "poses look like camera-from-world".
        cure: what was tried, as a sentence goes on after "with": "the inverse".
        undone: how a camera sees that was described with this mistake; None: it cannot have been.
    """

    kind: str
    looks: str
    cure: str
    undone: Callable[[Eye], Eye | None]


def mistakes() -> tuple[Mistake, ...]:
    """All that one camera's description can be undone of alone; what people do most comes first."""
    return (*_frames(), *_images(), *_mirrors(), *_turns(), *_quaternions(), *_units(), *_lenses(), *_depths())


def _turned(rotation: ArrayLike) -> Callable[[Eye], Eye]:
    """The camera's own axes are others: given axes times a fixed matrix."""
    matrix = np.array(rotation, dtype=float)
    return lambda eye: replace(eye, axes=eye.axes @ matrix)


def _frames() -> tuple[Mistake, ...]:
    return (
        Mistake("inverse", "look like camera-from-world", "the inverse", _inverse),
        Mistake(
            "axes",
            "look like those of OpenGL or Blender cameras (y up, z backward)",
            "y and z turned round",
            _turned(np.diag((1, -1, -1))),
        ),
        Mistake(
            "axes",
            "look like those of the housing (x forward, z up), not of the optical frame",
            "optical axes",
            _turned(((0, 0, 1), (-1, 0, 0), (0, -1, 0))),
        ),
        Mistake(
            "axes",
            "look like optical frames that were turned from a housing once too often",
            "that turn undone",
            _turned(((0, -1, 0), (0, 0, -1), (1, 0, 0))),
        ),
        Mistake(
            "transposed",
            "have their rotation transposed",
            "the rotation transposed",
            lambda eye: replace(eye, axes=eye.axes.T),
        ),
        Mistake(
            "translation",
            "have the translation of camera-from-world beside the rotation of world-from-camera",
            "the place -R t",
            lambda eye: replace(eye, centre=-eye.axes @ eye.centre),
        ),
        Mistake(
            "translation",
            "have the rotation of camera-from-world beside the place of the camera, and a sign lost",
            "the place -t",
            lambda eye: replace(eye, centre=-eye.centre),
        ),
    )


def _inverse(eye: Eye) -> Eye:
    return replace(eye, axes=eye.axes.T, centre=-eye.axes.T @ eye.centre)


def _images() -> tuple[Mistake, ...]:
    return (
        Mistake(
            "upside down",
            "see upside down: images flipped, or fy was negative and lost its sign",
            "the image's rows reversed",
            _turned(np.diag((1, -1, 1))),
        ),
        Mistake(
            "left right",
            "see left for right: images flipped, or a left-handed world",
            "the image's columns reversed",
            _turned(np.diag((-1, 1, 1))),
        ),
        *(
            Mistake(
                "roll",
                f"are turned by {angle} degrees about the optical axis against their images",
                f"a turn by {angle} degrees",
                _turned(_about_z(np.radians(angle))),
            )
            for angle in (180, 90, -90)
        ),
    )


def _mirrors() -> tuple[Mistake, ...]:
    """A world of the other hand: one axis reversed in places and rotations."""
    return tuple(
        Mistake(
            "handedness",
            f"are of a world whose {axis} axis is reversed (left-handed)",
            f"{axis} reversed in place and rotation",
            _mirrored(np.diag([-1.0 if n == number else 1.0 for n in range(3)])),
        )
        for number, axis in enumerate("xyz")
    )


def _mirrored(mirror: Array) -> Callable[[Eye], Eye]:
    return lambda eye: replace(eye, axes=mirror @ eye.axes @ mirror, centre=mirror @ eye.centre)


def _turns() -> tuple[Mistake, ...]:
    """A world whose axes are named otherwise, as y up for z up."""
    return tuple(
        Mistake(
            "world",
            f"are of a world turned by {angle} degrees about {axis}",
            f"a turn of the world by {-angle} degrees about {axis}",
            _of_world(_about(number, np.radians(-angle))),
        )
        for number, axis in enumerate("xyz")
        for angle in (90, -90, 180)
    )


def _of_world(rotation: Array) -> Callable[[Eye], Eye]:
    return lambda eye: replace(eye, axes=rotation @ eye.axes, centre=rotation @ eye.centre)


def _quaternions() -> tuple[Mistake, ...]:
    def reordered(order: tuple[int, ...]) -> Callable[[Eye], Eye]:
        return lambda eye: replace(eye, axes=_rotation_of(_quaternion_of(eye.axes)[list(order)]))

    return (
        Mistake("quaternion", "were read from quaternions w x y z as x y z w", "w first", reordered((1, 2, 3, 0))),
        Mistake("quaternion", "were read from quaternions x y z w as w x y z", "w last", reordered((3, 0, 1, 2))),
        *(
            Mistake(
                "angles",
                "were made of angles in radians as if they were degrees",
                f"angles {order} in radians",
                _as_degrees(order),
            )
            for order in ("zyx", "xyz")
        ),
    )


def _as_degrees(order: str) -> Callable[[Eye], Eye]:
    """Angles that were turned from degrees to radians though they were radians: small ones, made large again."""

    def undone(eye: Eye) -> Eye:
        first, second, third = ("xyz".index(axis) for axis in order)
        angles = np.degrees(_angles_of(eye.axes, order))
        turns = [_about(axis, angle) for axis, angle in zip((first, second, third), angles, strict=True)]
        return replace(eye, axes=turns[0] @ turns[1] @ turns[2])

    return undone


def _units() -> tuple[Mistake, ...]:
    def scaled(factor: float) -> Callable[[Eye], Eye | None]:
        def undone(eye: Eye) -> Eye | None:
            away = float(np.linalg.norm(eye.centre))
            meant = away > FAR_M if factor < 1 else away < NEAR_M
            return replace(eye, centre=eye.centre * factor) if meant else None

        return undone

    return tuple(
        Mistake("unit", f"have places in {name}", f"places in metres (times {factor:g})", scaled(factor))
        for name, factor in UNITS.items()
    )


def _lenses() -> tuple[Mistake, ...]:
    return (
        *(
            Mistake(
                "lens",
                f"have the lens of an image {ratio:.3g} times as large",
                f"fx, fy, cx, cy divided by {ratio:.3g}",
                _lens_of(1 / ratio),
            )
            for ratio in SIZES
        ),
        Mistake(
            "lens",
            "have fx and fy or cx and cy exchanged",
            "them exchanged",
            lambda eye: replace(
                eye,
                intrinsics=Intrinsics(
                    eye.intrinsics.fy,
                    eye.intrinsics.fx,
                    eye.intrinsics.cy,
                    eye.intrinsics.cx,
                    eye.intrinsics.distortion,
                ),
            ),
        ),
    )


def _lens_of(factor: float) -> Callable[[Eye], Eye]:
    def undone(eye: Eye) -> Eye:
        k = eye.intrinsics
        # pixel centres lie at whole numbers
        cx, cy = ((at + 0.5) * factor - 0.5 for at in (k.cx, k.cy))
        return replace(
            eye, intrinsics=replace(k, fx=k.fx * factor, fy=k.fy * factor, cx=cx, cy=cy)
        )

    return undone


def _depths() -> tuple[Mistake, ...]:
    def scaled(factor: float) -> Callable[[Eye], Eye]:
        return lambda eye: replace(eye, scale=eye.scale * factor)

    return (
        Mistake(
            "depth kind",
            "have the wrong depth_kind",
            "planar and radial exchanged",
            lambda eye: replace(eye, radial=not eye.radial),
        ),
        *(
            Mistake(
                "depth unit",
                f"read depths {1 / factor:.4g} times too large" if factor < 1 else f"read depths {factor:.4g} times too small",
                f"depth_scale_m times {factor:.4g}",
                scaled(factor),
            )
            for factor in DEPTHS
        ),
    )


def _about(axis: int, angle: float) -> Array:
    """Rotation about a coordinate axis, shape (3, 3)."""
    c, s = np.cos(angle), np.sin(angle)
    rotation = np.eye(3)
    n, m = (axis + 1) % 3, (axis + 2) % 3
    rotation[n, n], rotation[n, m], rotation[m, n], rotation[m, m] = c, -s, s, c
    return rotation


def _about_z(angle: float) -> Array:
    return _about(2, angle)


def _quaternion_of(rotation: Array) -> Array:
    """Unit quaternion (w, x, y, z) of a rotation: the eigenvector of Bar-Itzhack 2000."""
    (a, b, c), (d, e, f), (g, h, i) = rotation
    k = np.array(
        (
            (a + e + i, h - f, c - g, d - b),
            (h - f, a - e - i, b + d, c + g),
            (c - g, b + d, e - a - i, f + h),
            (d - b, c + g, f + h, i - a - e),
        )
    )
    return np.linalg.eigh(k)[1][:, -1]


def _rotation_of(quaternion: Array) -> Array:
    """Rotation of a unit quaternion (w, x, y, z), shape (3, 3)."""
    w, x, y, z = quaternion
    return np.array(
        (
            (1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)),
            (2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)),
            (2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)),
        )
    )


def _angles_of(rotation: Array, order: str) -> Array:
    """Angles of rotations about three axes that make a rotation one after the other, shape (3,) [rad]."""
    if order == "zyx":
        pitch = -np.arcsin(np.clip(rotation[2, 0], -1, 1))
        return np.array(
            (
                np.arctan2(rotation[1, 0], rotation[0, 0]),
                pitch,
                np.arctan2(rotation[2, 1], rotation[2, 2]),
            )
        )
    return np.array(
        (
            np.arctan2(-rotation[1, 2], rotation[2, 2]),
            np.arcsin(np.clip(rotation[0, 2], -1, 1)),
            np.arctan2(-rotation[0, 1], rotation[0, 0]),
        )
    )
