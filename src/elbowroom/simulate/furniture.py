"""What stands, hangs and lies in the room and never moves."""

from functools import cache

import numpy as np

from elbowroom.simulate.shapes import Shape, box, capsule, cylinder, ellipsoid, join
from elbowroom.simulate.solid import Solid

HALF_SIDE_M = 2.05
"""The walls' inner faces: just outside a grid of 4 x 4 m [m]."""
CEILING_M = 2.9
"""The ceiling's lower face [m]."""
THICKNESS_M = 0.2
TABLE_TOP_M = 0.95


def _static(name: str, parts: list[Shape], *, is_dark: bool = False) -> Solid:
    return Solid(name, join(parts), np.eye(4), is_static=True, is_dark=is_dark)


@cache
def shell() -> tuple[Solid, ...]:
    """Floor, four walls and ceiling, as boxes outside the watched space."""
    a, b, c, t = HALF_SIDE_M, HALF_SIDE_M + THICKNESS_M, CEILING_M, THICKNESS_M
    return (
        _static("floor", [box((-b, -b, -t), (b, b, 0))]),
        _static("wall -x", [box((-b, -b, -t), (-a, b, c + t))]),
        _static("wall +x", [box((a, -b, -t), (b, b, c + t))]),
        _static("wall -y", [box((-b, -b, -t), (b, -a, c + t))]),
        _static("wall +y", [box((-b, a, -t), (b, b, c + t))]),
        _static("ceiling", [box((-b, -b, c), (b, b, c + t))]),
    )


@cache
def furniture() -> tuple[Solid, ...]:
    """Table with patient, three cabinets, monitor suspension, operating lamp."""
    return (_table(), _patient(), *_cabinets(), _monitors(), _lamp())


def _table() -> Solid:
    top = TABLE_TOP_M
    return _static(
        "table",
        [
            box((-0.45, -0.25, top - 0.07), (1.45, 0.25, top)),
            box((0.95, -0.14, 0.05), (1.25, 0.14, top - 0.05)),
            box((0.75, -0.30, 0.0), (1.45, 0.30, 0.06)),
        ],
    )


def _patient() -> Solid:
    """On the back, head towards -x."""
    z = TABLE_TOP_M
    parts = [
        capsule((-0.02, 0, z + 0.11), (0.32, 0, z + 0.11), 0.15, columns=12),
        ellipsoid((0.45, 0, z + 0.11), (0.17, 0.17, 0.11)),
        capsule((-0.10, 0, z + 0.10), (-0.22, 0, z + 0.10), 0.05),
        ellipsoid((-0.31, 0, z + 0.11), (0.12, 0.075, 0.10), rows=8),
    ]
    for side in (1, -1):
        parts += [
            capsule((-0.05, 0.17 * side, z + 0.08), (0.22, 0.20 * side, z + 0.06), 0.045),
            capsule((0.22, 0.20 * side, z + 0.06), (0.46, 0.19 * side, z + 0.05), 0.038),
            ellipsoid((0.54, 0.19 * side, z + 0.045), (0.085, 0.045, 0.03)),
            capsule((0.50, 0.09 * side, z + 0.10), (0.90, 0.10 * side, z + 0.12), 0.075),
            capsule((0.90, 0.10 * side, z + 0.12), (1.28, 0.10 * side, z + 0.06), 0.052),
            ellipsoid((1.34, 0.10 * side, z + 0.12), (0.05, 0.045, 0.11)),
        ]
    return _static("patient", parts)


def _cabinets() -> tuple[Solid, ...]:
    return (
        _static("cabinet +y", [box((0.95, 1.62, 0.0), (1.85, 2.03, 1.75))]),
        _static("cabinet -y", [box((-1.75, -2.03, 0.0), (-0.85, -1.60, 0.93))], is_dark=True),
        _static("cabinet -x", [box((-2.03, 0.95, 0.08), (-1.63, 1.75, 1.95))]),
    )


def _monitors() -> Solid:
    """A post from the ceiling, a cross-bar, three screens that face the table."""
    post = (1.0, -1.45)
    screens = [box((x - 0.26, -1.47, 1.45), (x + 0.26, -1.41, 1.79)) for x in (0.46, 1.0, 1.54)]
    return _static(
        "monitors",
        [
            cylinder((*post, 1.62), (*post, CEILING_M), 0.04),
            box((0.30, -1.52, 1.58), (1.70, -1.46, 1.66)),
            *screens,
        ],
    )


def _lamp() -> Solid:
    """A post from the ceiling, an arm of two pieces, a dome over the patient's legs."""
    return _static(
        "lamp",
        [
            cylinder((1.55, 0.75, 2.30), (1.55, 0.75, CEILING_M), 0.035),
            capsule((1.55, 0.75, 2.33), (1.25, 0.30, 2.28), 0.03),
            capsule((1.25, 0.30, 2.28), (1.05, 0.10, 2.02), 0.025),
            ellipsoid((1.05, 0.10, 1.97), (0.28, 0.28, 0.07), rows=6, columns=20),
        ],
    )
